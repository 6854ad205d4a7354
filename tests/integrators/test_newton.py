"""The stages of a Lobatto step of one coordinate, by Newton's method."""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import Any

import numpy as np
import pytest
from small_models import Pendulum, march, set_jacobian

from curvebound.kernel.adaptive import Adaptive
from curvebound.kernel.base import Model, acceleration_of
from curvebound.kernel.course import Course
from curvebound.kernel.lobatto_tables import BY_ROWS, NODES, SQUARE, STAGES, WEIGHTS
from curvebound.kernel.method import DONE
from curvebound.kernel.methods import create
from curvebound.kernel.newton import ANOTHER, Newton
from curvebound.kernel.rounding import Rounding

A = np.reshape(BY_ROWS, (8, 8))
R = np.reshape(SQUARE, (8, 8))
C = np.array(NODES)


class Damped(Pendulum):
    """With a damping that grows with the rate, so that the acceleration depends on it."""

    def acceleration(self, t: float, q0: float, q1: float, v0: float, v1: float) -> None:
        self.a0, self.a1 = -9.81 * math.sin(q0) - 0.02 * v0**3, 0.0
        self.uses_rates = True

    def jacobian(self, t: float, q0: float, q1: float, v0: float, v1: float) -> None:
        Damped.acceleration(self, t, q0, q1, v0, v1)
        set_jacobian(self, (-9.81 * math.cos(q0), 0.0, 0.0, 0.0, -0.06 * v0 * v0, 0.0, 0.0, 0.0))


class ByPlace(Pendulum):
    """Says that its acceleration does not depend on the rate."""

    def __init__(self) -> None:
        super().__init__()
        self.uses_rates = False


class Bare(ByPlace):
    """Without derivatives."""

    def jacobian(self, t: float, q0: float, q1: float, v0: float, v1: float) -> None:
        raise NotImplementedError


class Calls(Damped):
    """Counts what is asked of it."""

    def __init__(self) -> None:
        super().__init__()
        self.asked: list[str] = []

    def acceleration(self, t: float, q0: float, q1: float, v0: float, v1: float) -> None:
        self.asked.append("acceleration")
        super().acceleration(t, q0, q1, v0, v1)

    def jacobian(self, t: float, q0: float, q1: float, v0: float, v1: float) -> None:
        self.asked.append("jacobian")
        super().jacobian(t, q0, q1, v0, v1)


def stages(model: Model, h: float, t: float = 0.0) -> np.ndarray:
    """The accelerations at the stages of a step of h s, by sweeps until they stand still."""
    a = np.full(STAGES, acceleration_of(model, t, model.q0, 0.0, model.v0, 0.0)[0])
    for _ in range(60):
        x = model.q0 + C * h * model.v0 + h * h * R @ a
        v = model.v0 + h * A @ a
        a[1:] = [acceleration_of(model, t, x[i], 0.0, v[i], 0.0)[0] for i in range(1, STAGES)]
    return a


def solved(
    model: Model, before: float, h: float, tolerance: float, contraction: float = 0.01
) -> tuple[Newton, float]:
    """The method after a step of h s that follows one of `before` s, and its estimated error."""
    last = [0.0] * STAGES
    if before > 0.0:
        found = stages(model, before)
        last = list(found)
        model.q0 += before * model.v0 + before * before * R[7] @ found
        model.v0 += before * A[7] @ found
    a0 = acceleration_of(model, 0.0, model.q0, 0.0, model.v0, 0.0)[0]
    method, course, rounding = Newton(), Course(), Rounding()
    course.begin(model, rounding, 0.0, False, contraction)
    error = method.solve(model, rounding, course, last, before, 0.0, h, a0, tolerance)
    return method, error


@pytest.mark.parametrize("kind", [Pendulum, Damped])
@pytest.mark.parametrize(("before", "h"), [(0.1, 0.12), (0.1, 0.05), (0.02, 0.1), (0.0, 0.1)])
@pytest.mark.parametrize("tolerance", [1e-7, 1e-13])
def test_the_accelerations_are_those_of_the_collocation(
    kind: Callable[[], Pendulum], before: float, h: float, tolerance: float
) -> None:
    model = kind()
    model.v0 = 2.0
    method, error = solved(model, before, h, tolerance)
    assert 0.0 <= error <= tolerance
    off = np.abs(np.array(method.a) - stages(model, h))[1:]
    rate = abs(model.v0) + h * 9.81
    assert h * max(off) < 0.5 * max(tolerance, 1e-15) * rate


@pytest.mark.parametrize(
    ("h", "asked"),
    [
        pytest.param(0.12, 2, id="the guess is extended by the middle stages"),
        pytest.param(0.17, STAGES - 1, id="not for a step that is 1.7 times as long"),
    ],
)
def test_two_sweeps_are_enough(h: float, asked: int) -> None:
    model = Calls()
    model.v0 = 2.0
    method, _ = solved(model, 0.1, h, 1e-7)
    first = model.asked.index("jacobian")
    assert model.asked[first - asked :] == ["acceleration"] * asked + ["jacobian"] * (STAGES - 1)
    assert method.evaluations == asked + STAGES - 1


@pytest.mark.parametrize("tolerance", [1e-7, 1e-9])
def test_how_the_last_steps_sweeps_converged_costs_this_one_nothing(tolerance: float) -> None:
    """Corrections that converge are kept, whatever those of the last step did."""
    found = []
    for contraction in (0.01, 0.9):
        model = Pendulum()
        model.v0 = 2.0
        method, error = solved(model, 0.1, 0.12, tolerance, contraction)
        assert error < tolerance
        found.append(method.evaluations)
    assert found[0] == found[1]


def test_a_loose_tolerance_needs_no_derivatives() -> None:
    model = Calls()
    solved(model, 0.02, 0.02, 1e-4)
    assert "jacobian" not in model.asked


class Bowl(Pendulum):
    """A bead in a parabolic bowl: its acceleration depends strongly on the rate."""

    def acceleration(self, t: float, q0: float, q1: float, v0: float, v1: float) -> None:
        self.a0, self.a1 = -2.0 * q0 * (9.81 + 2.0 * v0 * v0) / (1.0 + 4.0 * q0 * q0), 0.0
        self.uses_rates = True

    def jacobian(self, t: float, q0: float, q1: float, v0: float, v1: float) -> None:
        Bowl.acceleration(self, t, q0, q1, v0, v1)
        lean, pull = 1.0 + 4.0 * q0 * q0, 9.81 + 2.0 * v0 * v0
        by_place = -2.0 * pull * (1.0 - 4.0 * q0 * q0) / (lean * lean)
        set_jacobian(self, (by_place, 0.0, 0.0, 0.0, -8.0 * q0 * v0 / lean, 0.0, 0.0, 0.0))


@pytest.mark.parametrize(
    ("system", "most", "usual"), [(ByPlace, 0.5, 0.05), (Damped, 0.8, 0.1), (Bowl, 0.8, 0.25)]
)
def test_sweeps_leave_hardly_more_than_their_part(
    monkeypatch: pytest.MonkeyPatch, system: type[Pendulum], most: float, usual: float
) -> None:
    """Of the tolerance of each step, against the accelerations of its collocation."""
    left = []
    solve = Newton.solve

    def compared(self: Newton, model: Model, *rest: Any) -> float:
        course, t, h, tolerance = rest[1], *rest[4:6], rest[7]
        error = solve(self, model, *rest)
        if 0.0 <= error <= tolerance:
            off = np.abs(np.array(self.a) - stages(model, h, t))[1:] @ WEIGHTS[1:]
            left.append(h * course.scale0 * off / tolerance)
        return error

    monkeypatch.setattr(Newton, "solve", compared)
    for tolerance in (1e-3, 1e-4, 1e-6, 1e-9):
        model = system()
        model.q0 = 1.0
        march(create(4), model, tolerance=tolerance)
    assert len(left) > 80
    assert 0.01 < max(left) < most
    assert np.quantile(left, 0.9) < usual


def test_what_a_correction_leaves_goes_with_its_square() -> None:
    """Of how far the extrapolated accelerations are off: an order of two, fitted over a decade.

    There is one: the step is so long that its error spares the others.
    """
    sizes = np.geomspace(0.1, 1.0, 9)
    found = []
    for size in sizes:
        model = Pendulum()
        model.v0 = 2.0
        last = stages(model, 0.1)
        model.q0 += 0.1 * model.v0 + 0.01 * R[7] @ last
        model.v0 += 0.1 * A[7] @ last
        a0 = acceleration_of(model, 0.0, model.q0, 0.0, model.v0, 0.0)[0]
        last[4] += 1e-3 * size
        course, rounding, method = Course(), Rounding(), Newton()
        course.begin(model, rounding, 0.0, False, 0.01)
        method.solve(model, rounding, course, list(last), 0.1, 0.0, 0.2, a0, 1e-15)
        found.append(np.abs(np.array(method.a) - stages(model, 0.2))[1:].max())
    assert found[0] > 1e-12
    order = np.polyfit(np.log(sizes), np.log(found), 1)[0]
    assert order == pytest.approx(2.0, abs=0.3)


@pytest.mark.parametrize("trouble", [NotImplementedError, ZeroDivisionError, ValueError])
def test_without_derivatives_sweeps_go_on_uncorrected(trouble: type[Exception]) -> None:
    class Failing(Pendulum):
        asked = 0

        def jacobian(self, t: float, q0: float, q1: float, v0: float, v1: float) -> None:
            Failing.asked += 1
            raise trouble

    model, method = Failing(), Adaptive()
    for _ in range(4):
        before = Failing.asked
        assert method.advance(model, 2.5, 1, 1e-9, 1000) == DONE
        # a few by what looks at rounding and stiffness, one that failed; not one for each step
        assert Failing.asked - before < 12
    assert model.error(10.0) < 1e-8
    assert method.steps < 70


def test_another_coordinate_begins_to_move() -> None:
    """It rests until the first has passed 0.5, within a step."""

    class Pushing(Model):
        def __init__(self) -> None:
            super().__init__()
            self.v0 = 1.0

        def acceleration(self, t: float, q0: float, q1: float, v0: float, v1: float) -> None:
            self.a0, self.a1 = -q0, 120.0 * max(0.0, q0 - 0.5) ** 3

        def jacobian(self, t: float, q0: float, q1: float, v0: float, v1: float) -> None:
            self.acceleration(t, q0, q1, v0, v1)
            slope = 360.0 * max(0.0, q0 - 0.5) ** 2
            set_jacobian(self, (-1.0, 0.0, slope, 0.0, 0.0, 0.0, 0.0, 0.0))

    method = Newton()
    model = Pushing()
    course, rounding = Course(), Rounding()
    course.begin(model, rounding, 0.0, False, 0.01)
    assert method.solve(model, rounding, course, [0.0] * 8, 0.0, 0.0, 0.6, 0.0, 1e-6) == ANOTHER
    fine = Pushing()
    march(create(3), fine, 1.0, count=4000)
    for pieces in (1, 3, 40):
        model = Pushing()
        march(create(4), model, 1.0, pieces=pieces, tolerance=1e-9)
        assert model.q1 == pytest.approx(fine.q1, rel=1e-8)
        assert model.v1 == pytest.approx(fine.v1, rel=1e-8)
    assert fine.q1 > 0.01


def test_a_step_that_is_far_too_long_is_refused() -> None:
    """No sweep converges there, be it of corrections."""

    class Stiff(Pendulum):
        def acceleration(self, t: float, q0: float, q1: float, v0: float, v1: float) -> None:
            self.a0, self.a1 = -1e4 * math.sin(q0), 0.0

        def jacobian(self, t: float, q0: float, q1: float, v0: float, v1: float) -> None:
            self.acceleration(t, q0, q1, v0, v1)
            set_jacobian(self, (-1e4 * math.cos(q0), *(0.0,) * 7))

    model = Stiff()
    model.q0 = 0.5
    _, error = solved(model, 0.0, 0.5, 1e-6)
    assert not error <= 1e-6


def test_work_of_one_coordinate() -> None:
    """From 1e-8 on 0.4 to 0.6 of what sweeps take where there are no derivatives."""
    for tolerance, most in ((1e-6, 450), (1e-8, 530), (1e-10, 590), (1e-12, 890)):
        model, method = ByPlace(), create(4)
        march(method, model, tolerance=tolerance)
        assert model.error(10.0) < 2 * tolerance + 1e-13
        assert method.evaluations < most
        swept = create(4)
        march(swept, Bare(), tolerance=tolerance)
        assert tolerance > 1e-8 or method.evaluations < 0.6 * swept.evaluations


@pytest.mark.parametrize("tolerance", [1e-5, 1e-8, 1e-11])
def test_errors_of_many_starts_keep_to_the_tolerance(tolerance: float) -> None:
    """From rest at many angles; those near the upper rest magnify what errors they have."""
    off = []
    for angle in np.linspace(0.3, 2.95, 54):
        model, fine = Pendulum(), Pendulum()
        model.q0 = fine.q0 = float(angle)
        march(create(4), model, tolerance=tolerance)
        march(create(4), fine, tolerance=1e-14)
        off.append(abs(model.q0 - fine.q0) / tolerance)
    assert max(off[:43]) < 1.5  # up to 2.4
    assert np.quantile(off, 0.9) < 1.5
    assert max(off) < 30.0


def test_derivatives_come_with_the_accelerations() -> None:
    """What Newton's method takes from jacobian() in the place of acceleration()."""
    model = Damped()
    for q, v in ((0.3, 1.0), (-2.0, 4.0)):
        expected = acceleration_of(model, 0.0, q, 0.0, v, 0.0)
        model.a0 = model.a1 = math.nan
        model.jacobian(0.0, q, 0.0, v, 0.0)
        assert (model.a0, model.a1) == expected


def test_corrections_that_do_not_converge_leave_what_a_sweep_does() -> None:
    """Damping so strong that they do not, once an earlier correction has gained much."""

    class Heavy(Pendulum):
        def acceleration(self, t: float, q0: float, q1: float, v0: float, v1: float) -> None:
            self.a0, self.a1 = -9.81 * math.sin(q0) - 1000.0 * v0, 0.0

        def jacobian(self, t: float, q0: float, q1: float, v0: float, v1: float) -> None:
            self.acceleration(t, q0, q1, v0, v1)
            set_jacobian(self, (-9.81 * math.cos(q0), 0.0, 0.0, 0.0, -1000.0, 0.0, 0.0, 0.0))

    for before, h in ((0.003, 0.0035), (0.0033, 0.0032), (0.002, 0.004)):
        model = Heavy()
        model.v0 = 2.0
        method, error = solved(model, before, h, 1e-6)
        found = np.array(method.a)
        off = np.abs(found - stages(model, h))[1:]
        rate = abs(model.v0) + h * np.abs(found).max()
        assert not error <= 1e-6 or h * (off @ np.array(WEIGHTS[1:])) < 1e-6 * rate


def test_another_coordinate_that_moves_only_early_in_a_step() -> None:
    """Where the stages that are extrapolated at first alone see it."""

    class Passing(Model):
        def __init__(self) -> None:
            super().__init__()
            self.v0 = 1.0

        def acceleration(self, t: float, q0: float, q1: float, v0: float, v1: float) -> None:
            self.a0, self.a1 = 0.0, 1.0 if 0.02 < q0 < 0.25 else 0.0

    method, model, course, rounding = Newton(), Passing(), Course(), Rounding()
    course.begin(model, rounding, 0.0, False, 0.01)
    error = method.solve(model, rounding, course, [0.0] * 8, 1.0, 0.0, 1.0, 0.0, 1e-6)
    assert error == ANOTHER

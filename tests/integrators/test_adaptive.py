"""Adaptive steps: error and work by tolerance, cutting, rest, memory and honest failure."""

from __future__ import annotations

import itertools
import math
import random
from typing import Any, cast

import pytest
from small_models import Oscillator, Pendulum, Sliding, march

from curvebound.kernel.adaptive import Adaptive
from curvebound.kernel.base import Model
from curvebound.kernel.course import CONVERGED, DIVERGES, Course
from curvebound.kernel.method import (
    DONE,
    NOT_FINITE,
    STEP_TOO_SMALL,
    TOO_MANY_STEPS,
)
from curvebound.kernel.methods import create

SYSTEMS = [Oscillator, Pendulum, Sliding]


@pytest.mark.parametrize(("times", "outcome"), [(0.99, CONVERGED), (1.01, DIVERGES)])
@pytest.mark.parametrize("other", [0.0, 4.0])
def test_sweeps_that_shrink_slowly_have_converged_where_rounding_is_all(
    times: float, outcome: int, other: float
) -> None:
    """What rounding makes of the accelerations moves the rates by h times that."""
    course = Course()
    course.known = True
    course.scale0, course.noise0, course.scale1, course.noise1 = 8.0, 0.25, 0.5, other
    h, nothing = 0.125, cast(Any, None)
    # of the one that rests, however finely it is weighed, or of both
    change0, change1 = times * h * 0.25, times * h * other
    course.change = max(8.0 * change0, 0.5 * change1) / 0.75
    assert course.outcome(nothing, nothing, 0.0, h, 2, change0, change1, 1e-10) == outcome


@pytest.mark.parametrize("system", SYSTEMS)
def test_error_keeps_to_the_tolerance_at_bounded_work(system: type[Oscillator]) -> None:
    """Ten seconds are four to six oscillations; DOP853 needs 1000, 1800, 3000 and 4400 here."""
    for tolerance, most in ((1e-6, 950), (1e-8, 1300), (1e-10, 1850), (1e-12, 2600)):
        model, method = system(), create(4)
        march(method, model, tolerance=tolerance)
        assert model.error(10.0) < 10 * tolerance + 1e-13
        assert method.evaluations < most


@pytest.mark.parametrize(
    ("system", "count"),
    [(Oscillator, 4), (Pendulum, 4), pytest.param(Sliding, 10, marks=pytest.mark.slow)],
)
def test_error_follows_the_tolerance(system: type[Oscillator], count: int) -> None:
    """On average over a decade, for single errors vary with the last step's luck."""
    means = []
    for decade in range(4, 12):
        logs = []
        for k in range(count):
            model = system()
            march(create(4), model, tolerance=10 ** -(decade + k / count))
            logs.append(math.log10(max(model.error(10.0), 1e-15)))
        means.append(sum(logs) / len(logs))
    for coarse, fine in itertools.pairwise(means):
        assert 0.4 < coarse - fine < 2.5
    assert 0.9 < (means[0] - means[5]) / 5 < 1.6


@pytest.mark.parametrize("system", SYSTEMS)
@pytest.mark.parametrize("tolerance", [1e-6, 1e-10])
def test_cutting_changes_the_result_within_the_tolerance(
    system: type[Oscillator], tolerance: float
) -> None:
    rng = random.Random(5)
    cuts = [sorted(rng.uniform(0, 10) for _ in range(n)) for n in (7, 60)]
    cuts += [[0.01 * k for k in range(1, 150)], [0.2 * k for k in range(1, 50)], []]
    for cut in cuts:
        model, method = system(), create(4)
        times = [0.0, *cut, 10.0]
        for start, end in itertools.pairwise(times):
            assert method.advance(model, end - start, 1, tolerance, 1000) == DONE
        assert model.error(10.0) < 30 * tolerance
        assert method.steps <= len(cut) + 120


def test_short_communication_steps_take_one_step_each_and_keep_the_wish() -> None:
    model, method = Sliding(), Adaptive()
    march(method, model, 2.0)
    wished, before = method.wished, method.steps
    assert wished > 0.1
    for _ in range(100):
        assert method.advance(model, 1e-3, 1, 1e-6, 10) == DONE
    assert method.steps == before + 100
    assert method.wished == wished
    # one sweep of seven evaluations, and one at the start for what an input may have changed
    evaluations = method.evaluations
    march(method, model, 0.1, pieces=100)
    assert method.evaluations - evaluations == 800


def test_the_last_step_does_not_shrink_the_wish() -> None:
    model, method = Sliding(), Adaptive()
    for _ in range(20):
        march(method, model, 0.5)
        assert method.wished > 0.08


def test_steps_and_rejections_are_few() -> None:
    method = create(4)
    march(method, Sliding(), tolerance=1e-9)
    assert 40 < method.steps < 80
    tries = Adaptive()
    model = Sliding()
    assert tries.advance(model, 10.0, 1, 1e-9, method.steps + method.steps // 5) == DONE


def test_evaluations_are_counted() -> None:
    class Counted(Sliding):
        calls = 0

        def acceleration(self, t: float, q0: float, q1: float, v0: float, v1: float) -> None:
            self.calls += 1
            super().acceleration(t, q0, q1, v0, v1)

        def jacobian(self, t: float, q0: float, q1: float, v0: float, v1: float) -> None:
            calls = self.calls
            super().jacobian(t, q0, q1, v0, v1)
            self.calls = calls

    model, method = Counted(), create(4)
    march(method, model, pieces=3)
    assert method.evaluations == model.calls


class Still(Model):
    """No force at all."""

    def acceleration(self, t: float, q0: float, q1: float, v0: float, v1: float) -> None:
        self.a0, self.a1 = 0.0, 0.0


def test_rest_and_coasting() -> None:
    model, method = Still(), create(4)
    assert method.advance(model, 1000.0, 1, 1e-13, 20) == DONE
    assert (model.q0, model.v0) == (0.0, 0.0)
    model.v1 = 1e-9
    assert method.advance(model, 1000.0, 1, 1e-13, 200) == DONE
    assert model.q1 == pytest.approx(1e-6, rel=1e-12)


@pytest.mark.parametrize("amplitude", [1e-3, 1e-8, 1e-150])
def test_small_oscillations(amplitude: float) -> None:
    model = Pendulum()
    model.q0 = amplitude
    method = create(4)
    march(method, model, tolerance=1e-12)
    assert method.steps < 150
    period = 2 * math.pi / math.sqrt(9.81)
    assert model.q0 == pytest.approx(amplitude * math.cos(2 * math.pi * 10 / period), abs=1e-6)


def test_a_coordinate_at_rest_that_is_set_in_motion() -> None:
    """q1 begins at rest without acceleration and is driven by q0 alone: q1'' = q0^2 / 2."""

    class Driven(Model):
        def __init__(self) -> None:
            super().__init__()
            self.v0 = 1.0

        def acceleration(self, t: float, q0: float, q1: float, v0: float, v1: float) -> None:
            self.a0, self.a1 = 0.0, 0.5 * q0 * q0

    for tolerance in (1e-4, 1e-9):
        model = Driven()
        march(create(4), model, 2.0, tolerance=tolerance)
        assert model.q1 == pytest.approx(2.0**4 / 24, rel=1e-12)
        assert model.v1 == pytest.approx(2.0**3 / 6, rel=1e-12)


def test_a_coordinate_set_in_motion_is_solved_for_in_the_same_step() -> None:
    class Driven(Oscillator):
        """q1'' = q0^2 - 25 q1 from rest, beside q0'' = 0."""

        def acceleration(self, t: float, q0: float, q1: float, v0: float, v1: float) -> None:
            self.a0, self.a1 = 0.0, q0 * q0 - 25.0 * q1

    model, method = Driven(), create(4)
    model.q0 = model.q1 = model.v1 = 0.0
    model.v0 = 1.0
    march(method, model, 0.4, tolerance=1e-9)
    t, w = 0.4, 5.0
    truth = (t * t - 2 / w**2 + 2 / w**2 * math.cos(w * t)) / w**2
    assert method.steps < 8
    assert model.q1 == pytest.approx(truth, abs=1e-10)


def test_jumping_inputs() -> None:
    """A push that jumps at each communication point, against the closed form piece by piece."""
    rng = random.Random(2)
    model, method = Oscillator(), create(4)
    q0, v0 = model.q0, model.v0
    w = 2.0
    for _ in range(200):
        model.f = rng.uniform(-5, 5)
        march(method, model, 0.05, tolerance=1e-9)
        rest = model.f / (w * w)
        c, s = math.cos(w * 0.05), math.sin(w * 0.05)
        q0, v0 = rest + (q0 - rest) * c + v0 / w * s, v0 * c - w * (q0 - rest) * s
    assert model.q0 == pytest.approx(q0, abs=1e-8)
    assert method.evaluations < 200 * 40


def test_time_dependence_is_taken_at_the_stages() -> None:
    class Rising(Model):
        def acceleration(self, t: float, q0: float, q1: float, v0: float, v1: float) -> None:
            self.a0, self.a1 = t * t, -t

    model = Rising()
    march(create(4), model, 3.0, tolerance=1e-10)
    assert model.q0 == pytest.approx(3.0**4 / 12, rel=1e-13)
    assert model.q1 == pytest.approx(-(3.0**3) / 6, rel=1e-13)


def test_too_many_steps() -> None:
    method, model = create(4), Sliding()
    assert method.advance(model, 10.0, 1, 1e-9, 20) == TOO_MANY_STEPS
    assert 0.05 < method.reached < 0.5
    # rejected ones count: with every trial thrown out, the limit still ends it
    thrown = Torn()
    assert create(4).advance(thrown, 10.0, 1, 1e-9, 7) == TOO_MANY_STEPS


class Torn(Pendulum):
    """An acceleration that is nowhere smooth once in motion."""

    def acceleration(self, t: float, q0: float, q1: float, v0: float, v1: float) -> None:
        self.a0, self.a1 = math.sin(1e18 * q0) * 1e6 + 1.0, 0.0


def test_step_too_small() -> None:
    """A fall into the centre: q'' = -1 / q^2 from 1 at rest arrives at t = pi / sqrt(8)."""

    class Falling(Model):
        def __init__(self) -> None:
            super().__init__()
            self.q0 = 1.0

        def acceleration(self, t: float, q0: float, q1: float, v0: float, v1: float) -> None:
            self.a0, self.a1 = -1.0 / (q0 * q0), 0.0

    model, method = Falling(), create(4)
    assert method.advance(model, 1.1, 1, 1e-8, 100_000) == DONE
    assert 0.0 < model.q0 < 0.1
    assert method.advance(model, 1.0, 1, 1e-8, 100_000) == STEP_TOO_SMALL
    assert 0.0 < method.reached < 1e-13


@pytest.mark.parametrize("error", [ValueError, ZeroDivisionError, OverflowError, None])
def test_a_wall_of_undefined_values_is_never_silent(error: type[Exception] | None) -> None:
    class Walled(Model):
        def __init__(self) -> None:
            super().__init__()
            self.v0 = 1.0

        def acceleration(self, t: float, q0: float, q1: float, v0: float, v1: float) -> None:
            if q0 > 0.75:
                if error is None:
                    self.a0, self.a1 = math.nan, 0.0
                    return
                raise error("beyond the wall")
            self.a0, self.a1 = 0.0, 0.0

    model, method = Walled(), create(4)
    assert method.advance(model, 0.5, 1, 1e-8, 1000) == DONE
    assert method.advance(model, 0.5, 1, 1e-8, 10_000) in (STEP_TOO_SMALL, NOT_FINITE)
    assert model.q0 <= 0.75


def test_a_start_beyond_the_finite_numbers() -> None:
    model = Oscillator()
    model.q0 = math.inf
    assert create(4).advance(model, 1.0, 1, 1e-6, 1000) == NOT_FINITE


def test_memory_survives_a_failure() -> None:
    method, model = Adaptive(), Sliding()
    march(method, model, 1.0)
    before = method.get_state()
    method.keep()
    assert method.advance(model, 10.0, 1, 1e-12, 5) == TOO_MANY_STEPS
    method.undo()
    assert method.get_state() == before
    march(method, Sliding(), 1.0)
    assert method.get_state() != before
    method.undo()
    assert method.get_state() == before


def test_state_continues_bit_for_bit_in_a_new_instance() -> None:
    method, model = create(4), Sliding()
    march(method, model, 1.3, pieces=4)
    other, again = create(4), Sliding()
    other.set_state(method.get_state())
    again.q0, again.q1, again.v0, again.v1 = model.q0, model.q1, model.v0, model.v1
    for pair in ((method, model), (other, again)):
        march(*pair, 3.0, pieces=7, tolerance=1e-9)
    assert other.get_state() == method.get_state()
    assert (again.q0, again.q1, again.v0, again.v1) == (model.q0, model.q1, model.v0, model.v1)
    assert all(math.isfinite(x) for x in method.get_state())
    method.reset()
    assert method.get_state() == create(4).get_state()


def test_settling_between_steps_is_taken_into_account() -> None:
    """A step starts from what settle() left of the last one, not from what it was given."""

    class Nudged(Pendulum):
        seen: set[tuple[float, float]]
        left: tuple[float, float] | None = None

        def acceleration(self, t: float, q0: float, q1: float, v0: float, v1: float) -> None:
            self.seen.add((q0, v0))
            super().acceleration(t, q0, q1, v0, v1)

        def settle(self, h: float) -> None:
            if self.left is not None:
                assert self.left in self.seen
            self.v0 *= 0.5
            self.left = (self.q0, self.v0)

    model, method = Nudged(), create(4)
    model.seen = set()
    model.settles = True
    march(method, model, 3.0, tolerance=1e-8)
    assert 10 < method.steps < 60


def test_a_long_step_after_a_tiny_one() -> None:
    """As at communication points of random distance: the tiny step's polynomial is of no use."""
    for tiny in (1e-3, 1e-6, 1e-9):
        model, method = Sliding(), create(4)
        march(method, model, 1.0, tolerance=1e-9)
        march(method, model, tiny, tolerance=1e-9)
        before = method.evaluations
        march(method, model, 1.0, tolerance=1e-9)
        assert method.evaluations - before < 330
        other = Sliding()
        march(create(4), other, 2.0 + tiny, tolerance=1e-13)
        assert model.q0 == pytest.approx(other.q0, abs=1e-8)


@pytest.mark.parametrize("tolerance", [1e-15, 1e-18, 1e-300])
def test_tolerances_below_rounding_do_not_hang(tolerance: float) -> None:
    model, method = Sliding(), create(4)
    march(method, model, 2.0, tolerance=tolerance)
    assert method.steps < 60
    assert abs(model.energy() - Sliding().energy()) < 1e-13

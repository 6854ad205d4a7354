"""The stiff steps of `adaptive`: constants of Radau IIA, damping of any size, memory, honesty."""

from __future__ import annotations

import math
import random
from fractions import Fraction

import numpy as np
import pytest
from small_models import Oscillator, Pendulum, Sliding, march, set_jacobian

from curvebound.fmi.folder import find
from curvebound.kernel import elimination, radau_tables
from curvebound.kernel.adaptive import Adaptive
from curvebound.kernel.base import Model
from curvebound.kernel.elapsed import Elapsed
from curvebound.kernel.method import (
    DONE,
    NOT_CONVERGED,
    NOT_FINITE,
    STEP_TOO_SMALL,
    TOO_MANY_STEPS,
)
from curvebound.kernel.methods import create
from curvebound.kernel.radau_stages import Stages
from curvebound.kernel.rounding import Rounding
from curvebound.kernel.stiff import LARGEST, usual

bead_on_wire = find("BeadOnWire").module("kernel").model

S = radau_tables.STAGES
A = np.array(radau_tables.A).reshape(S, S)
B = np.array(radau_tables.B).reshape(S, S)
C = np.array(radau_tables.NODES)


def test_nodes_are_the_right_radau_points() -> None:
    """Zeros of P_7 - P_6 on (0, 1]."""
    inner = np.polynomial.legendre.legroots([0.0] * 6 + [-1.0, 1.0])
    assert np.sort((inner + 1) / 2) == pytest.approx(C, abs=1e-14)


@pytest.mark.parametrize("k", range(1, 8))
def test_stages_collocate(k: int) -> None:
    """C(7): sum_j A_ij c_j^(k-1) = c_i^k / k; B = A A."""
    assert A @ C ** (k - 1) == pytest.approx(C**k / k, abs=2e-16)
    if k < 7:
        assert B @ C ** (k - 1) == pytest.approx(C ** (k + 1) / (k * (k + 1)), abs=2e-16)


@pytest.mark.parametrize("k", range(1, 14))
def test_weights_have_order_13(k: int) -> None:
    assert A[-1] @ C ** (k - 1) == pytest.approx(1 / k, abs=2e-16)


def test_l_stable() -> None:
    """R(z) = 1 + z b (I - z A)^-1 1 is below 1 in the left half plane and 0 at its end."""

    def growth(z: complex) -> complex:
        return complex(1 + z * (A[-1] @ np.linalg.solve(np.eye(S) - z * A, np.ones(S))))

    assert abs(growth(-1e9)) < 1e-6
    for y in 10.0 ** np.arange(-3, 7):
        assert abs(growth(1j * y)) <= 1 + 1e-12


def test_tails_are_legendre_coefficients() -> None:
    rng = random.Random(1)
    coefficients = [rng.uniform(-1, 1) for _ in range(S)]
    values = np.polynomial.legendre.legval(2 * C - 1, coefficients)
    assert np.dot(radau_tables.HIGHEST, values) == pytest.approx(coefficients[6], abs=1e-13)
    assert np.dot(radau_tables.NEXT, values) == pytest.approx(coefficients[5], abs=1e-13)


class Sloped(Model):
    """Of slopes by q0, q1, v0, v1 of a0, and of a1: the largest of each at another stage."""

    SIZES = (2.0, 3.0, 5.0, 7.0, 11.0, 13.0, 17.0, 19.0)

    def jacobian(self, t: float, q0: float, q1: float, v0: float, v1: float) -> None:
        at = [float(c) for c in radau_tables.NODES].index(t)
        x = [-s if at == i % S else 0.5 * s for i, s in enumerate(self.SIZES)]
        set_jacobian(self, (x[0], x[1], x[4], x[5], x[2], x[3], x[6], x[7]))


def test_rounding_of_coordinates_and_rates_comes_with_the_slopes_of_both() -> None:
    """Eight units in the last place of the largest, times the largest slope by each."""
    stages, rounding = Stages(), Rounding()
    assert stages.factorise(Sloped(), 0.0, 1.0)
    assert tuple(stages.slopes) == Sloped.SIZES
    rounding.size0 = 100.0  # so far, beside 1
    stages.x0, stages.x1, stages.w0, stages.w1 = (
        [(-1.0) ** i * size * (1.0 if i == 3 else 0.1) for i in range(S)]
        for size in (1.0, 2000.0, 3e4, 5e5)
    )
    stages.round_off(rounding)
    sizes = np.array([100.0, 2000.0, 3e4, 5e5])
    for noise, slopes in ((stages.noise0, Sloped.SIZES[:4]), (stages.noise1, Sloped.SIZES[4:])):
        assert noise == pytest.approx(8.0 * 2.0**-52 * sizes.dot(slopes), rel=1e-14)
    rounding.scatter0, rounding.scatter1 = 1e-3, 2e-3  # seen, at half as many points
    stages.round_off(rounding)
    assert (stages.noise0, stages.noise1) == (2e-3, 4e-3)


class Scripted(Stages):
    """Newton's method whose corrections are nothing, said to be of the sizes given in turn."""

    def __init__(self, moves: list[float], singular: int = -1) -> None:
        super().__init__()
        self.moves = moves
        self.singular = singular
        self.tried = 0
        #: corrections that there had been when a matrix was made
        self.made: list[int] = []
        self.units: list[float] = []

    def factorise(self, model: Model, t: float, h: float) -> bool:
        self.made.append(self.tried)
        return len(self.made) != self.singular

    def correct(self) -> None:
        pass

    def moved(self, unit0: float, unit1: float) -> float:
        self.tried += 1
        self.units = [unit0, unit1]
        return self.moves[self.tried - 1]


class Pushed(Model):
    """Given accelerations, halved but at the fourth stage: 0 has been found, others never are."""

    LARGEST = (radau_tables.NODES[3], 2.0 * radau_tables.NODES[3])  # in steps of 1 and 2 s

    def __init__(self, push0: float, push1: float = 0.0) -> None:
        super().__init__()
        self.push = push0, push1
        self.count = 0

    def acceleration(self, t: float, q0: float, q1: float, v0: float, v1: float) -> None:
        self.count += 1
        part = 1.0 if t in self.LARGEST else 0.5
        self.a0, self.a1 = part * self.push[0], part * self.push[1]

    def jacobian(self, t: float, q0: float, q1: float, v0: float, v1: float) -> None:
        set_jacobian(self, (0.0,) * 8)


@pytest.mark.parametrize(
    ("push", "moves", "made", "found"),
    [
        pytest.param(0.0, [1.0, 0.04, 0.001, 1e-15], [0], True, id="kept while it does well"),
        pytest.param(0.0, [1.0, 0.06, 0.002, 1e-15], [0, 2], True, id="made anew"),
        pytest.param(0.0, [1e-8, 4e-9, 1e-9, 1e-15], [0], True, id="kept near rounding"),
        pytest.param(0.0, [1e-8, 9e-9, 8e-9], [0], True, id="rounding by its size"),
        pytest.param(0.0, [1.0, 0.9, 0.8], [0, 2], True, id="nothing is left"),
        pytest.param(1.0, [0.2] * 7, [0, 2, 3, 4, 5, 6], False, id="stalls"),
        pytest.param(1.0, [1.0, 0.04, 0.03, 1e-3, 1e-15, 1e-15], [0, 3, 5], True, id="stale"),
        pytest.param(1.0, [0.49**n for n in range(15)], [0, *range(2, 15)], False, id="slow"),
        pytest.param(0.0, [1.0, 2e300], [0], False, id="too large"),
    ],
)
def test_a_newton_matrix_is_kept_as_long_as_it_does_well(
    push: float, moves: list[float], made: list[int], found: bool
) -> None:
    stages, model, rounding = Scripted(moves), Pushed(push), Rounding()
    assert stages.solve(model, rounding, 0.0, 1.0) is found
    assert (stages.made, stages.tried) == (made, len(moves))
    assert stages.evaluations + rounding.evaluations == model.count


@pytest.mark.parametrize(
    ("rates", "push", "units", "scales"),
    [
        ((0.0, 0.0), (0.0, 0.0), [1.0, 1.0], (1.0, 1.0)),
        ((0.0, 0.0), (3.0, 0.0), [3.0, 3.0], (3.0, 3.0)),
        ((0.0, 0.0), (0.0, -5.0), [5.0, 5.0], (5.0, 5.0)),
        ((0.0, 0.0), (-3.0, 5.0), [3.0, 5.0], (3.0, 5.0)),
        ((8.0, 0.0), (3.0, 0.0), [4.0, 4.0], (4.0, 4.0)),
        ((0.0, -8.0), (0.0, 3.0), [4.0, 4.0], (4.0, 4.0)),
        ((8.0, 0.0), (7.0, 3.0), [4.0, 3.0], (7.0, 3.0)),
        ((-8.0, 2.0), (3.0, 5.0), [4.0, 1.0], (4.0, 5.0)),
    ],
)
def test_corrections_are_measured_by_rates_and_scaled_by_accelerations(
    rates: tuple[float, float],
    push: tuple[float, float],
    units: list[float],
    scales: tuple[float, float],
) -> None:
    """In a step of 2 s: by the other's unit, or 1, where a coordinate has none of its own."""
    stages, model = Scripted([1.0, 1e-15, 1e-15]), Pushed(*push)
    model.v0, model.v1 = rates

    def grow() -> None:
        model.push = 100.0, 100.0  # what they begin with counts

    stages.correct = grow  # type: ignore[method-assign]
    assert stages.solve(model, Rounding(), 0.0, 2.0)
    assert (stages.units, (stages.unit0, stages.unit1)) == (units, scales)


@pytest.mark.parametrize(("rate", "made"), [(1e13, [0]), (1e11, [0, 2])])
def test_what_is_left_is_nothing_beside_the_largest_accelerations(
    rate: float, made: list[int]
) -> None:
    """1 m/s2, of rates that change within the step of 1 s."""
    stages, model = Scripted([1.0, 1e-15, 1e-15]), Pushed(1.0)
    model.v0 = rate
    assert stages.solve(model, Rounding(), 0.0, 1.0)
    assert stages.made == made


@pytest.mark.parametrize(("which", "moves"), [(1, []), (2, [1.0, 0.04, 0.03])])
def test_a_singular_newton_matrix_finds_nothing(which: int, moves: list[float]) -> None:
    stages = Scripted(moves, singular=which)
    assert not stages.solve(Pushed(1.0), Rounding(), 0.0, 1.0)
    assert stages.tried == len(moves)


def test_elimination_exchanges_rows() -> None:
    rng = random.Random(3)
    n = 2 * S
    matrix = np.array([[rng.uniform(-1, 1) for _ in range(n)] for _ in range(n)])
    matrix[0, 0] = 0.0
    truth = np.array([rng.uniform(-1, 1) for _ in range(n)])
    m, rows, r = matrix.ravel().tolist(), [0] * n, (matrix @ truth).tolist()
    assert elimination.factorised(m, rows, n)
    elimination.substitute(m, rows, r, n)
    assert r == pytest.approx(truth, abs=1e-11)
    assert not elimination.factorised([0.0] * (n * n), rows, n)


def overdamped(t: float, w: float, d: float) -> tuple[float, float]:
    """q and q' of q'' = -w^2 q - d q' from (1, 0.5), d far above 2 w."""
    fast = -0.5 * d - math.sqrt(0.25 * d * d - w * w)
    slow = w * w / fast
    b = (0.5 - slow) / (fast - slow)
    a = 1.0 - b
    return (
        a * math.exp(slow * t) + b * math.exp(fast * t),
        a * slow * math.exp(slow * t) + b * fast * math.exp(fast * t),
    )


@pytest.mark.parametrize("damping", [1e2, 1e4, 1e6, 1e9, 1e18])
def test_damping_of_any_size_takes_bounded_work(damping: float) -> None:
    """The sweeps alone would take damping / 3 steps a second."""
    for tolerance in (1e-6, 1e-10):
        model, method = Oscillator(w0=2.0, w1=2.0, damping=damping), create(4)
        march(method, model, 10.0, tolerance=tolerance)
        q, v = overdamped(10.0, 2.0, damping)
        assert model.q0 == pytest.approx(q, rel=10 * tolerance)
        assert model.v0 == pytest.approx(v, rel=10 * tolerance)
        assert method.evaluations < 12_000
        assert method.steps < 600


@pytest.mark.parametrize("damping", [1e4, 1e9])
def test_cutting_a_stiff_motion_costs_one_step_a_cut(damping: float) -> None:
    """A step that the end of a communication step cut short says nothing about the next one."""
    whole, cut = create(4), create(4)
    march(whole, Oscillator(w0=2.0, w1=2.0, damping=damping), 10.0, tolerance=1e-8)
    march(cut, Oscillator(w0=2.0, w1=2.0, damping=damping), 10.0, pieces=100, tolerance=1e-8)
    assert cut.steps <= whole.steps + 100
    assert cut.evaluations <= whole.evaluations + 20 * 100


def test_work_of_damping_is_integrated_in_stiff_steps() -> None:
    model, method = Oscillator(w0=2.0, w1=3.0, damping=1e5, push=2.0), create(4)
    march(method, model, 50.0, pieces=5, tolerance=1e-9)
    assert method.steps < 1000
    assert model.energy() - model.start_energy == pytest.approx(model.work, abs=1e-9)


def test_without_damping_there_are_no_stiff_steps() -> None:
    for system in (Oscillator, Pendulum, Sliding):
        model, method = system(), Adaptive()
        march(method, model, 60.0, tolerance=1e-9)
        assert method.steps > 100
        assert method.stiff.wished == 0.0


class Coasting(Oscillator):
    """Strong damping that ends at t = 1 s of the first coordinate's clock q1 = t."""

    def __init__(self) -> None:
        super().__init__()
        self.q0, self.v0, self.q1, self.v1 = 1.0, 0.0, 0.0, 1.0

    def rate(self, q1: float) -> float:
        return 1e5 * max(0.0, 1.0 - q1) ** 4

    def acceleration(self, t: float, q0: float, q1: float, v0: float, v1: float) -> None:
        self.a0, self.a1 = -100.0 * q0 - self.rate(q1) * v0, 0.0

    def jacobian(self, t: float, q0: float, q1: float, v0: float, v1: float) -> None:
        self.acceleration(t, q0, q1, v0, v1)
        slope = -4e5 * max(0.0, 1.0 - q1) ** 3
        set_jacobian(self, (-100.0, -slope * v0, 0.0, 0.0, -self.rate(q1), 0.0, 0.0, 0.0))


def test_goes_back_where_stiff_steps_no_longer_pay() -> None:
    model, method = Coasting(), Adaptive()
    march(method, model, 0.5, tolerance=1e-9)
    assert method.stiff.wished > 0.0
    march(method, model, 20.0, tolerance=1e-9)
    assert method.stiff.wished == 0.0
    finer, other = Coasting(), create(4)
    march(other, finer, 0.5, tolerance=1e-13)
    march(other, finer, 20.0, tolerance=1e-13)
    assert model.q0 == pytest.approx(finer.q0, abs=1e-6)


def test_stiff_state_continues_bit_for_bit_and_survives_failure() -> None:
    def stiff() -> Oscillator:
        return Oscillator(damping=1e6)

    method, model = Adaptive(), stiff()
    march(method, model, 1.0, tolerance=1e-9)
    assert method.stiff.wished > 0.0
    other, again = Adaptive(), stiff()
    other.set_state(method.get_state())
    again.q0, again.q1, again.v0, again.v1 = model.q0, model.q1, model.v0, model.v1
    for pair in ((method, model), (other, again)):
        march(*pair, 3.0, pieces=7, tolerance=1e-9)
    assert other.get_state() == method.get_state()
    assert (again.q0, again.q1, again.v0, again.v1) == (model.q0, model.q1, model.v0, model.v1)
    before = method.get_state()
    method.keep()
    assert method.advance(model, 1e3, 1, 1e-12, 3) == TOO_MANY_STEPS
    assert method.reached > 0.0
    method.undo()
    assert method.get_state() == before


def test_most_steps_bound_stiff_tries_too() -> None:
    class Torn(Oscillator):
        """Newton's method finds no stage of a long step: the Jacobian lacks the damping."""

        def jacobian(self, t: float, q0: float, q1: float, v0: float, v1: float) -> None:
            self.acceleration(t, q0, q1, v0, v1)
            set_jacobian(self, (-self.k0, 0.0, 0.0, -self.k1, -1.0, 0.0, 0.0, -1.0))

    method = create(4)
    assert method.advance(Torn(damping=1e6), 1.0, 1, 1e-9, 500) == TOO_MANY_STEPS
    assert method.evaluations < 500 * 7 * 12


def test_a_light_coordinate_is_right_for_itself() -> None:
    """Beside a motion a million times as large."""
    model, method = Oscillator(w0=2.0, w1=30.0), create(4)
    model.q0, model.v0, model.q1, model.v1 = 1e6, 0.0, 1.0, 0.0
    march(method, model, 10.0, tolerance=1e-6)
    assert model.q1 == pytest.approx(math.cos(300.0), abs=1e-5)
    assert method.steps < 200


def test_time_is_summed_exactly() -> None:
    elapsed = Elapsed()
    total = Fraction(0)
    h = 1.0 / 3e7
    for _ in range(10_000):
        elapsed.add(h)
        total += Fraction(h)
    assert abs(Fraction(elapsed.t) + Fraction(elapsed.rest) - total) < Fraction(1, 10**27)
    assert elapsed.left(1.0) == pytest.approx(float(1 - total), rel=1e-15)
    elapsed.finish(1.0)
    assert elapsed.left(1.0) == 0.0
    elapsed.reset()
    assert (elapsed.t, elapsed.rest) == (0.0, 0.0)


def test_rest_in_a_field_that_rounding_alone_excites() -> None:
    """A stiff, damped spring far out: what moves is rounding, and takes no steps to follow."""

    class Held(Oscillator):
        def acceleration(self, t: float, q0: float, q1: float, v0: float, v1: float) -> None:
            # the spring's end lies at 1000.1 m, where positions round to 1e-13 m
            self.a0, self.a1 = -1e4 * (q0 - 1000.1) - 200.0 * v0, 0.0

        def jacobian(self, t: float, q0: float, q1: float, v0: float, v1: float) -> None:
            self.acceleration(t, q0, q1, v0, v1)
            set_jacobian(self, (-1e4, 0.0, 0.0, 0.0, -200.0, 0.0, 0.0, 0.0))

    for start in (1000.1, 1000.1 * (1 + 3e-16)):
        model, method = Held(), create(4)
        model.q0, model.v0, model.q1, model.v1 = start, 0.0, 0.0, 0.0
        assert method.advance(model, 1e5, 1, 1e-8, 2000) == DONE
        assert model.q0 == pytest.approx(1000.1, rel=1e-15)
        assert method.evaluations < 10_000


@pytest.mark.parametrize("stabilization", [1, 2, 3], ids=["none", "baumgarte", "projection"])
def test_what_damping_has_stopped_takes_no_more_steps(stabilization: int) -> None:
    """At rest a bead trembles within rounding, which projection keeps alive: no motion to follow.

    It stopped within 0.1 s, having turned by 917 / 101 rad; another 1e6 s take but a few steps.
    """
    parameters = {
        "gravity.x": 0.0,
        "gravity.y": 0.0,
        "wire.radius": 1.235e-3,
        "bead.mass": 1.0,
        "bead.damping": 101.0,
        "bead.angle_start": -1.5,
        "bead.angular_velocity_start": 917.0,
        "constraint.stiffness": 100.0,
        "constraint.damping": 20.0,
    }
    choices = {"model.formulation": 1, "constraint.stabilization": stabilization}
    bead = bead_on_wire(choices)
    bead.start(parameters, choices)
    method = Adaptive()
    march(method, bead, 1e6, pieces=10, tolerance=1e-8)
    assert method.evaluations < 5000
    angle, rate, _ = bead.rotation()
    assert angle == pytest.approx(-1.5 + 917 / 101, abs=1e-6)
    assert abs(rate) < 1e-15


@pytest.mark.parametrize("damping", [5.0, pytest.param(1000.0, marks=pytest.mark.slow)])
@pytest.mark.parametrize("form", ["none", "baumgarte", "projection", "angle"])
def test_a_stopped_bead_that_is_pushed_and_released(form: str, damping: float) -> None:
    """Each rest is another equilibrium, where forces cancel to rounding: a few steps each.

    1e5 s of rest took up to 1e8 evaluations, to follow what rounding made tremble.
    """
    parameters = {
        "gravity.x": 0.0,
        "gravity.y": -9.81,
        "wire.radius": 0.2,
        "bead.mass": 1.0,
        "bead.damping": damping,
        "bead.angle_start": -0.46,
        "bead.angular_velocity_start": 0.0,
        "constraint.stiffness": 100.0,
        "constraint.damping": 20.0,
    }
    stabilization = ("none", "baumgarte", "projection", "angle").index(form) % 3 + 1
    choices = {
        "model.formulation": 2 if form == "angle" else 1,
        "constraint.stabilization": stabilization,
    }
    bead = bead_on_wire(choices)
    bead.start(parameters, choices)
    method = Adaptive()
    for force in (0.0, 20.0, 0.0):
        inputs = [force if name == "bead.fx" else 0.0 for name in bead.INPUTS]
        bead.set_inputs(inputs, 0)
        before = method.evaluations
        march(method, bead, 2e5, pieces=2, tolerance=1e-9)
        assert method.evaluations - before < 20_000
        angle, rate, drift = bead.rotation()
        assert math.tan(angle) == pytest.approx(force / 9.81, abs=1e-8)
        assert abs(rate) < 1e-8
        _, potential = bead.energies()
        residual = potential - bead.initial_energy - bead.work
        if form == "none":
            assert abs(drift) < 1e-3  # it grows with time, as does the work that it does
        else:
            assert abs(drift) < 1e-12
            assert abs(residual) < 1e-8


class Stiff(Model):
    """Of a given Jacobian."""

    slopes = (0.0,) * 8

    def jacobian(self, t: float, q0: float, q1: float, v0: float, v1: float) -> None:
        set_jacobian(self, self.slopes)


def test_the_usual_step_follows_from_stiffness_and_damping() -> None:
    """1/(|-3 + 1| + sqrt(9 + 7)) s, of the diagonals alone; beyond the largest, the largest."""
    model = Stiff()
    model.slopes = (-9.0, 50.0, 50.0, 7.0, -3.0, 50.0, 50.0, 1.0)
    assert usual(model, 0.0, 0.0, 0.0, 0.0, 0.0) == pytest.approx(1.0 / (2.0 + 4.0), rel=1e-15)
    model.slopes = (0.0,) * 8
    assert usual(model, 0.0, 0.0, 0.0, 0.0, 0.0) == LARGEST


def test_failures_are_told_apart() -> None:
    codes = (DONE, TOO_MANY_STEPS, STEP_TOO_SMALL, NOT_CONVERGED, NOT_FINITE)
    assert len(set(codes)) == len(codes)

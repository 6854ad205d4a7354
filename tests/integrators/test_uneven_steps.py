"""`adaptive` where guesses go wrong: strong damping, inputs that jump, steps of any size in turn.

At coarse tolerances, too: there few sweeps follow the guess. What a thrown guess set the sizes to
that errors are relative to made steps wrong in silence, 3e4 tolerances and more.
"""

from __future__ import annotations

import random

import numpy as np
import pytest
from benchmarks import ours
from scipy.linalg import expm
from small_models import Oscillator

from curvebound.kernel.base import Model
from curvebound.kernel.lobatto import Collocation
from curvebound.kernel.lobatto_tables import NODES
from curvebound.kernel.method import DONE, Method
from curvebound.kernel.methods import create
from curvebound.kernel.rounding import Rounding

KERNEL = ours.interpreted_kernel()
#: error of an output in units of the tolerance and of the output's largest value
MOST = 10.0


def silent(method: Method, tolerance: float) -> bool:
    """Whether the method makes no reservation."""
    return max(method.doubt(), method.loss()) <= tolerance


def off(model: Oscillator, pieces: list[float], tolerance: float) -> float:
    """The largest error after a piece, in units of the tolerance, of which nothing is told."""
    method = create(4)
    matrix = np.array(model.linear_system())
    exact = np.array([model.q0, model.q1, model.v0, model.v1, 1.0])
    paces = np.sqrt([model.k0, model.k1])
    size = np.abs(exact[:4])
    worst = 0.0
    for piece in pieces:
        assert method.advance(model, piece, 1, tolerance, 100_000) == DONE
        exact = expm(matrix * piece) @ exact
        size = np.maximum(size, np.abs(exact[:4]))
        # what hardly moves, to a thousandth of what its place makes of it
        size[2:] = np.maximum(size[2:], 1e-3 * paces * size[:2])
        error = np.abs(np.array([model.q0, model.q1, model.v0, model.v1]) - exact[:4])
        worst = max(worst, float((error / size).max()) / tolerance)
    assert silent(method, tolerance)
    return worst


@pytest.mark.parametrize("start", range(4))
def test_damped_oscillators(start: int) -> None:
    for seed in range(start, 200, 4):
        rng = random.Random(seed)
        pace = 10.0 ** rng.uniform(-1.0, 1.0)
        other = pace * 10.0 ** rng.uniform(-1.0, 1.0)
        damping = pace * rng.choice((0.0, 10.0 ** rng.uniform(-1.0, 2.0)))
        model = Oscillator(pace, other, damping, rng.choice((0.0, 0.0, pace * pace)))
        pieces = [5.0 / pace * rng.choice((1.0, 10.0 ** rng.uniform(-4.0, 1.0))) for _ in range(8)]
        tolerance = 10.0 ** rng.uniform(-7.0, -1.0)
        assert off(model, pieces, tolerance) < MOST, f"seed {seed}, tolerance {tolerance:g}"


@pytest.mark.parametrize("tolerance", [5e-2, 1e-2, 1e-3, 1e-4, 1e-6, 1e-8])
def test_a_coordinate_at_rest_excuses_nothing_of_the_other(tolerance: float) -> None:
    """However large the rounding of its rate is beside that."""
    for seed in range(20):
        rng = random.Random(seed)
        pace = 6.65 * 10.0 ** rng.uniform(-1.0, 1.0)
        damping = pace * 10.0 ** rng.uniform(-0.5, 1.5)
        other = pace * 10.0 ** rng.uniform(-1.0, 1.2)
        model = Oscillator(pace, other, damping, 44.0 * rng.uniform(0.1, 3.0))
        model.q0, model.v0 = 1.0, pace * rng.uniform(-1.0, 1.0)
        model.q1, model.v1 = model.f / model.k1, 0.0
        assert off(model, [5.0 / pace] * 6, tolerance) < MOST, f"seed {seed}"


@pytest.mark.parametrize("start", range(4))
def test_a_bead_in_communication_steps_of_a_nanosecond_to_two_seconds(start: int) -> None:
    """Against the same at a tolerance of 1e-14; 2800 tolerances once."""
    for seed in range(start, 160, 4):
        rng = random.Random(seed)
        values = {
            "model.formulation": rng.choice((1, 2, 2)),
            "bead.damping": rng.choice((0.0, 10.0 ** rng.uniform(-1.0, 2.5))),
            "bead.angle_start": rng.uniform(-3.1, 3.1),
            "bead.angular_velocity_start": rng.choice((0.0, rng.uniform(-20.0, 20.0))),
        }
        tolerance = 10.0 ** rng.uniform(-8.0, -2.0)
        bead, fine = (KERNEL.system("BeadOnWire", values) for _ in range(2))
        method, finer = create(4), create(4)
        size, worst = 1e-3, 0.0
        for _ in range(12):
            piece = 10.0 ** rng.uniform(-9.0, 0.3)
            inputs = [rng.choice((0.0, 0.0, rng.uniform(-30.0, 30.0))) for _ in range(4)]
            for model in (bead, fine):
                model.set_inputs(inputs, 0)
            assert method.advance(bead, piece, 1, tolerance, 100_000) == DONE
            assert finer.advance(fine, piece, 1, 1e-14, 100_000) == DONE
            size = max(size, abs(rate(fine)))
            worst = max(worst, abs(rate(bead) - rate(fine)) / size / tolerance)
        assert worst < MOST or not silent(method, tolerance), f"seed {seed}"


def rate(bead: Model) -> float:
    """The angular velocity."""
    if bead.q1 == bead.v1 == 0.0:  # by the angle
        return bead.v0
    return (bead.q0 * bead.v1 - bead.q1 * bead.v0) / (bead.q0 * bead.q0 + bead.q1 * bead.q1)


@pytest.mark.parametrize("noise", [1e-10, 1e-8, 1e-6])
@pytest.mark.parametrize("two", [True, False])
def test_a_long_step_after_a_short_one_whose_accelerations_scatter(two: bool, noise: float) -> None:
    """Their extrapolation is thrown, and is no size of the rates; 3700 tolerances once."""
    accepted = 0
    for seed in range(30):
        rng = random.Random(seed)
        h = rng.uniform(0.5, 1.5)
        for times in (4.0, 8.0, 12.0, 16.0):
            model, collocation, rounding = Oscillator(1.0, 1.5), Collocation(), Rounding()
            rounding.size0 = rounding.fast0 = 1.0
            if two:
                rounding.size1 = rounding.fast1 = 0.5
            else:
                model.q1 = model.v1 = 0.0
            collocation.h = h / times
            for i, node in enumerate(NODES):
                q0, q1, _, _ = model.exact((node - 1.0) * collocation.h)
                collocation.a[i] = -model.k0 * q0 * (1.0 + noise * rng.uniform(-1.0, 1.0))
                collocation.b[i] = -model.k1 * q1 * (1.0 + noise * rng.uniform(-1.0, 1.0))
            collocation.begin(1e-6)
            a0, b0 = -model.k0 * model.q0, -model.k1 * model.q1
            exact = model.exact(h)
            if collocation.step(model, rounding, 0.0, h, a0, b0, 1e-6) <= 1e-6:
                accepted += 1
                assert model.v0 == pytest.approx(exact[2], abs=1e-6)
                assert not two or model.v1 == pytest.approx(exact[3], abs=1e-6)
    assert accepted > 30


@pytest.mark.parametrize(
    ("slider", "pendulum", "tolerance"), [(10.0, 10.0, 1e-3), (0.0, 1.0, 3e-3), (1.0, 1.0, 1e-2)]
)
def test_a_damped_pendulum_at_a_coarse_tolerance(
    slider: float, pendulum: float, tolerance: float
) -> None:
    """The first was 1e-3 off, where its slider has come to 1e-6, the second 40 times too fast.

    The last took four times the steps.
    """
    values = {"slider.damping": slider, "pendulum.damping": pendulum, "model.fidelity": 2}
    model, fine = (KERNEL.system("ParabolaPendulum", values) for _ in range(2))
    method, finer = create(4), create(4)
    assert method.advance(model, 10.0, 1, tolerance, 10_000) == DONE
    assert finer.advance(fine, 10.0, 1, 1e-13, 10_000) == DONE
    for name in ("q0", "q1", "v0", "v1"):
        one, other = getattr(model, name), getattr(fine, name)
        assert one == pytest.approx(other, abs=tolerance * max(0.1, abs(other)))
    assert method.evaluations < finer.evaluations

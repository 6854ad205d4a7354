"""The regulator's gains against their definition, for the loops of the scenes."""

from __future__ import annotations

import math

import numpy as np
import pytest
from scipy.linalg import solve_continuous_lyapunov

from curvebound import linearize
from curvebound.cosim import load_scene
from curvebound.errors import CurveboundError
from curvebound.study.linear_model import LinearModel
from curvebound.study.regulator import gains


def plant(angle: float = 0.0, **parameters: float) -> LinearModel:
    at = {"slider.u": 0.0, "pendulum.angle": angle, **parameters}
    return linearize("ParabolaPendulum", at=at, inputs=["parabola.ax"])


def test_upright_has_one_growing_mode() -> None:
    values = np.linalg.eigvals(plant(math.pi).A)
    assert sum(v.real > 1e-6 for v in values) == 1


@pytest.mark.parametrize("angle", [0.0, math.pi])
@pytest.mark.parametrize("mass", [0.1, 10.0])
def test_gains_stabilise_and_are_optimal(angle: float, mass: float) -> None:
    model = plant(angle, **{"pendulum.mass": mass, "slider.damping": 0.1})
    row = np.array(list(gains(model).values()))
    closed = model.A - model.B @ row[None, :]
    assert np.max(np.linalg.eigvals(closed).real) < -1e-3

    def cost(k: np.ndarray) -> float:
        """Integral of x.x + u^2 from a fixed start: x.P x with P of Lyapunov's equation."""
        loop = model.A - model.B @ k[None, :]
        assert np.max(np.linalg.eigvals(loop).real) < 0.0
        found = solve_continuous_lyapunov(loop.T, -np.eye(6) - np.outer(k, k))
        start = np.array([0.1, 0, 0.1, 0, 0, 0])
        return float(start @ found @ start)

    best = cost(row)
    rng = np.random.default_rng(1)
    for _ in range(3):
        assert cost(row * (1.0 + 0.03 * rng.normal(size=6))) > best * (1.0 - 1e-9)


def test_names_are_those_of_the_states() -> None:
    model = plant()
    assert list(gains(model)) == list(model.states)


def test_what_cannot_be_is_refused() -> None:
    with pytest.raises(CurveboundError, match=r"no state slider"):
        gains(plant(), weights={"slider": 1.0})
    with pytest.raises(CurveboundError, match="one input"):
        gains(linearize("ParabolaPendulum"))
    with pytest.raises(CurveboundError, match=r"No feedback by wire\.ay"):
        gains(linearize("BeadOnWire", at={"bead.angle": 0.0}, inputs=["wire.ay"]))


@pytest.mark.parametrize(
    ("name", "angle"),
    [("active_damping", 0.0), ("inverted_balance", math.pi), ("sampled_feedback", math.pi)],
)
def test_the_scenes_have_these_gains(name: str, angle: float) -> None:
    """They are numbers there, so that the scenes run without scipy and sympy."""
    start = load_scene(name).components["drive"].start
    for state, gain in gains(plant(angle)).items():
        assert start[f"feedback.{state.replace('.', '_')}"] == pytest.approx(gain, abs=6e-5)

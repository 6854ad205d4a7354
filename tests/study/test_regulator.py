"""The regulator's linear model against known modes, and its gains against their definition."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.linalg import expm

from curvebound.cosim import load_scene
from curvebound.errors import CurveboundError
from curvebound.study.regulator import STATES, gains, linear_model


def test_modes_at_the_default_parameters():
    values = np.linalg.eigvals(linear_model()[0])
    found = sorted({round(abs(v.imag), 12) for v in values if abs(v) > 1e-6})
    assert found == pytest.approx([2.39719939786409, 5.78735129803610], abs=1e-11)


def test_upright_has_one_growing_mode():
    values = np.linalg.eigvals(linear_model(upright=True)[0])
    assert sum(v.real > 1e-6 for v in values) == 1


@pytest.mark.parametrize("upright", [False, True])
@pytest.mark.parametrize("mass", [0.1, 1.0, 10.0])
def test_gains_stabilise_and_are_optimal(upright, mass):
    parameters = {"pendulum.mass": mass, "slider.damping": 0.1}
    system, column = linear_model(parameters, upright=upright)
    row = np.array(list(gains(parameters, upright=upright).values()))
    closed = system - column @ row[None, :]
    assert np.max(np.linalg.eigvals(closed).real) < -1e-3

    def cost(k):
        """Integral of x.x + X''^2 from a fixed start, by Simpson's rule on the closed loop."""
        loop = system - column @ k[None, :]
        h, n = 0.02, 6000
        step, state, total = expm(loop * h), np.array([0.1, 0, 0.1, 0, 0, 0]), 0.0
        for i in range(n + 1):
            weight = 1 if i in (0, n) else 4 if i % 2 else 2
            total += weight * (state @ state + (k @ state) ** 2)
            state = step @ state
        return total * h / 3

    best = cost(row)
    rng = np.random.default_rng(1)
    for _ in range(3):
        assert cost(row * (1.0 + 0.03 * rng.normal(size=6))) > best * (1.0 - 1e-9)


def test_names_are_those_of_the_drive():
    assert list(gains()) == [f"feedback.{name}" for name in STATES]


def test_wrong_names_are_refused():
    with pytest.raises(CurveboundError, match=r"no parameter slider\.weight"):
        linear_model({"slider.weight": 1.0})
    with pytest.raises(CurveboundError, match="no state slider"):
        gains(weights={"slider": 1.0})


@pytest.mark.parametrize(
    ("name", "upright"),
    [("active_damping", False), ("inverted_balance", True), ("sampled_feedback", True)],
)
def test_the_scenes_have_these_gains(name, upright):
    """They are numbers there, so that the scenes run without scipy."""
    start = load_scene(name).components["drive"].start
    for path, gain in gains(upright=upright).items():
        assert start[path] == pytest.approx(gain, abs=6e-5)

"""In which time a motion changes, by closed forms."""

from __future__ import annotations

import pytest
from small_models import Oscillator

from curvebound.kernel.rates import time_of_change


@pytest.mark.parametrize(
    ("state", "stiffness", "damping", "expected"),
    [
        ((0.0, 0.0, 0.0, 0.0), 0.0, 0.0, 1.0),
        ((0.0, 0.0, 1.02, 0.0), 0.0, 0.0, 1.0 / 1.02),
        ((0.0, 0.0, 0.0, 0.98), 0.0, 0.0, 1.0),
        ((0.0, 0.0, -3.0, 2.0), 0.0, 0.0, 0.2),
        ((0.0, 0.0, 0.0, 0.0), 2.0, 0.0, 1.0 / 8.0**0.5),
        ((0.0, 0.0, 0.0, 0.0), 0.0, 3.0, 1.0 / 6.0),
        ((0.5, 0.0, 0.0, 0.0), 2.0, 0.0, 1.0 / (2.0**0.5 + 8.0**0.5)),
        ((0.0, -0.5, 0.0, 0.0), 2.0, 0.0, 1.0 / (2.0**0.5 + 8.0**0.5)),
        ((0.0, 0.0, 1.0, 1.0), 0.0, 1.0, 1.0 / (2.0 + 2.0**0.5 + 2.0)),
    ],
)
def test_time_of_change(
    state: tuple[float, ...], stiffness: float, damping: float, expected: float
) -> None:
    model = Oscillator(w0=stiffness, w1=stiffness, damping=damping)
    model.acceleration(0.0, *state)
    found = time_of_change(model, *state, model.a0, model.a1)
    assert found == pytest.approx(expected, rel=1e-14)
    model.q0_scale, model.q1_scale = 4.0, 4.0
    if damping == stiffness == 0.0:
        speed = (abs(state[2]) + abs(state[3])) / 4.0
        longer = 1.0 / max(speed, 1.0)
        assert time_of_change(model, *state, model.a0, model.a1) == pytest.approx(longer)

"""Whole turns of two angles: counted apart, kept, saved and given back."""

from __future__ import annotations

import math
from typing import Any

import pytest
from kernel_module import kernel_module

from curvebound.mechanics.derive import derive_text

TEXT = """
from sympy import cos, sin
from curvebound.mechanics import Mechanics, angle, mass
a, b = angle("first.angle"), angle("second.angle")
MECHANICS = Mechanics([a, b], [mass("body", sin(a), -cos(b))])
"""
TURN = 2.0 * math.pi


def started(first: float, second: float) -> Any:
    model = kernel_module(derive_text(TEXT, "angles", "here")).model({})
    values = dict.fromkeys(model.PARAMETERS, 1.0)
    model.start({**values, "first.angle_start": first, "second.angle_start": second}, {})
    model.set_inputs([0.0] * len(model.INPUTS), 0)
    return model


def angles(model: Any) -> tuple[float, float]:
    values = [0.0] * len(model.OUTPUTS)
    model.observe(0, values, 0)
    found = dict(zip(model.OUTPUTS, values, strict=True))
    assert found["body.x"] == pytest.approx(math.sin(model.q0))
    assert found["body.y"] == pytest.approx(-math.cos(model.q1))
    return found["first.angle"], found["second.angle"]


def test_each_has_its_own_turns() -> None:
    model = started(0.3 + 2 * TURN, 0.5 - 5 * TURN)
    assert (model.turns, model.turns1, model.settles) == (2.0, -5.0, True)
    assert (model.q0, model.q1) == pytest.approx((0.3, 0.5))
    assert angles(model) == pytest.approx((0.3 + 2 * TURN, 0.5 - 5 * TURN), rel=1e-15)
    before = model.get_state()
    model.keep()
    model.q0 += 3 * TURN
    model.q1 -= 4 * TURN
    model.settle(0.1)
    assert (model.turns, model.turns1) == (5.0, -9.0)
    model.q0 += TURN + 0.1
    model.q1 += 2 * TURN
    model.advance_frame(0.1)
    assert (model.turns, model.turns1) == (6.0, -7.0)
    assert max(abs(model.q0), abs(model.q1)) < TURN / 2
    assert angles(model) == pytest.approx((0.4 + 6 * TURN, 0.5 - 7 * TURN), rel=1e-15)
    after = model.get_state()
    model.undo()
    assert model.get_state() == before
    model.set_state(after)
    assert (model.turns, model.turns1, model.get_state()) == (6.0, -7.0, after)


@pytest.mark.parametrize(("first", "second"), [(0.3, 0.5), (0.3 + TURN, 0.5), (0.3, 0.5 - TURN)])
def test_it_settles_where_there_were_turns(first: float, second: float) -> None:
    model = started(first, second)
    assert model.settles == (abs(first) > 3.2 or abs(second) > 3.2)
    assert angles(model) == pytest.approx((first, second), rel=1e-15)
    model.q1 += TURN + 0.1
    model.advance_frame(0.1)
    assert model.settles

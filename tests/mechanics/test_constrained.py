"""The form with a multiplier of a bead on y = a x^2, by the curve's equation written otherwise."""

from __future__ import annotations

import math
from types import ModuleType
from typing import Any

import pytest

from curvebound.mechanics.derive import derive_text

TEXT = """
from curvebound.mechanics import Constraint, Mechanics, drag, length, mass, parameter
u, a = length("bead.u"), parameter("wire.bend")
bead = mass("bead", u, a * u**2)
share, unit, length_ = parameter("share"), parameter("unit"), parameter("length")
MECHANICS = Mechanics(
    [u], [bead], frame="wire", damping=[drag("bead.damping", bead)],
    constraint=Constraint(
        lambda x, y: share * (y - a * x**2),
        coordinate=lambda x, y: x * unit, distance=lambda x, y: length_ * (y - a * x**2),
    ),
)
"""
U, RATE, BEND, MASS, DRAG = 0.7, 1.3, 0.8, 1.5, 0.4
SHARE, UNIT, LENGTH = 2.5, 1.0, 3.0
VALUES = {
    "gravity.x": 0.5, "gravity.y": -9.0, "bead.mass": MASS, "wire.bend": BEND, "share": SHARE,
    "unit": UNIT, "length": LENGTH, "bead.damping": DRAG, "bead.u_start": U,
    "bead.u_rate_start": RATE, "constraint.stiffness": 0.0, "constraint.damping": 0.0,
    "wire.ax": 0.3, "wire.ay": 0.2, "bead.fx": 1.1, "bead.fy": 0.6,
}  # fmt: skip


def started(formulation: int) -> Any:
    module = ModuleType("bead")
    exec(derive_text(TEXT, "bead", "here").kernel, module.__dict__)
    choices = {"model.formulation": formulation, "constraint.stabilization": 1}
    model = module.model(choices)  # type: ignore[attr-defined]
    assert set(model.PARAMETERS) | set(model.INPUTS) == VALUES.keys()
    model.start({n: VALUES[n] for n in model.PARAMETERS}, choices)
    model.set_inputs([VALUES[n] for n in model.INPUTS], 0)
    return model


@pytest.mark.parametrize("formulation", [1, 2])
def test_parameters_of_the_constraint_alone(formulation: int) -> None:
    model = started(formulation)
    slope = 2 * BEND * U
    fx = MASS * (0.5 - 0.3) + 1.1 - DRAG * RATE
    fy = MASS * (-9.0 - 0.2) + 0.6 - DRAG * slope * RATE
    square = 1 + slope**2
    ax = ((fx + slope * fy) / MASS - slope * 2 * BEND * RATE**2) / square
    ay = slope * ax + 2 * BEND * RATE**2
    model.acceleration(0.0, model.q0, model.q1, model.v0, model.v1)
    true = (ax, ay) if formulation == 1 else (ax, 0.0)
    assert (model.a0, model.a1) == pytest.approx(true, rel=1e-13)
    values = [0.0] * len(model.OUTPUTS)
    for group in set(model.OUTPUTS.values()):
        model.observe(group, values, 0)
    found = dict(zip(model.OUTPUTS, values, strict=True))
    # gradient: share (-slope, 1)
    multiplier = (MASS * ay - fy) / SHARE
    assert found["constraint.multiplier"] == pytest.approx(multiplier, rel=1e-13)
    force = multiplier * SHARE * math.sqrt(square)
    assert found["constraint.force"] == pytest.approx(force, rel=1e-13)
    assert found["wire.fx"] == pytest.approx(DRAG * RATE + multiplier * SHARE * slope, rel=1e-13)
    assert found["wire.fy"] == pytest.approx(DRAG * slope * RATE - multiplier * SHARE, rel=1e-13)
    assert (found["bead.u"], found["bead.u_rate"]) == pytest.approx((U, RATE), rel=1e-15)
    model.q1 += 0.01 if formulation == 1 else 0.0
    model.observe(model.OUTPUTS["constraint.drift"], values, 0)
    drift = values[list(model.OUTPUTS).index("constraint.drift")]
    assert drift == pytest.approx(LENGTH * 0.01 if formulation == 1 else 0.0, rel=1e-12)

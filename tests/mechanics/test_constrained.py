"""The form with a multiplier: parameters of its own, the way back to the curve, turns."""

from __future__ import annotations

import math
from pathlib import Path
from typing import Any

import pytest
from kernel_module import kernel_module

from curvebound.fmi.folder import Folder
from curvebound.mechanics.derive import derive_text

#: y = a x^2, the curve's equation written otherwise
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
    choices = {"model.formulation": formulation, "constraint.stabilization": 1}
    model = kernel_module(derive_text(TEXT, "bead", "here")).model(choices)
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


def on_ellipse(angle: float, rate: float, stabilization: int) -> Any:
    """A bead on the ellipse of half axes 2 and 1."""
    folder = Folder(Path(__file__).parent / "systems" / "bead_on_ellipse")
    choices = {"model.formulation": 1, "constraint.stabilization": stabilization}
    model = kernel_module(folder.derived()).model(choices)
    given = {"wire.width": 2.0, "wire.height": 1.0, "bead.mass": 1.0, "bead.angle_start": angle}
    given |= {"bead.angular_velocity_start": rate}
    model.start({**dict.fromkeys(model.PARAMETERS, 0.0), **given}, choices)
    model.set_inputs([0.0] * len(model.INPUTS), 0)
    return model


def angle_of(model: Any) -> float:
    values = [0.0] * len(model.OUTPUTS)
    model.observe(0, values, 0)
    return values[list(model.OUTPUTS).index("bead.angle")]


def put(model: Any, angle: float, rate: float) -> None:
    model.q0, model.q1 = 2.0 * math.sin(angle), -math.cos(angle)
    model.v0, model.v1 = 2.0 * math.cos(angle) * rate, math.sin(angle) * rate


@pytest.mark.parametrize("stabilization", [1, 3])
@pytest.mark.parametrize(("before", "after"), [
    (3.1, 3.2), (-3.1, -3.2), (3.2, 3.1), (0.1, -0.1), (1.0, 1.0 + 2 * math.pi), (1.0, -9.0),
    (9.4, 9.45), (9.45, 9.4), (2.0, 4.5),
])  # fmt: skip
def test_turns_follow_the_rates(before: float, after: float, stabilization: int) -> None:
    h = 0.5
    rate = (after - before) / h
    model = on_ellipse(before, rate, stabilization)
    assert angle_of(model) == pytest.approx(before, rel=1e-14)
    put(model, after, rate)
    model.settle(h)
    assert angle_of(model) == pytest.approx(after, rel=1e-14)
    put(model, 2 * after - before, rate)
    model.settle(h)
    assert angle_of(model) == pytest.approx(2 * after - before, rel=1e-14)


def test_projection_takes_back_what_is_across_the_curve() -> None:
    model = on_ellipse(1.0, 0.7, 3)
    state = [model.q0, model.q1, model.v0, model.v1]
    gx, gy = model.q0 / 4.0, model.q1
    model.q0, model.q1 = model.q0 + 1e-5 * gx, model.q1 + 1e-5 * gy
    model.v0, model.v1 = model.v0 + 1e-4 * gx, model.v1 + 1e-4 * gy
    model.settle(1e-3)
    found = [model.q0, model.q1, model.v0, model.v1]
    assert abs(model.q0**2 / 4.0 + model.q1**2 - 1.0) < 4e-16
    assert abs(model.q0 / 4.0 * model.v0 + model.q1 * model.v1) < 4e-16
    assert found == pytest.approx(state, rel=1e-4)
    assert found[:2] == pytest.approx(state[:2], rel=1e-8)
    free = on_ellipse(1.0, 0.7, 1)
    free.q0 += 1e-5
    moved = free.q0
    free.settle(1e-3)
    assert free.q0 == moved

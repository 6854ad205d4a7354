"""The bead on the wire against sympy's derivation and Newton's law, at random states."""

from __future__ import annotations

import math
import random
from functools import cache
from typing import Any

import mpmath
import pytest
import sympy as sp

from curvebound.fmi.folder import find
from curvebound.kernel.base import acceleration_of, jacobian_of
from curvebound.kernel.rk4 import RK4

bead_on_wire = find("BeadOnWire").module("kernel").model

ANGLE = {"model.formulation": 2, "constraint.stabilization": 3}
NONE = {"model.formulation": 1, "constraint.stabilization": 1}
BAUMGARTE = {"model.formulation": 1, "constraint.stabilization": 2}
PROJECTION = {"model.formulation": 1, "constraint.stabilization": 3}
CARTESIAN = [NONE, BAUMGARTE, PROJECTION]

TERMS = [(), ("centre",), ("force",), ("damping",), ("centre", "force", "damping")]


def case(rng: random.Random, terms: tuple[str, ...]) -> tuple[Any, ...]:
    """Parameters, inputs, velocity of the centre, time in the step, with all `terms` random."""

    def pick(on: bool = True, size: float = 3.0) -> float:
        return rng.uniform(-size, size) if on else 0.0

    parameters = {
        "gravity.x": pick(),
        "gravity.y": -9.81 + pick(),
        "wire.radius": math.exp(pick(size=1.0)),
        "bead.mass": math.exp(pick()),
        "bead.damping": abs(pick("damping" in terms)),
        "bead.angle_start": pick(),
        "bead.angular_velocity_start": pick(),
        "constraint.stiffness": 100.0 * abs(pick()),
        "constraint.damping": 20.0 * abs(pick()),
    }
    centre, force = "centre" in terms, "force" in terms
    inputs = [pick(centre), pick(centre), pick(force, 20.0), pick(force, 20.0)]
    return parameters, inputs, (pick(centre), pick(centre)), abs(pick())


def started(choices: dict[str, int], made: tuple[Any, ...]) -> Any:
    parameters, inputs, (vx, vy), _ = made
    model = bead_on_wire(choices)
    model.start(parameters, choices)
    model.vx, model.vy = vx, vy
    model.set_inputs(inputs, 0)
    return model


def by_symbol(made: tuple[Any, ...], t: float) -> dict[str, Any]:
    p, (ax, ay, fx, fy), (vx, vy), _ = made
    with mpmath.workdps(60):
        return {
            "X_1": vx + mpmath.mpf(t) * ax,
            "Y_1": vy + mpmath.mpf(t) * ay,
            "X_2": ax,
            "Y_2": ay,
            "th_0": p["bead.angle_start"],
            "th_1": p["bead.angular_velocity_start"],
            "m": p["bead.mass"],
            "r": p["wire.radius"],
            "d": p["bead.damping"],
            "gx": p["gravity.x"],
            "gy": p["gravity.y"],
            "fx": fx,
            "fy": fy,
        }


def state(model: Any) -> tuple[float, float, float, float]:
    return model.q0, model.q1, model.v0, model.v1


def relative_acceleration(v: dict[str, Any]) -> tuple[Any, Any]:
    """p'' from the angle's second derivative."""
    s, c = mpmath.sin(v["th_0"]), mpmath.cos(v["th_0"])
    turn, inward = v["r"] * v["th_2"], v["r"] * mpmath.mpf(v["th_1"]) ** 2
    return turn * c - inward * s, turn * s + inward * c


@pytest.mark.parametrize("terms", TERMS, ids=lambda t: "+".join(t) or "free")
def test_acceleration_is_that_of_the_lagrangian(
    terms: tuple[str, ...], rng: random.Random, bead_mechanics: Any
) -> None:
    for _ in range(8):
        made = case(rng, terms)
        v = bead_mechanics.with_acceleration(by_symbol(made, 0.0))
        model = started(ANGLE, made)
        a0, a1 = acceleration_of(model, 0.0, *state(model))
        size = math.hypot(model.ux, model.uy) + abs(model.k * model.v0)
        assert abs(a0 - v["th_2"]) <= 1e-12 * size
        assert a1 == 0.0
        ax, ay = relative_acceleration(v)
        size = mpmath.hypot(ax, ay) + math.hypot(model.ex, model.ey)
        for choices in CARTESIAN:
            model = started(choices, made)
            a0, a1 = acceleration_of(model, 0.0, *state(model))
            assert abs(a0 - ax) <= 1e-12 * size
            assert abs(a1 - ay) <= 1e-12 * size


@pytest.mark.parametrize("choices", [ANGLE, *CARTESIAN], ids=["angle", "none", "b", "p"])
@pytest.mark.parametrize("terms", TERMS, ids=lambda t: "+".join(t) or "free")
def test_forces_obey_newtons_law(
    terms: tuple[str, ...],
    choices: dict[str, int],
    rng: random.Random,
    bead_mechanics: Any,
    outputs: Any,
) -> None:
    for _ in range(6):
        made = case(rng, terms)
        got = outputs(started(choices, made))
        v = bead_mechanics.with_acceleration(by_symbol(made, 0.0))
        ax, ay = relative_acceleration(v)
        # m (acceleration in the world) = gravity + external force - (force on the wire)
        wx = v["m"] * (v["gx"] - ax - v["X_2"]) + v["fx"]
        wy = v["m"] * (v["gy"] - ay - v["Y_2"]) + v["fy"]
        s, c = mpmath.sin(v["th_0"]), mpmath.cos(v["th_0"])
        outward = -(wx * s - wy * c)
        size = abs(wx) + abs(wy) + v["m"] * 9.81
        assert abs(got["wire.fx"] - wx) <= 1e-12 * size
        assert abs(got["wire.fy"] - wy) <= 1e-12 * size
        assert abs(got["constraint.force"] - outward) <= 1e-12 * size
        assert abs(got["constraint.multiplier"] * v["r"] - outward) <= 1e-12 * size
        assert abs(got["constraint.drift"]) <= 1e-15 * v["r"]


@pytest.mark.parametrize("choices", [ANGLE, *CARTESIAN], ids=["angle", "none", "b", "p"])
@pytest.mark.parametrize("terms", TERMS, ids=lambda t: "+".join(t) or "free")
def test_energy_changes_by_power(
    terms: tuple[str, ...],
    choices: dict[str, int],
    rng: random.Random,
    bead_mechanics: Any,
    outputs: Any,
) -> None:
    for _ in range(6):
        made = case(rng, terms)
        model = started(choices, made)
        out = outputs(model)
        energy = bead_mechanics.energy(*bead_mechanics.arguments(by_symbol(made, 0.0)))
        size = abs(energy) + out["energy.kinetic"] + model.m * 10.0 * model.r
        assert abs(out["energy.total"] - energy) <= 1e-12 * size
        t = made[3]
        v = bead_mechanics.with_acceleration(by_symbol(made, t))
        rate = bead_mechanics.energy_rate(*bead_mechanics.arguments(v))
        q = state(model)
        power = model.power(t, *q, *acceleration_of(model, t, *q))
        speed = 1.0 + abs(v["r"] * v["th_1"]) + abs(v["X_1"]) + abs(v["Y_1"])
        size = speed * (abs(out["wire.fx"]) + abs(out["wire.fy"]) + 20.0)
        assert abs(power - rate) <= 1e-12 * size
        assert model.works == bool(terms)
        if not terms:
            assert power == 0.0


@cache
def multiplier_equations() -> Any:
    """p'' and its derivatives from the system of equations with the multiplier as an unknown."""
    x, y, vx, vy, ax, ay, factor = sp.symbols("x y vx vy ax ay factor")
    ex, ey, k, damping, stiffness, r = parameters = sp.symbols("ex ey k damping stiffness r")
    constraint = (x**2 + y**2 - r**2) / 2
    rate = x * vx + y * vy
    equations = [
        sp.Eq(ax, ex - k * vx + factor * x),
        sp.Eq(ay, ey - k * vy + factor * y),
        sp.Eq(x * ax + y * ay + vx**2 + vy**2, -damping * rate - stiffness * constraint),
    ]
    found = sp.solve(equations, [ax, ay, factor])
    a = sp.Matrix([found[ax], found[ay]])
    position, velocity = a.jacobian([x, y]), a.jacobian([vx, vy])
    result = [*a, found[factor], *position, *velocity]
    return sp.lambdify([x, y, vx, vy, *parameters], result, "mpmath")


@pytest.mark.parametrize("choices", CARTESIAN, ids=["none", "baumgarte", "projection"])
@pytest.mark.parametrize("terms", TERMS, ids=lambda t: "+".join(t) or "free")
def test_cartesian_form_off_the_wire_and_its_jacobian(
    terms: tuple[str, ...], choices: dict[str, int], rng: random.Random, outputs: Any
) -> None:
    equations = multiplier_equations()
    for _ in range(6):
        made = case(rng, terms)
        model = started(choices, made)
        model.q0, model.q1, model.v0, model.v1 = (rng.uniform(-3.0, 3.0) for _ in range(4))
        feedback = choices is BAUMGARTE
        true = equations(
            *map(mpmath.mpf, state(model)),
            model.ex,
            model.ey,
            model.k,
            made[0]["constraint.damping"] if feedback else 0.0,
            made[0]["constraint.stiffness"] if feedback else 0.0,
            model.r,
        )
        got = [*acceleration_of(model, 0.0, *state(model))]
        got.append(outputs(model)["constraint.multiplier"] / model.m)
        size = max(map(abs, true[:3]))
        for g, x in zip(got, true, strict=False):
            assert abs(g - x) <= 1e-12 * size
        got = jacobian_of(model, 0.0, *state(model))
        size = max(map(abs, true[3:]))
        for g, x in zip(got, true[3:], strict=True):
            assert abs(g - x) <= 1e-11 * size


def test_jacobian_of_the_angle(rng: random.Random, bead_mechanics: Any) -> None:
    for terms in TERMS:
        for _ in range(10):
            made = case(rng, terms)
            model = started(ANGLE, made)
            ((by_angle, by_rate),) = bead_mechanics.derivatives(by_symbol(made, 0.0))
            got = jacobian_of(model, 0.0, *state(model))
            assert got[0] == pytest.approx(float(by_angle), rel=1e-12, abs=1e-12)
            assert got[4] == pytest.approx(float(by_rate), rel=1e-12)
            assert all(got[i] == 0.0 for i in (1, 2, 3, 5, 6, 7))


REFERENCE = {
    1: (-0.986291751131875, -0.165010853125541, -0.296905515916316, 1.77464364111266),
    10: (0.275087462576117, -0.961419205099125, -4.17559810095173, -1.19474905456048),
}


@pytest.mark.parametrize(
    ("choices", "bound"), [(ANGLE, 1e-10), (PROJECTION, 1e-9), (NONE, 2e-8), (BAUMGARTE, 1e-8)]
)
def test_reference_motion(
    choices: dict[str, int], bound: float, bead_defaults: dict[str, float], outputs: Any
) -> None:
    model = bead_on_wire(choices)
    model.start(bead_defaults, choices)
    method = RK4()
    done = 0
    for seconds, expected in REFERENCE.items():
        steps = 1000 * (seconds - done)
        method.advance(model, float(seconds - done), steps, 0.0, steps)
        done = seconds
        got = outputs(model)
        errors = [
            abs(got[f"bead.{n}"] - x) for n, x in zip(("x", "y", "vx", "vy"), expected, strict=True)
        ]
        # the angular frequency is about 3: velocities err by as much more
        assert max(errors[:2]) < bound
        assert max(errors[2:]) < 4.0 * bound
        assert abs(got["energy.residual"]) < 10.0 * bound


@pytest.mark.parametrize(("method", "kept"), [(3, 1.0 / 1.1), (4, 1.0)])
def test_projection_reaches_the_wire_and_its_tangent(
    rng: random.Random, method: int, kept: float
) -> None:
    for _ in range(50):
        made = case(rng, ())
        model = started({**PROJECTION, "solver.method": method}, made)
        r = model.r
        x, y = model.q0 * 1.1, model.q1 * 1.1
        spin = x * (model.v1 + 0.3) - y * (model.v0 - 0.2)
        model.q0, model.q1 = x, y
        model.v0 -= 0.2
        model.v1 += 0.3
        model.settle(1e-3)
        assert math.hypot(model.q0, model.q1) == pytest.approx(r, rel=4e-16)
        assert model.q0 * y == pytest.approx(model.q1 * x, rel=1e-14)
        speed = math.hypot(model.v0, model.v1)
        assert abs(model.q0 * model.v0 + model.q1 * model.v1) <= 1e-15 * r * (speed + 1.0)
        # what is tangential stays, with `adaptive` the moment of momentum
        assert model.q0 * model.v1 - model.q1 * model.v0 == pytest.approx(kept * spin, rel=1e-13)


def test_unknown_choices_are_refused(bead_defaults: dict[str, float]) -> None:
    with pytest.raises(ValueError, match=r"model\.formulation is 0: choose 1 .* or 2"):
        bead_on_wire({"model.formulation": 0})
    choices = {"model.formulation": 1, "constraint.stabilization": 4}
    with pytest.raises(ValueError, match=r"constraint\.stabilization is 4: choose 1"):
        bead_on_wire(choices).start(bead_defaults, choices)

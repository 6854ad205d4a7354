"""The derived kernels against those by hand, method by method, at states of the declared ranges."""

from __future__ import annotations

import math
import random
from collections.abc import Iterator
from typing import Any

import pytest
from kernel_module import kernel_module
from sympy import Matrix, cos, sin

from curvebound.fmi.folder import find
from curvebound.kernel.directional import output_changes
from curvebound.mechanics import Mechanics, angle, input_, mass
from curvebound.mechanics.derive import derive_text
from curvebound.study.stability.ranges import draw

NAMES = {"bead_on_wire": "BeadOnWire", "parabola_pendulum": "ParabolaPendulum"}
ITEMS = {
    "model.formulation": ("lagrange_multiplier", "angle"),
    "constraint.stabilization": ("none", "baumgarte", "projection"),
    "model.fidelity": ("linear", "nonlinear"),
}
CLOSE = 1e-12


def kernel(name: str) -> Any:
    return kernel_module(find(NAMES[name]).derived())


def pairs(name: str, count: int) -> Iterator[tuple[Any, Any, float]]:
    """Models by hand and derived in the same moving state, and a time in the step."""
    factory = find(NAMES[name]).fmu().system.factory  # type: ignore[attr-defined]
    derived = kernel(name)
    for point in draw(NAMES[name], count, seed=15):
        real = {k: float(v) for k, v in point.values.items() if not isinstance(v, str)}
        real |= {"constraint.stiffness": 100.0, "constraint.damping": 20.0}
        choices = {k: ITEMS[k].index(v) + 1 for k, v in point.values.items() if isinstance(v, str)}
        models = [factory(choices), derived.model(choices)]
        for model in models:
            model.start(real, choices)
            model.x, model.y, model.vx, model.vy = 0.1, 0.2, 0.3, -0.2
            model.set_inputs([real[n] for n in model.INPUTS], 0)
        yield models[0], models[1], 0.01 * (point.number % 3)


def state(model: Any) -> tuple[float, float, float, float]:
    return model.q0, model.q1, model.v0, model.v1


def close(got: float, true: float, size: float) -> None:
    assert abs(got - true) <= CLOSE * size, (got, true, size)


def counts(few: int, many: int) -> pytest.MarkDecorator:
    """Parametrise `count`: states by default, and in the slow tests."""
    return pytest.mark.parametrize("count", [few, pytest.param(many, marks=pytest.mark.slow)])


@counts(40, 400)
@pytest.mark.parametrize("name", NAMES)
def test_start_power_slopes_and_energies(name: str, count: int) -> None:
    for hand, mine, t in pairs(name, count):
        for x, y in zip(state(mine), state(hand), strict=True):
            assert x == pytest.approx(y, rel=1e-15)
        s = state(hand)
        hand.acceleration(t, *s)
        mine.acceleration(t, *s)
        weight = hand.q0_scale if name == "parabola_pendulum" else 1.0
        size = math.hypot(hand.a0, weight * hand.a1)
        hand.jacobian(t, *s)
        mine.jacobian(t, *s)
        for i in "01":
            fields = [f"a{i}_{n}{k}" for n in "qv" for k in "01"]
            slopes = [getattr(hand, f) * q for f, q in zip(fields, s, strict=True)]
            # what rounding of the state makes of the acceleration, where that is more
            noise = 1e-3 * sum(abs(x) for x in slopes)
            w = weight if i == "1" else 1.0
            close(w * getattr(mine, f"a{i}"), w * getattr(hand, f"a{i}"), size + w * noise)
        power = hand.power(t, *s, hand.a0, hand.a1)
        hand.energies_at(t)
        mine.energies_at(t)
        close(mine.kinetic, hand.kinetic, hand.kinetic)
        close(mine.potential, hand.potential, hand.potential_size)
        found = mine.power(t, *s, hand.a0, hand.a1)
        assert found == pytest.approx(power, rel=1e-9, abs=1e-300)
        # across the curve too, as stages of a step are
        across = (s[0], s[1], 1.1 * s[2], 0.8 * s[3])
        hand.acceleration(t, *across)
        power = hand.power(t, *across, hand.a0, hand.a1)
        found = mine.power(t, *across, hand.a0, hand.a1)
        assert found == pytest.approx(power, rel=1e-9, abs=1e-300)


@counts(25, 200)
@pytest.mark.parametrize("name", NAMES)
def test_outputs(name: str, count: int) -> None:
    for hand, mine, _ in pairs(name, count):
        assert set(mine.OUTPUTS) == set(hand.OUTPUTS)
        found = []
        for model in (hand, mine):
            values = [0.0] * len(model.OUTPUTS)
            for group in set(model.OUTPUTS.values()):
                model.observe(group, values, 0)
            found.append(dict(zip(model.OUTPUTS, values, strict=True)))
        largest = max(abs(found[0][n]) for n in found[0] if n.startswith(("constraint.f", "wire.f",
                      "constraint.n", "pendulum.t", "parabola.f")))  # fmt: skip
        for output, y in found[0].items():
            size = abs(y)
            if hand.OUTPUTS[output] == hand.OUTPUTS[f"{name.split('_')[0]}.x"]:
                size = max(size, 1.0)
            if hand.OUTPUTS[output] in hand.FEEDTHROUGH:
                size = max(size, largest, 1.0)
            if output.startswith("energy."):
                size = max(abs(found[0]["energy.kinetic"]), hand.potential_size, size)
            assert abs(found[1][output] - y) <= 1e-9 * size, (output, found[1][output], y)


@counts(25, 1000)
@pytest.mark.parametrize("name", NAMES)
def test_changes_of_outputs_with_inputs(name: str, count: int) -> None:
    rng = random.Random(3)
    for hand, mine, _ in pairs(name, count):
        seeds = {n: rng.uniform(-1.0, 1.0) for n in hand.INPUTS}
        found = []
        for model in (hand, mine):
            before = model.get_state()
            changes = output_changes(model, [seeds[n] for n in model.INPUTS])
            assert model.get_state() == before
            found.append(dict(zip(model.OUTPUTS, changes, strict=True)))
        size = max(abs(x) for x in found[0].values())
        for output, y in found[0].items():
            # the error's is the difference of larger numbers
            near = 1e-6 if output == "model.acceleration_error" else 1e-9
            assert abs(found[1][output] - y) <= near * size, (output, found[1][output], y)


def test_outputs_that_are_not_affine_have_no_directional_derivative() -> None:
    phi, torque = angle("bead.angle"), input_("bead.torque")
    bead = mass("bead", sin(phi), -cos(phi))
    pull = Matrix([sin(phi), -cos(phi)]).dot(bead.reaction)

    def made(**stated: Any) -> Any:
        return Mechanics(coordinates=[phi], masses=[bead], **stated)

    assert made(couples={phi: torque * cos(phi)}, observed={"pull": torque + 2 * pull}).is_affine
    for stated in (
        made(couples={phi: torque**2}),
        made(observed={"pull": abs(pull)}),
        made(observed={"pull": torque * pull}),
    ):
        assert not stated.is_affine
    text = """
from sympy import cos, sin
from curvebound.mechanics import Mechanics, angle, input_, mass
phi = angle("bead.angle")
bead = mass("bead", sin(phi), -cos(phi))
MECHANICS = Mechanics([phi], [bead], couples={phi: input_("bead.torque") ** 2})
"""
    assert "    AFFINE: ClassVar[bool] = False\n" in derive_text(text, "bead", "here").kernel
    affine = derive_text(text.replace(" ** 2", ""), "bead", "here")
    assert "AFFINE" not in affine.kernel


def test_linear_system_and_power_form() -> None:
    count = 0
    for hand, mine, _ in pairs("parabola_pendulum", 60):
        if not hand.is_linear or not hand.is_constant:
            continue
        count += 1
        for name in ("linear_system", "power_form"):
            for x, y in zip(getattr(mine, name)(), getattr(hand, name)(), strict=True):
                size = max(abs(v) for v in y)
                for a, b in zip(x, y, strict=True):
                    close(a, b, size)
    assert count > 10

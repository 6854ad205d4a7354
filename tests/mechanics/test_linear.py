"""Small motion about a rest that is not at zero: an upright pendulum, by its expansion by hand."""

from __future__ import annotations

import math
from types import SimpleNamespace
from typing import Any

import pytest
from kernel_module import kernel_module

from curvebound.mechanics.derive import derive_text
from curvebound.mechanics.derived import Derived
from curvebound.mechanics.numeric import double

TEXT = """
from sympy import cos, pi, sin
from curvebound.mechanics import Mechanics, angle, drag, input_, mass, parameter
r, th = parameter("rod.length"), angle("rod.angle")
bob = mass("bob", r * sin(th), -r * cos(th))
MECHANICS = Mechanics(
    [th], [bob], frame="cart", damping=[drag("joint", th)], couples={th: input_("torque")},
    potential=parameter("stiffness") * (th - pi) ** 2 / 2, linear_about={th: pi},
)
"""
VALUES = {
    "gravity.x": 0.4, "gravity.y": -9.0, "bob.mass": 1.5, "rod.length": 0.7, "stiffness": 2.0,
    "joint": 0.3, "rod.angle_start": math.pi + 0.2, "rod.angular_velocity_start": 0.6,
    "cart.ax": 0.9, "cart.ay": -0.8, "bob.fx": 1.1, "bob.fy": 1.3, "torque": 0.5,
}  # fmt: skip
PUSHES = ("cart.ax", "cart.ay", "bob.fx", "bob.fy", "torque")


@pytest.fixture
def pendulum() -> Derived:
    return derive_text(TEXT, "upright", "here")


def started(derived: Derived, **more: float) -> tuple[Any, Any]:
    """The linear model, and all values by short names; x: from upright, w: its rate."""
    values = VALUES | {n.replace("__", "."): x for n, x in more.items()}
    model = kernel_module(derived).model({"model.fidelity": 1})
    model.start({n: values[n] for n in model.PARAMETERS}, {"model.fidelity": 1})
    model.set_inputs([values[n] for n in model.INPUTS], 0)
    s = SimpleNamespace(**{n.replace(".", "_"): x for n, x in values.items()})
    s.x, s.w, s.inertia = s.rod_angle_start - math.pi, s.rod_angular_velocity_start, 0.0
    s.inertia = s.bob_mass * s.rod_length**2
    return model, s


def given(s: Any) -> float:
    """Couple of all but gravity and spring, to first order: r (sin, -cos) = r (-x, 1)."""
    fx, fy = s.bob_fx - s.bob_mass * s.cart_ax, s.bob_fy - s.bob_mass * s.cart_ay
    return s.torque - s.joint * s.w - s.rod_length * (fx + s.x * fy)


def acceleration(s: Any) -> float:
    falls = -s.bob_mass * s.rod_length * (s.gravity_x + s.gravity_y * s.x)
    return (given(s) + falls - s.stiffness * s.x) / s.inertia


@pytest.mark.parametrize("off", [(), (*PUSHES, "joint"), ("cart.ax", "cart.ay")], ids=str)
def test_accelerations_energies_and_power(pendulum: Derived, off: tuple[str, ...]) -> None:
    model, s = started(pendulum, **dict.fromkeys(off, 0.0))
    angle = s.rod_angle_start
    model.acceleration(0.0, angle, 0.0, s.w, 0.0)
    assert model.a0 == pytest.approx(acceleration(s), rel=1e-13)
    assert model.power(0.0, angle, 0.0, s.w, 0.0, model.a0, 0.0) == pytest.approx(
        given(s) * s.w, rel=1e-13
    )
    m, r = s.bob_mass, s.rod_length
    potential = m * r * (s.gravity_x * s.x + s.gravity_y * s.x**2 / 2) + s.stiffness * s.x**2 / 2
    assert model.energies() == pytest.approx((s.inertia * s.w**2 / 2, potential), rel=1e-13)
    # as a matrix, and as a form of (angle, 0, rate, 0, 1)
    state = (angle, 0.0, s.w, 0.0, 1.0)
    changes = [sum(a * z for a, z in zip(row, state, strict=True)) for row in model.linear_system()]
    assert changes == pytest.approx([s.w, 0.0, acceleration(s), 0.0, 0.0], rel=1e-12)
    form = model.power_form()
    power = sum(form[i][k] * state[i] * state[k] for i in range(5) for k in range(5))
    assert power == pytest.approx(given(s) * s.w, rel=1e-12)
    assert all(form[i][k] == form[k][i] for i in range(5) for k in range(5))


def test_outputs(pendulum: Derived) -> None:
    model, s = started(pendulum)
    values = [0.0] * len(model.OUTPUTS)
    for group in set(model.OUTPUTS.values()):
        model.observe(group, values, 0)
    found = dict(zip(model.OUTPUTS, values, strict=True))
    m, r, w, a = s.bob_mass, s.rod_length, s.w, acceleration(s)
    sine, cosine = math.sin(s.rod_angle_start), math.cos(s.rod_angle_start)
    # Newton's law in exact geometry
    ax = r * (a * cosine - w * w * sine) + s.cart_ax - s.gravity_x
    ay = r * (a * sine + w * w * cosine) + s.cart_ay - s.gravity_y
    assert found["cart.fx"] == pytest.approx(s.bob_fx - m * ax, rel=1e-13)
    assert found["cart.fy"] == pytest.approx(s.bob_fy - m * ay, rel=1e-13)
    assert found["bob.y"] == pytest.approx(-r * cosine, rel=1e-14)
    couple = s.torque - s.joint * w - s.stiffness * s.x
    fx = s.bob_fx + m * (s.gravity_x - s.cart_ax)
    fy = s.bob_fy + m * (s.gravity_y - s.cart_ay)
    full = (couple + r * (cosine * fx + sine * fy)) / s.inertia
    model.compare()
    assert (model.linear0, model.full0) == pytest.approx((r * a, r * full), rel=1e-13)
    assert (model.linear1, model.full1) == (0.0, 0.0)


def test_the_same_equations_with_other_numbers(pendulum: Derived) -> None:
    _, s = started(pendulum)
    symbols = pendulum.at(double, VALUES, 0.0)
    (found,) = pendulum.function("linear_accelerations")(double, symbols)
    assert found == pytest.approx(acceleration(s), rel=1e-13)
    assert sum(pendulum.function("linear_fed")(double, symbols)) == pytest.approx(given(s) * s.w)
    assert pendulum.function("linear_weights")(double, symbols) == [s.rod_length]


@pytest.mark.parametrize("name", ["", *PUSHES, "joint"])
def test_anything_but_gravity_and_springs_works(pendulum: Derived, name: str) -> None:
    off = {n: 0.0 for n in (*PUSHES, "joint") if n != name}
    model, _ = started(pendulum, **off)
    assert model.works == bool(name)
    assert model.uses_rates == (not name.startswith("cart") and bool(name))

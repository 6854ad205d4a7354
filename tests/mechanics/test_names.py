"""Symbols that are called like what a kernel has already: the same motion all the same."""

from __future__ import annotations

import pytest
from kernel_module import kernel_module

from curvebound.mechanics.derive import derive_text

TEXT = """
from curvebound.mechanics import Mechanics, input_, length, mass, parameter, shape
x0, a0 = length("cart.u"), shape("at.a0")
k0, k1, k2, x1, t, slope = (parameter(f"at.{n}") for n in ("k0", "k1", "k2", "x1", "t", "slope"))
q0, inverse = parameter("at.q0"), input_("at.inverse")
cart = mass("cart", x0, slope * x0)
MECHANICS = Mechanics(
    [x0], [cart], potential=k0 * (x0 - a0)**2 / 2 + x1 * x0**4 / 4,
    couples={x0: inverse * x0 - k1 * x0.rate - q0 * t * x0.rate**3 + parameter("lambda") * k2},
)
"""


def test_names_that_are_taken() -> None:
    model = kernel_module(derive_text(TEXT, "names", "here")).model({})
    values = {n: 0.7 + 0.1 * i for i, n in enumerate((*model.PARAMETERS, *model.INPUTS))}
    model.start(values, {})
    model.set_inputs([values[n] for n in model.INPUTS], 0)
    k0, k1, k2, x1, t, q0, inverse, slope = (
        values[f"at.{n}"] for n in ("k0", "k1", "k2", "x1", "t", "q0", "inverse", "slope")
    )
    x, v, m = values["cart.u_start"], values["cart.u_rate_start"], values["cart.mass"]
    h = 0.1
    push = values["at.a0_acceleration"]
    a0 = values["at.a0_start"] + h * values["at.a0_rate_start"] + h * h * push / 2
    force = inverse * x - k1 * v - q0 * t * v**3 + values["lambda"] * k2
    force -= k0 * (x - a0) + x1 * x**3
    force += values["cart.fx"] + slope * values["cart.fy"]
    inertia = m * (1 + slope**2)
    true = force / inertia + (values["gravity.x"] + slope * values["gravity.y"]) / (1 + slope**2)
    model.acceleration(h, x, 0.0, v, 0.0)
    assert model.a0 == pytest.approx(true, rel=1e-13)
    model.jacobian(h, x, 0.0, v, 0.0)
    slopes = ((inverse - k0 - 3 * x1 * x * x) / inertia, -(k1 + 3 * q0 * t * v * v) / inertia)
    assert (model.a0_q0, model.a0_v0) == pytest.approx(slopes, rel=1e-13)

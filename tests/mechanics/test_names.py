"""Symbols that are called like what a kernel has already: the same motion all the same."""

from __future__ import annotations

from types import ModuleType

import pytest

from curvebound.mechanics.derive import derive_text

TEXT = """
from curvebound.mechanics import Mechanics, input_, length, mass, parameter
x0 = length("cart.u")
k0, k1, k2, x1, t = (parameter(f"at.{n}") for n in ("k0", "k1", "k2", "x1", "t"))
q1, inverse = parameter("at.q1"), input_("at.inverse")
cart = mass("cart", x0, 0)
MECHANICS = Mechanics(
    [x0], [cart], potential=k0 * x0**2 / 2 + x1 * x0**4 / 4,
    couples={x0: inverse - k1 * x0.rate - q1 * t * x0.rate**3 + parameter("lambda") * k2},
)
"""


def test_names_that_are_taken() -> None:
    module = ModuleType("names")
    exec(derive_text(TEXT, "names", "here").kernel, module.__dict__)
    model = module.model({})  # type: ignore[attr-defined]
    values = {n: 0.7 + 0.1 * i for i, n in enumerate((*model.PARAMETERS, *model.INPUTS))}
    model.start(values, {})
    model.set_inputs([values[n] for n in model.INPUTS], 0)
    k0, k1, k2, x1, t, q1, inverse = (
        values[f"at.{n}"] for n in ("k0", "k1", "k2", "x1", "t", "q1", "inverse")
    )
    x, v, m = values["cart.u_start"], values["cart.u_rate_start"], values["cart.mass"]
    force = inverse - k1 * v - q1 * t * v**3 + values["lambda"] * k2 - k0 * x - x1 * x**3
    model.acceleration(0.1, x, 0.0, v, 0.0)
    true = (force + values["cart.fx"]) / m + values["gravity.x"]
    assert model.a0 == pytest.approx(true, rel=1e-13)
    model.jacobian(0.1, x, 0.0, v, 0.0)
    slopes = (-(k0 + 3 * x1 * x * x) / m, -(k1 + 3 * q1 * t * v * v) / m)
    assert (model.a0_q0, model.a0_v0) == pytest.approx(slopes, rel=1e-13)

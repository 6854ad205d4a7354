"""Expressions as plain Python: the same numbers as sympy's."""

from __future__ import annotations

import math

import pytest
import sympy
from sympy import Rational, Symbol, cos, sin

from curvebound.mechanics import Mechanics, length, mass
from curvebound.mechanics.derivation import Derivation
from curvebound.mechanics.kernel_writer import symbols_in
from curvebound.mechanics.source import Lines, Printer, identifier
from curvebound.mechanics.sums import shorter

X, Y = Symbol("x", real=True), Symbol("y", real=True)


@pytest.mark.parametrize(
    "expression",
    [
        (X**2 + Y**2) ** Rational(3, 2),
        X / (X**2 + Y**2) ** Rational(5, 2),
        1 / sympy.sqrt(X**2 + 1) - (1 + Y**2) ** -1.5,
        X**2.0 + abs(Y) ** 3.0 * sympy.sign(Y),
        (abs(Y) * Y).diff(Y) / 7,
        sympy.exp(-(X**2)) * sympy.tanh(Y) + sympy.pi,
    ],
    ids=str,
)
@pytest.mark.parametrize("form", ["printed", "lines"])
def test_it_gives_the_same_numbers(expression: sympy.Expr, form: str) -> None:
    printer = Printer({X: "x", Y: "y"})
    for x, y in ((0.7, -1.3), (-2.0, 0.25)):
        values = {"math": math, "x": x, "y": y}
        if form == "printed":
            got = eval(printer(expression), values)
        else:
            exec("\n".join(Lines(printer).of([("got", expression)], "")), values)
            got = values["got"]
        assert got == pytest.approx(float(expression.subs({X: x, Y: y})), rel=1e-14)


@pytest.mark.parametrize(
    "expression",
    [
        1 / (1 + X * cos(Y)) + sin(Y) ** 2,
        sympy.sqrt(sin(Y) ** 2 + X * cos(Y) ** 2),
        sin(Y) ** 2 / (cos(Y) ** 2 + 2) + sin(Y) ** 2 + cos(Y) ** 2,
    ],
    ids=str,
)
def test_quotients_and_roots_of_sines_are_left_right(expression: sympy.Expr) -> None:
    point = {X: 0.3, Y: 0.7}
    assert float(shorter(expression).subs(point)) == pytest.approx(float(expression.subs(point)))


A, B, C = (Symbol(name, real=True) for name in ("of.a", "of.b", "of.c"))
SHARED = {A: X + sin(Y), B: A**2 + X * Y, C: B * sin(Y) - 2 * A, Symbol("unused"): X}


@pytest.mark.parametrize("wanted", [C, B, A, C * X - B, C + A * cos(X), X + Y], ids=str)
def test_shared_expressions_are_computed_before_those_that_need_them(wanted: sympy.Expr) -> None:
    values = {"math": math, "x": 0.7, "y": -1.3}
    printer = Printer({X: "x", Y: "y"} | {s: identifier(s.name) for s in SHARED})
    lines = Lines(printer, SHARED).of([("got", wanted)], "")
    exec("\n".join(lines), values)
    true = wanted
    for s, e in reversed(SHARED.items()):
        true = true.subs(s, e)
    assert values["got"] == pytest.approx(float(true.subs({X: 0.7, Y: -1.3})), rel=1e-14)
    assert symbols_in([wanted], SHARED) == true.free_symbols
    u = length("u")
    derivation = Derivation(Mechanics([u], [mass("body", u, 0)]))
    derivation.shared = SHARED
    slope = derivation.along(wanted, Y)
    for s, e in reversed(SHARED.items()):
        slope = slope.subs(s, e)
    assert sympy.expand(slope - true.diff(Y)) == 0
    assert "unused" not in "".join(lines)


def test_what_has_no_plain_form_is_said() -> None:
    with pytest.raises(ValueError, match="gamma is not known here"):
        Printer({X: "x"})(sympy.gamma(X))
    with pytest.raises(ValueError, match="use whole powers"):
        Printer({X: "x"})(X ** Rational(1, 3))

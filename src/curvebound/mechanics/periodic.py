"""Whether whole turns of an angle change anything."""

from __future__ import annotations

import random

import sympy
from sympy import Expr, Symbol

__all__ = ["is_periodic"]


def is_periodic(e: Expr, c: Symbol) -> bool:
    """Whether an expression is the same when c has made a turn, judged at a random point."""
    if not e.has(c):
        return True
    rng = random.Random(1)
    symbols = sorted(e.free_symbols, key=str)
    point = {s: sympy.Rational(rng.randint(1, 99), 50) for s in symbols}
    turned = {**point, c: point[c] + 2 * sympy.pi}
    return bool(abs(sympy.N(e.subs(turned) - e.subs(point), 30)) <= 1e-20)

"""One mass in Cartesian coordinates, held on a curve C(x, y) = 0 by a multiplier.

With G = grad C, H its Hessian, e the field and F external force and drag,

    p'' = e + (F + lambda G)/m,     C'' = G.p'' + v.H v = -damping C' - stiffness C

the right-hand side being zero without Baumgarte's stabilisation (Baumgarte 1972).
"""

from __future__ import annotations

from collections.abc import Sequence
from functools import cached_property
from typing import TYPE_CHECKING

import sympy
from sympy import Expr, Symbol

from .elements import Constraint
from .sums import shorter

if TYPE_CHECKING:
    from .derivation import Derivation

__all__ = ["Constrained"]


class Constrained:
    """What follows from a constraint; symbols position.x, .y and velocity.x, .y (of the frame)."""

    def __init__(self, derivation: Derivation, constraint: Constraint) -> None:
        self.full = derivation
        self.p = [Symbol("position.x", real=True), Symbol("position.y", real=True)]
        self.v = [Symbol("velocity.x", real=True), Symbol("velocity.y", real=True)]
        self.stiffness = Symbol("constraint.stiffness", real=True)
        self.damping = Symbol("constraint.damping", real=True)
        self.equation = sympy.sympify(constraint.equation(*self.p))
        self.coordinate = sympy.sympify(constraint.coordinate(*self.p))
        self.gradient = [self.equation.diff(x) for x in self.p]
        self.square = sympy.Add(*(g**2 for g in self.gradient))
        if constraint.distance is None:
            self.distance = self.equation / sympy.sqrt(self.square)
        else:
            self.distance = sympy.sympify(constraint.distance(*self.p))
        self.mass = derivation.rows[0].mass

    @cached_property
    def rate(self) -> Expr:
        """C'."""
        return sympy.Add(*(g * v for g, v in zip(self.gradient, self.v, strict=True)))

    @cached_property
    def free(self) -> list[Expr]:
        """Acceleration without the constraint."""
        d = self.full
        dampers = sympy.Add(*(x.coefficient for x in d.mechanics.damping if x.of == d.rows[0].of))
        return [
            r.field + (r.external - dampers * v) / r.mass
            for r, v in zip(d.raw, self.v, strict=True)
        ]

    def leaving(self, free: Sequence[Expr]) -> Expr:
        """C'' with these accelerations."""
        curved = (
            self.equation.diff(a, b) * va * vb
            for a, va in zip(self.p, self.v, strict=True)
            for b, vb in zip(self.p, self.v, strict=True)
        )
        return sympy.Add(*(g * a for g, a in zip(self.gradient, free, strict=True)), *curved)

    @cached_property
    def feedback(self) -> Expr:
        """What stabilisation takes from C''."""
        return self.damping * self.rate + self.stiffness * self.equation

    @cached_property
    def specific(self) -> Expr:
        """The multiplier per mass."""
        return -(self.leaving(self.free) + self.feedback) / self.square

    def held(self, free: Sequence[Expr], specific: Expr) -> list[Expr]:
        """Accelerations with a multiplier per mass."""
        return [a + specific * g for a, g in zip(free, self.gradient, strict=True)]

    @cached_property
    def accelerations(self) -> list[Expr]:
        """p'' relative to the frame."""
        return self.held(self.free, self.specific)

    @cached_property
    def _on_curve(self) -> dict[Symbol, Expr]:
        return {x: r.position for x, r in zip(self.p, self.full.raw, strict=True)}

    @cached_property
    def multiplier(self) -> Expr:
        """The multiplier of the exact motion, in the generalised coordinate."""
        square = shorter(self.square.subs(self._on_curve))
        factors = [shorter(g.subs(self._on_curve)) / square for g in self.gradient]
        return self.full.reactions.combined(factors)

    @cached_property
    def force(self) -> Expr:
        """Its size, positive along the gradient."""
        return self.multiplier * sympy.sqrt(shorter(self.square.subs(self._on_curve)))

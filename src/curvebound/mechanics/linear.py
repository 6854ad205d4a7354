"""The quadratic part of the Lagrangian about a declared rest.

With x = q - rest and J, J' the first and second derivatives of the positions there, what is kept of
the virtual work is linear in x, x' and x'':

    M(rest) x'' = sum J_i f_i + sum (J'_i x) (f_i at rest)

where f_i, as in derivation.py, is kept to first order. Shapes stay functions of time. Numerators
are sums by monomials of the masses here too: a light mass that follows a heavy one does not cancel.
"""

from __future__ import annotations

from functools import cached_property
from itertools import combinations

import sympy
from sympy import Expr

from .derivation import Derivation
from .sums import ONE, ZERO, Sum, over, shorter

__all__ = ["Linear"]


class Linear:
    """What follows from a derivation for small motion about the rest of its statement."""

    def __init__(self, derivation: Derivation) -> None:
        self.full = derivation
        self.q, self.v = derivation.q, derivation.v
        about = derivation.mechanics.linear_about
        assert about is not None
        self.rest = {c: sympy.nsimplify(about.get(c, 0)) for c in self.q}
        self.away = [c - self.rest[c] for c in self.q]
        self.rows = derivation.raw
        self.slopes = [[self._at_rest(j) for j in r.slopes] for r in self.rows]

    def _at_rest(self, e: Expr) -> Expr:
        still = dict.fromkeys(self.v, ZERO)
        return sympy.sympify(e).subs({**self.rest, **still})

    def first(self, e: Expr) -> Expr:
        """An expression to first order in displacements and rates."""
        e = sympy.sympify(e)
        found = self._at_rest(e)
        for symbol, by in zip((*self.q, *self.v), (*self.away, *self.v), strict=True):
            found += self._at_rest(e.diff(symbol)) * by
        return sympy.expand(found)

    def second(self, e: Expr) -> Expr:
        """An expression to second order in displacements and rates."""
        e = sympy.sympify(e)
        symbols, by = (*self.q, *self.v), (*self.away, *self.v)
        found = self.first(e)
        for s, x in zip(symbols, by, strict=True):
            for w, y in zip(symbols, by, strict=True):
                found += self._at_rest(e.diff(s, w)) * x * y / 2
        return sympy.expand(found)

    @cached_property
    def forces(self) -> list[list[tuple[Expr, str, Expr]]]:
        """Generalised forces M(rest) x'': for each coordinate factors, of what, and terms."""
        found: list[list[tuple[Expr, str, Expr]]] = [[] for _ in self.q]
        own = self.full.couples, self.full.resisting, self.full.restoring
        for k in range(len(self.q)):
            for i, row in enumerate(self.rows):
                bent = sympy.Add(
                    *(
                        self._at_rest(row.slopes[k].diff(c)) * x
                        for c, x in zip(self.q, self.away, strict=True)
                    )
                )
                for factor, what, force in row.forces:
                    still = self._at_rest(force)
                    term = self.slopes[i][k] * self.first(force) + bent * still
                    found[k].append((factor, what, sympy.expand(term)))
            for terms in own:
                found[k].append((ONE, "couples", self.first(terms[k])))
        return found

    @cached_property
    def determinant(self) -> Sum:
        """Of the mass matrix at rest."""
        found = Sum()
        if len(self.q) == 1:
            for row, (j,) in zip(self.rows, self.slopes, strict=True):
                found.add(row.mass, "", j * j)
            return found.short()
        for (a, (a0, a1)), (b, (b0, b1)) in combinations(
            zip(self.rows, self.slopes, strict=True), 2
        ):
            found.add(a.mass * b.mass, "", (a0 * b1 - b0 * a1) ** 2)
        return found.short()

    @cached_property
    def accelerations(self) -> tuple[list[Expr], Expr]:
        """Numerators of x'' and their common denominator."""
        numerators = [Sum() for _ in self.q]
        if len(self.q) == 1:
            for factor, what, term in self.forces[0]:
                numerators[0].add(factor, what, term)
        else:
            for row, (j0, j1) in zip(self.rows, self.slopes, strict=True):
                for (factor, what, f0), (_, _, f1) in zip(*self.forces, strict=True):
                    monomial = factor * row.mass
                    numerators[0].add(monomial, what, j1 * j1 * f0 - j0 * j1 * f1)
                    numerators[1].add(monomial, what, j0 * j0 * f1 - j0 * j1 * f0)
        return over([n.short() for n in numerators], self.determinant)

    @cached_property
    def kinetic(self) -> Expr:
        """Kinetic energy relative to the frame."""
        speeds = [
            sympy.Add(*(j * v for j, v in zip(slopes, self.v, strict=True)))
            for slopes in self.slopes
        ]
        return sympy.Add(*(r.mass * s**2 / 2 for r, s in zip(self.rows, speeds, strict=True)))

    @cached_property
    def potential_terms(self) -> list[Expr]:
        """What adds up to the potential energy, zero at rest."""
        full = self.full
        whole = [-r.mass * full.gravity[r.axis] * r.position for r in self.rows]
        return [
            shorter(e)
            for e in (self.second(x) - self._at_rest(x) for x in [*whole, full.potential])
            if e != 0
        ]

    @cached_property
    def power(self) -> Expr:
        """Rate of kinetic plus potential energy: all but gravity and the potential does work."""
        potential = sympy.Add(*self.potential_terms)
        total = sympy.Add(
            *(v * f * t for v, terms in zip(self.v, self.forces, strict=True) for f, _, t in terms),
            *(potential.diff(c) * v for c, v in zip(self.q, self.v, strict=True)),
            *((potential + self.kinetic).diff(s) * s.rate for s in self.full.mechanics.shapes),
        )
        # the field is gravity less the acceleration of the frame
        full = self.full
        field = {f: g - a for f, g, a in zip(full.field, full.gravity, full.push, strict=True)}
        return shorter(sympy.expand(total.subs(field)))

    @cached_property
    def weights(self) -> list[Expr]:
        """How far (m) a unit of each coordinate moves the first mass that it moves, at rest."""
        found = []
        for k in range(len(self.q)):
            for m in self.full.mechanics.masses:
                square = sympy.Add(
                    *(
                        slopes[k] ** 2
                        for r, slopes in zip(self.rows, self.slopes, strict=True)
                        if r.of == m
                    )
                )
                if square != 0:
                    found.append(sympy.sqrt(shorter(square)))
                    break
            else:
                found.append(ONE)
        return found

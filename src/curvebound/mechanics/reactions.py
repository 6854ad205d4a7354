"""The forces with which constraints act on the masses: curves, rods, frame and shapes.

Notation as in derivation.py. On row i acts what is missing to f_i for its acceleration,

    R_i D = -sum C_jk (m_j m_k C_jk f_i - m_i m_k C_ik f_j + m_i m_j C_ij f_k)     j, k other than i

with sums over j < k; for one coordinate R_i D = -sum J_j (m_j J_j f_i - m_i J_i f_j).
"""

from __future__ import annotations

from functools import cached_property
from itertools import combinations
from typing import TYPE_CHECKING

from sympy import Expr

from .sums import ONE, ZERO, Sum, over, shorter

if TYPE_CHECKING:
    from .derivation import Derivation, Row

__all__ = ["Reactions"]


class Reactions:
    """What follows from a derivation for the forces that it does not contain."""

    def __init__(self, derivation: Derivation) -> None:
        self.full = derivation
        self.rows = derivation.rows

    def combined(self, factors: list[Expr]) -> Expr:
        """sum factor_i R_i, a factor to each row, damping of the masses included."""
        total = Sum()
        damping = ZERO
        for row, factor in zip(self.rows, factors, strict=True):
            if factor != 0:
                total = total.plus(self._each[row.of.name, row.axis].times(factor))
                damping += factor * row.drag
        (numerator,), denominator = over([total.short()], self.full.determinant)
        return numerator / denominator + shorter(damping)

    @cached_property
    def _each(self) -> dict[tuple[str, int], Sum]:
        """R_i D by mass and axis, without the drag itself."""
        return {(row.of.name, row.axis): self._reaction(row).short() for row in self.rows}

    def _reaction(self, row: Row) -> Sum:
        found = Sum()
        others = [r for r in self.rows if r is not row]

        def add(of: Row, monomial: Expr, factor: Expr) -> None:
            for m, what, force in of.forces:
                found.add(m * monomial, what, factor * force)

        if len(self.full.q) == 1:
            (j,) = row.slopes
            for a in others:
                (ja,) = a.slopes
                add(row, a.mass, -ja * ja)
                add(a, row.mass, ja * j)
            found.add(row.mass, "couples", j * self.full.generalised[0])
            return found
        for a, b in combinations(others, 2):
            c = self.full.minor(a, b)
            add(row, a.mass * b.mass, -c * c)
            add(a, row.mass * b.mass, c * self._cross(row, b))
            add(b, row.mass * a.mass, -c * self._cross(row, a))
        for a in others:
            couple = self.full.generalised[0] * a.slopes[1] - self.full.generalised[1] * a.slopes[0]
            found.add(row.mass * a.mass, "couples", self._cross(row, a) * couple)
        return found

    def _cross(self, a: Row, b: Row) -> Expr:
        """C_ij in the order of the rows given."""
        if self.rows.index(a) < self.rows.index(b):
            return self.full.minor(a, b)
        return -self.full.minor(b, a)

    @cached_property
    def held(self) -> list[Expr]:
        """Forces with which frame (x, y) and shapes act on the masses.

        The force that goes with a shape is the power that it spends per rate of the shape.
        """
        found = []
        for axis in (0, 1):
            factors: list[Expr] = [ONE if row.axis == axis else ZERO for row in self.rows]
            found.append(self.combined(factors))
        for s in self.full.mechanics.shapes:
            found.append(self.combined([row.position.diff(s) for row in self.full.raw]))
        return found

    def observed(self, expression: Expr) -> Expr:
        """An expression of the statement, its reactions replaced."""
        factors = [expression.diff(row.of.reaction[row.axis]) for row in self.rows]
        still = {row.of.reaction[row.axis]: ZERO for row in self.rows}
        rest = expression.subs(still)
        if all(f == 0 for f in factors):
            return rest
        return self.combined(factors) + rest

"""From positions and forces to accelerations, energies and power.

Notation: a row i is one Cartesian component of one mass; J_ik = d(position_i)/d(q_k), f_i the force
on it less mass times the acceleration that is left when q'' = 0, C_ij = J_i0 J_j1 - J_j0 J_i1.
By Cauchy and Binet, with sums over i < j,

    D       = sum m_i m_j C_ij^2
    q_0'' D = sum C_ij (m_j f_i J_j1 - m_i f_j J_i1)
    q_1'' D = sum C_ij (m_i f_j J_i0 - m_j f_i J_j0)

For one coordinate D = sum m_i J_i^2, q'' D = sum J_i f_i. Generalised forces (couples) enter by the
adjugate of the mass matrix. No ratio of masses cancels in any of these sums.
"""

from __future__ import annotations

from functools import cached_property
from itertools import combinations
from typing import NamedTuple

import sympy
from sympy import Expr, Symbol

from .constrained import Constrained
from .elements import Coordinate, Input, Mass, Parameter
from .reactions import Reactions
from .statement import Mechanics
from .sums import ONE, ZERO, Sum, over, shorter

__all__ = ["Derivation", "Row"]


class Row(NamedTuple):
    """One Cartesian component of a mass.

    axis: 0 for x, 1 for y. position: from the frame. slopes: J. left: the acceleration relative to
    the frame that is left without q''. field: the symbol of gravity less the frame's acceleration.
    external, drag: forces on it.
    """

    of: Mass
    axis: int
    position: Expr
    slopes: list[Expr]
    left: Expr
    field: Symbol
    external: Expr
    drag: Expr

    @property
    def mass(self) -> Parameter:
        """Its mass."""
        return self.of.mass

    @property
    def forces(self) -> list[tuple[Expr, str, Expr]]:
        """What adds up to f: factor, of what it is, force."""
        return [
            (self.mass, "field", self.field - self.left),
            (ONE, f"force on {self.of.name}", self.external),
            (ONE, f"drag on {self.of.name}", self.drag),
        ]


class Derivation:
    """What follows from a statement, as expressions of the symbols below and of the statement.

    field: (ex, ey) gravity less the acceleration of the frame. gravity: (gravity.x, gravity.y).
    place, motion, push: position, velocity and acceleration of the frame. Shapes and their rates
    are those of the present time.
    """

    def __init__(self, mechanics: Mechanics) -> None:
        self.mechanics = mechanics
        self.q: list[Coordinate] = list(mechanics.coordinates)
        self.v: list[Symbol] = [c.rate for c in self.q]
        self.field = [Symbol("field.x", real=True), Symbol("field.y", real=True)]
        self.gravity = [Parameter("gravity.x"), Parameter("gravity.y")]
        self.place = [Symbol("frame.x", real=True), Symbol("frame.y", real=True)]
        self.motion = [Symbol("frame.vx", real=True), Symbol("frame.vy", real=True)]
        self.push = [Symbol("frame.ax", real=True), Symbol("frame.ay", real=True)]
        self.potential = sympy.sympify(mechanics.potential)
        #: abbreviations, in the order of their definition, which the expressions may contain
        self.shared: dict[Symbol, Expr] = {}
        #: the rows as they follow from the statement, and with abbreviations
        self.raw = [row for m in mechanics.masses for row in self._rows(m)]
        self.rows = self._abbreviated()
        #: generalised forces: couples (drag on coordinates apart), drag, and of the potential
        self.couples = [sympy.sympify(mechanics.couples.get(c, ZERO)) for c in self.q]
        self.resisting = [
            -sympy.Add(*(d.coefficient for d in mechanics.damping if d.of == c)) * v
            for c, v in zip(self.q, self.v, strict=True)
        ]
        self.restoring = [-self.potential.diff(c) for c in self.q]

    def _rows(self, m: Mass) -> list[Row]:
        moving = [(s, s.rate) for s in (*self.q, *self.mechanics.shapes)]
        rows = []
        added = self.mechanics.forces.get(m, (ZERO, ZERO))
        for axis, position in enumerate((m.x, m.y)):
            slopes = [position.diff(c) for c in self.q]
            left = sympy.Add(
                *(position.diff(a, b) * u * w for a, u in moving for b, w in moving),
                *(position.diff(s) * s.acceleration for s in self.mechanics.shapes),
            )
            along = self._frozen(slopes)
            drags = [d.coefficient for d in self.mechanics.damping if d.of == m]
            rows.append(
                Row(
                    m,
                    axis,
                    position,
                    slopes,
                    left,
                    self.field[axis],
                    m.force[axis] + sympy.sympify(added[axis]),
                    -sympy.Add(*drags) * along,
                )
            )
        return rows

    def _frozen(self, slopes: list[Expr]) -> Expr:
        """Velocity relative to the frame with the shapes held."""
        return sympy.Add(*(j * v for j, v in zip(slopes, self.v, strict=True)))

    def _abbreviated(self) -> list[Row]:
        """The rows with names for what several share: a mass hangs from another, or slides on."""
        rows = list(self.raw)
        for i, row in enumerate(rows):
            for k, slope in enumerate(row.slopes):
                if sympy.count_ops(slope) == 0 or slope in self.shared:
                    continue
                later = [r for r in rows[i + 1 :] if sympy.expand(r.slopes[k] - slope) == 0]
                if later or not slope.has(sympy.Function):
                    symbol = Symbol(f"{row.of.name}.slope_{'xy'[row.axis]}{k}", real=True)
                    self.shared[symbol] = slope
                    for n, r in enumerate(rows):
                        if n == i or r in later:
                            slopes = list(r.slopes)
                            slopes[k] = symbol
                            drag = r.drag.subs(slope, symbol) if r.drag != 0 else ZERO
                            rows[n] = r._replace(slopes=slopes, drag=drag)
        for i, row in enumerate(rows):
            for j in range(i):
                other = rows[j]
                if other.axis != row.axis or sympy.count_ops(other.left) < 2:
                    continue
                rest = sympy.expand(row.left) - sympy.expand(other.left)
                if sympy.count_ops(rest) + 1 < sympy.count_ops(row.left):
                    symbol = Symbol(f"{other.of.name}.left_{'xy'[row.axis]}", real=True)
                    self.shared[symbol] = other.left
                    rows[j] = other._replace(left=symbol)
                    rows[i] = row._replace(left=symbol + rest)
                    break
        return rows

    def along(self, expression: Expr, by: Symbol) -> Expr:
        """The derivative of an expression with abbreviations."""
        found = expression.diff(by)
        for symbol, e in self.shared.items():
            if expression.has(symbol):
                found += expression.diff(symbol) * self.along(e, by)
        return found

    # -- accelerations ---------------------------------------------------------------------------
    @cached_property
    def accelerations(self) -> tuple[list[Expr], Expr]:
        """Numerators of q'' and their common denominator."""
        return over([n.short() for n in self._numerators], self.determinant)

    @cached_property
    def determinant(self) -> Sum:
        """D."""
        found = Sum()
        if len(self.q) == 1:
            for row in self.rows:
                found.add(row.mass, "", row.slopes[0] ** 2)
        for a, b in combinations(self.rows, 2) if len(self.q) == 2 else ():
            found.add(a.mass * b.mass, "", self.minor(a, b) ** 2)
        return found.short()

    def minor(self, a: Row, b: Row) -> Expr:
        """C_ij of two rows, in their order."""
        key = (a.of.name, a.axis, b.of.name, b.axis)
        if key not in self._minors:
            found = a.slopes[0] * b.slopes[1] - b.slopes[0] * a.slopes[1]
            self._minors[key] = shorter(found)
        return self._minors[key]

    @cached_property
    def _minors(self) -> dict[tuple[str, int, str, int], Expr]:
        return {}

    @cached_property
    def generalised(self) -> list[Expr]:
        """Generalised forces on the coordinates themselves."""
        three = zip(self.couples, self.resisting, self.restoring, strict=True)
        return [sympy.Add(*x) for x in three]

    @property
    def _numerators(self) -> list[Sum]:
        found = [Sum() for _ in self.q]
        if len(self.q) == 1:
            for row in self.rows:
                for factor, what, force in row.forces:
                    found[0].add(factor, what, row.slopes[0] * force)
            found[0].add(ONE, "couples", self.generalised[0])
            return found
        for a, b in combinations(self.rows, 2):
            c = self.minor(a, b)
            if c == 0:
                continue
            # of both at once: shorter before it is multiplied
            for (of_a, what, fa), (of_b, other, fb) in zip(a.forces, b.forces, strict=True):
                for k, sign in ((1, 1), (0, -1)):
                    if what == other:
                        one = shorter(fa * b.slopes[k] - fb * a.slopes[k])
                        found[1 - k].add(of_a * b.mass, what, sign * c * one)
                    else:
                        found[1 - k].add(of_a * b.mass, what, sign * c * b.slopes[k] * fa)
                        found[1 - k].add(of_b * a.mass, other, -sign * c * a.slopes[k] * fb)
        for row in self.rows:
            j0, j1 = row.slopes
            for k, term in enumerate(
                (
                    self.generalised[0] * j1 * j1 - self.generalised[1] * j0 * j1,
                    self.generalised[1] * j0 * j0 - self.generalised[0] * j0 * j1,
                )
            ):
                found[k].add(row.mass, "couples", term)
        return found

    # -- what the masses are held by -------------------------------------------------------------
    @cached_property
    def reactions(self) -> Reactions:
        """The forces with which curves, rods, frame and shapes act on the masses."""
        return Reactions(self)

    @cached_property
    def constraint(self) -> Constrained | None:
        """The Cartesian form, where the statement has one."""
        stated = self.mechanics.constraint
        return None if stated is None else Constrained(self, stated)

    # -- motion and energies ---------------------------------------------------------------------
    def velocity(self, row: Row) -> Expr:
        """Velocity of a row relative to the frame."""
        return sympy.Add(
            self._frozen(row.slopes),
            *(row.position.diff(s) * s.rate for s in self.mechanics.shapes),
        )

    @cached_property
    def kinetic(self) -> Expr:
        """Kinetic energy in the world."""
        return sympy.Add(
            *(r.mass * (self.motion[r.axis] + self.velocity(r)) ** 2 / 2 for r in self.raw)
        )

    @cached_property
    def potential_terms(self) -> list[Expr]:
        """What adds up to the potential energy in the world."""
        found = [
            -r.mass * self.gravity[r.axis] * (self.place[r.axis] + r.position) for r in self.raw
        ]
        return [*found, self.potential]

    @cached_property
    def fed(self) -> list[Expr]:
        """Power of external forces and couples, of dampers, and of shapes in the potential."""
        external = [r.external * (self.motion[r.axis] + self.velocity(r)) for r in self.raw]
        external += [f * v for f, v in zip(self.couples, self.v, strict=True)]
        damping = [r.drag * self._frozen(r.slopes) for r in self.raw]
        damping += [f * v for f, v in zip(self.resisting, self.v, strict=True)]
        own = [self.potential.diff(s) * s.rate for s in self.mechanics.shapes]
        return [sympy.Add(*external), shorter(sympy.Add(*damping)), sympy.Add(*own)]

    @property
    def external_inputs(self) -> list[Symbol]:
        """Inputs that are forces or couples."""
        stated = [r.external for r in self.raw] + self.couples
        found = {s for e in stated for s in e.free_symbols if isinstance(s, Input)}
        return sorted(found, key=str)

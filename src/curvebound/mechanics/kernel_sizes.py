"""Sizes that a kernel module knows of its models: of coordinates, and of what errors grow to."""

from __future__ import annotations

from functools import cached_property
from itertools import combinations

import sympy
from sympy import Expr, Symbol

from .derivation import Row
from .kernel_writer import Writer
from .periodic import is_periodic
from .sums import shorter

__all__ = ["SEARCHED", "SizeParts"]

#: fields of the search for what magnifies: of a place, and of all places
SEARCHED = (
    *(f"{of}{i}" for of in ("inertia", "ahead", "narrow", "least", "most", "far", "bends")
      for i in "01"),
    *("apart", "pushed_by", "closest"),
)  # fmt: skip


class SizeParts(Writer):
    """Writes what `class Derived(FramedModel)` has for scales and tolerances."""

    @cached_property
    def turning(self) -> list[str]:
        """State fields of the angles whose whole turns change nothing."""
        return [f for c, f in self.coordinates if c.is_angle and self._periodic(c)]

    def turns_of(self, field: str) -> str:
        """The field that counts the whole turns of an angle's field."""
        return "turns1" if self.turning.index(field) else "turns"

    def _periodic(self, c: Symbol) -> bool:
        stated = [r.position for r in self.d.raw] + [r.external for r in self.d.raw]
        stated += [self.d.potential, *self.d.couples, *map(sympy.sympify, self.m.observed.values())]
        return all(is_periodic(e, c) for e in stated)

    def _scales(self) -> list[str]:
        lines = []
        for k, (c, f) in enumerate(self.coordinates):
            if c.is_angle:
                lines.append(f"        self.{f}_scale = 1.0")
                continue
            slope = sympy.Add(*(r.slopes[k] ** 2 for r in self.d.raw))
            bend = sympy.Add(*(r.slopes[k].diff(c) ** 2 for r in self.d.raw))
            others = [
                (g, sympy.Add(*(r.slopes[i].diff(c2) ** 2 for r in self.d.raw)))
                for i, (c2, g) in enumerate(self.coordinates)
                if i != k
            ]
            pairs = [("slope", slope), ("bend", bend)]
            pairs += [("reach", e) for _, e in others]
            lines += self.body(pairs)
            lines.append(f"        self.{f}_scale = 1.0")
            lines.append("        if bend > 0.0 and slope > 0.0:")
            lines.append(f"            self.{f}_scale = math.sqrt(slope / bend)")
            if others:
                lines.append("        elif reach > 0.0 and slope > 0.0:")
                lines.append(f"            self.{f}_scale = math.sqrt(reach / slope)")
        return lines

    # -- how errors grow -------------------------------------------------------------------------
    @cached_property
    def inertias(self) -> list[Expr]:
        """The diagonal of the mass matrix."""
        rows = self.d.raw
        return [sympy.Add(*(r.mass * r.slopes[k] ** 2 for r in rows)) for k in range(len(self.d.q))]

    @cached_property
    def rests(self) -> list[Expr]:
        """What is left of its determinant where both coordinates move a mass alike, by mass."""

        def term(a: Row, b: Row) -> Expr:
            minor = a.slopes[0] * b.slopes[1] - a.slopes[1] * b.slopes[0]
            return a.mass * b.mass * sympy.factor_terms(minor) ** 2

        if len(self.d.q) == 1:
            return []
        terms = [(a.of, b.of, term(a, b)) for a, b in combinations(self.d.raw, 2)]
        found = []
        for mass in self.m.masses:
            alone = [e for a, b, e in terms if a == b == mass and e != 0]
            rest = shorter(sympy.Add(*(e for a, b, e in terms if not a == b == mass)))
            if alone and rest != 0:
                found.append(rest)
        return found

    @cached_property
    def magnified(self) -> bool:
        """Whether errors can grow by what the masses do."""
        moving = set(self.d.q)
        return bool(self.rests) or any(e.free_symbols & moving for e in self.inertias)

    def _magnifies(self) -> list[str]:
        if not self.magnified:
            return []
        own = [self.names[s] for s in self.d.q]
        arguments = ", ".join(f"{n}: float" for n in own)
        lines = ["", f"    def inertias(self, {arguments}) -> None:"]
        lines += ['        """Set what magnifies() looks at, for a place."""']
        pairs = [(f"self.inertia{k}", e) for k, e in enumerate(self.inertias)]
        for k, f in enumerate(self.lengths):
            slopes = [(r.mass, r.slopes[f], r.slopes[f].diff(self.d.q[f])) for r in self.d.raw]
            pairs.append((f"turned{k}", sympy.Add(*(m * j * b for m, j, b in slopes))))
            pairs.append((f"bend{k}", sympy.Add(*(m * b * b for m, _, b in slopes))))
        pairs += [(f"rest{i}", e) for i, e in enumerate(self.rests)]
        still = dict.fromkeys(self.d.v, 0)
        pushes = [r.external.subs(still) - r.mass * self.d.push[r.axis] for r in self.d.raw]
        work = zip(pushes, self.d.raw, strict=True)
        pairs.append(("self.pushed_by", sympy.Add(*(f * r.position for f, r in work))))
        lines += self.body(pairs, self.d.q)
        for k, f in enumerate(self.lengths):
            lines += [f"        self.ahead{f} = self.narrow{f} = 0.0", f"        if bend{k} > 0.0:"]
            lines += [f"            self.ahead{f} = -turned{k} / bend{k}"]
            lines += [f"            self.narrow{f} = bend{k} / self.inertia{f}"]
        lines.append("        self.apart = 1.0")
        for i in range(len(self.rests)):
            lines += [
                f"        if rest{i} < self.apart * self.inertia0 * self.inertia1:",
                f"            self.apart = rest{i} / (self.inertia0 * self.inertia1)",
            ]
        return [*lines, *self._look(), *self._looks_around()]

    @property
    def lengths(self) -> list[int]:
        """The coordinates that are no angles."""
        return [i for i, (c, _) in enumerate(self.coordinates) if not c.is_angle]

    def _look(self) -> list[str]:
        count = len(self.coordinates)
        places = "".join(f", x{i}: float" for i in range(count))
        lines = ["", f"    def look(self, energy: float{places}) -> None:"]
        lines += ['        """Let a place count, where the energy reaches it."""']
        lines += [f"        self.q{i} = x{i}" for i in range(count)]
        lines += ["        try:", "            self.energies_at(0.0)"]
        lines += [f"            self.inertias({', '.join(f'x{i}' for i in range(count))})"]
        lines += ["        except (ArithmeticError, ValueError):  # outside of its domain"]
        lines += ["            self.potential = math.inf"]
        lines += ["        if self.potential - self.pushed_by <= energy:"]
        for i in range(count):
            lines += [f"            self.least{i} = min(self.least{i}, self.inertia{i})"]
            lines += [f"            self.most{i} = max(self.most{i}, self.inertia{i})"]
            if i in self.lengths:
                lines += [f"            bends = min(x{i} * x{i}, self.far{i}) * self.narrow{i}"]
                lines += [f"            self.bends{i} = max(self.bends{i}, bends)"]
        return [*lines, "            self.closest = min(self.closest, self.apart)"]

    def _looks_around(self) -> list[str]:
        """magnifies(): largest and least inertias where energy and inputs of the start reach."""
        count = len(self.coordinates)
        where = ", ".join(f"x{i}" for i in range(count))
        lines = ["", "    def magnifies(self) -> float:"]
        lines += ['        """By how much an error made now can count when inertia has changed."""']
        lines += ["        energy = self.kinetic + self.potential"]
        lines += ["        energy += 1e-9 * (self.kinetic + self.potential_size)"]
        lines += [f"        start{i} = self.q{i}" for i in range(count)]
        lines += [f"        self.inertias({', '.join(f'start{i}' for i in range(count))})"]
        lines += [f"        self.least{i} = self.most{i} = self.inertia{i}" for i in range(count)]
        for i in self.lengths:  # squares of their sizes
            lines += [f"        far = max(math.fabs(start{i}), self.q{i}_scale)"]
            lines += [f"        self.far{i} = far * far", f"        self.bends{i} = 0.0"]
        lines += ["        self.closest = self.apart", "        energy -= self.pushed_by"]
        deep = " " * 8
        steps: list[str] = []
        for i, (c, _) in enumerate(self.coordinates):
            step = [f"x{i} += TURN / 12.0"]
            if c.is_angle:
                middle = f"TURN * nearest_whole(start{i} / TURN)"
                lines += [f"{deep}x{i} = {middle} - 0.5 * TURN", f"{deep}last{i} = x{i} + TURN"]
                lines += [f"{deep}while x{i} < last{i} + 0.1:"]
            else:
                # outward to either side, each time four times as far; of two coordinates one
                # passes zero beside the other
                near = f"near{i}"
                first = "0.0" if count == 1 else near
                lines += [f"{deep}{near} = math.sqrt(self.far{i}) / 4096.0"]
                lines += [f"{deep}x{i} = {first}"]
                lines += [f"{deep}while x{i} < 5e6 * {near}:"]
                step = [f"if x{i} > 0.0:", f"    x{i} = -x{i}"]
                if count == 1:
                    step += [f"elif x{i} == 0.0:", f"    x{i} = {near}"]
                step += ["else:", f"    x{i} = -4.0 * x{i}"]
            deep += "    "
            steps = [deep + line for line in step] + steps
        lines.append(f"{deep}self.look(energy, {where})")
        for i in self.lengths:  # on to the least inertia nearby, by the method of Gauss and Newton
            there = where.replace(f"x{i}", f"self.q{i} + self.ahead{i}")
            lines += [f"{deep}for _ in range(3):", f"{deep}    self.look(energy, {there})"]
        lines += [*steps, *(f"        self.q{i} = start{i}" for i in range(count))]
        lines += ["        self.energies_at(0.0)"]
        lines += ["        magnified = 1.0 / max(self.closest, 1e-16)"]
        for i, (c, f) in enumerate(self.coordinates):
            if not c.is_angle:  # it rounds at its size, which may be that of many bends
                lines += [f"        magnified *= max(1.0, math.sqrt(self.bends{i}))"]
            elif f not in self.turning:  # at the size of all its turns
                lines += [f"        magnified *= max(1.0, math.fabs(start{i}))"]
            lines += [f"        if self.least{i} < self.most{i}:"]
            lines += [f"            least = max(self.least{i}, 1e-32 * self.most{i})"]
            lines += [f"            magnified *= math.sqrt(self.most{i} / least)"]
        return [*lines, "        return min(magnified, 1e16)"]

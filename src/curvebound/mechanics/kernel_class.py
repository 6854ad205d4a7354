"""The class of a kernel module that has the whole equations; others derive from it."""

from __future__ import annotations

from sympy import Expr, Symbol

from .kernel_parts import ModelParts
from .kernel_writer import ACCELERATIONS, INVERSE, symbols_in
from .sums import ZERO

__all__ = ["DerivedClass", "potential_sums"]


class DerivedClass(ModelParts):
    """Writes `class Derived(FramedModel)` for a derivation."""

    name = "Derived"

    def lines(self) -> list[str]:
        """The class."""
        methods = [
            self._start(),
            self._take_inputs(),
            self._acceleration(),
            self._power(),
            self._jacobian(),
            self._energies(),
            self._motion(),
            self._saved(),
            self.outputs.lines(),
            self._words(),
        ]
        # what is written first declares and computes the constants that the others have found
        rates = self.uses_rates(*self.d.accelerations)
        first = [*self._head(), *self._refresh(), f"        self.uses_rates = {rates}"]
        first += ["        self.refresh_values()"]
        first += self._refresh_values('"""What is constant while frame and inputs are."""')
        return [*first, *(line for method in methods for line in method)]

    # -- equations -------------------------------------------------------------------------------
    def _acceleration(self) -> list[str]:
        d = self.d
        numerators, denominator = d.accelerations
        signature = f"    def acceleration(self, {self.arguments()}) -> None:"
        lines = ["", signature]
        constants = [*self._constant_symbols(), *self.shapes]
        variants = [
            ("self.plain and self.ex == 0.0", {**self.off, d.field[0]: ZERO}),
            ("self.plain", self.off),
        ]
        if self.m.damping:
            damped = {s: x for s, x in self.off.items() if s not in self.resisting}
            variants.append(("not (self.pushed or self.reshapes)", damped))
        for condition, off in variants if not self.always_pushed else ():
            lines.append(f"        if {condition}:")
            pairs = self._solution([n.subs(off) for n in numerators], denominator)
            lines += self.body(pairs, [*self.state, INVERSE], indent=" " * 12, hoist=constants)
            lines.append("            return")
        pairs = self._solution(numerators, denominator)
        known = [*self.state, INVERSE]
        lines += self.body(pairs, known, hoist=self._constant_symbols(), moving=True)
        return lines

    def uses_rates(self, numerators: list[Expr], denominator: Expr) -> str:
        """An expression: whether acceleration(), by these equations, reads rates."""

        def read(off: dict[Symbol, Expr]) -> bool:
            solved = [*(n.subs(off) for n in numerators), denominator]
            return not symbols_in(solved, self.d.shared).isdisjoint(self.d.v)

        if not read({}):
            return "False"
        return "True" if read(self.off) else "not self.plain"

    def _constant_symbols(self) -> list[Symbol]:
        return [*self.fields, *self.d.field]

    @staticmethod
    def _solution(numerators: list[Expr], denominator: Expr) -> list[tuple[str, Expr]]:
        if not denominator.is_Add:  # a product: nothing to share
            return [(f"self.a{i}", n / denominator) for i, n in enumerate(numerators)]
        solved = [(f"self.a{i}", n * INVERSE) for i, n in enumerate(numerators)]
        return [("inverse", 1 / denominator), *solved]

    def _jacobian(self) -> list[str]:
        d = self.d
        numerators, denominator = d.accelerations
        a = ACCELERATIONS[: len(numerators)]
        lines = ["", f"    def jacobian(self, {self.arguments()}) -> None:"]
        pairs = [("inverse", 1 / denominator)]
        pairs += [(s.name, n * INVERSE) for s, n in zip(a, numerators, strict=True)]
        first = self.body(pairs, [*self.state, INVERSE], moving=True)
        lines += first
        lines += [f"        self.{s.name} = {s.name}" for s in a]
        slopes = []
        for i, n in enumerate(numerators):
            for s, field in (*self.coordinates, *self.rates):
                e = d.along(n, s) - a[i] * d.along(denominator, s)
                if e != 0:
                    slopes.append((f"self.a{i}_{field}", e * INVERSE))
        rest = self.body(slopes, [*self.state, INVERSE, *a], moving=True)
        return lines + [line for line in rest if line not in first or " = self." not in line]

    def _power(self) -> list[str]:
        arguments = f"{self.arguments()}, a0: float, a1: float"
        lines = ["", f"    def power(self, {arguments}) -> float:", "        power = 0.0"]
        deep = " " * 12
        rates = [("hold_x", "(self.vx + t * self.ax)"), ("hold_y", "(self.vy + t * self.ay)")]
        held = list(zip(rates, self.d.reactions.held, strict=False)) if self.m.frame else []
        for x, force in zip(self.shapes, self.d.reactions.held[2:], strict=True):
            own = self.d.potential.diff(x)
            a = self.names[x]
            rate = f"(self.{a}_rate + t * self.{a}_acceleration)"
            held.append(((f"hold_{a}", rate), force + own))
        if held:
            lines.append("        if self.moving or self.reshapes:")
            pairs = [(name, e) for (name, _), e in held]
            lines += self.body(pairs, self.state, indent=deep, moving=True)
            total = " + ".join(f"{name} * {rate}" for (name, rate), _ in held)
            lines.append(f"{deep}power = {total}")
        for flag, fed in zip(("pushed", "damped"), self.d.fed, strict=False):
            if fed != 0:
                lines.append(f"        if self.{flag}:")
                lines += self.body([("fed", fed)], self.state, indent=deep, moving=True)
                lines.append(f"{deep}power += fed")
        return [*lines, "        return power"]

    def _energies(self) -> list[str]:
        lines = ["", "    def energies_at(self, t: float) -> None:"]
        terms = [e for e in self.d.potential_terms if e != 0]
        pairs = [("self.kinetic", self.d.kinetic)]
        pairs += [(f"part{i}", e) for i, e in enumerate(terms)]
        lines += self.body(pairs, moving=True)
        return lines + potential_sums(len(terms))


def potential_sums(count: int) -> list[str]:
    """Lines that sum up the parts of the potential energy."""
    parts = [f"part{i}" for i in range(count)]
    sizes = [f"math.fabs({p})" for p in parts]
    return [
        f"        self.potential = {' + '.join(parts) or '0.0'}",
        f"        self.potential_size = {' + '.join(sizes) or '0.0'}",
    ]

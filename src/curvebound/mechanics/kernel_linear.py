"""The class of a kernel module for small motion: the quadratic part of the Lagrangian."""

from __future__ import annotations

import sympy
from sympy import Expr, Symbol

from .derivation import Derivation
from .kernel_class import DerivedClass, potential_sums
from .kernel_parts import SETTINGS, any_of
from .kernel_writer import ACCELERATIONS
from .linear import Linear
from .names import Names
from .sums import ZERO

__all__ = ["LinearClass"]


class LinearClass(DerivedClass):
    """Writes `class Linear(Derived)`."""

    name = "Linear"
    prefix = "c"

    def __init__(self, derivation: Derivation, names: Names) -> None:
        super().__init__(derivation, names)
        self.linear = Linear(derivation)

    def lines(self) -> list[str]:
        methods = [
            self._acceleration(),
            self._jacobian(),
            self._system(),
            self._power(),
            self._power_form(),
            self._energies(),
            self._unwound(),
            self._forces(),
            self._compare(),
        ]
        head = [
            "class Linear(Derived):",
            f'    """{self._meaning()[:-1]}; small about rest."""',
            "",
        ]
        head += ["    def __init__(self) -> None:", "        super().__init__()"]
        head += ["        self.is_linear = True"]
        head += [f"        self.{s.name}: float = 0.0" for s in self.constants.values()]
        head += ["", "    def refresh(self) -> None:", "        super().refresh()"]
        moved = any_of(("self.ax", "self.ay"))
        head.append(f"        self.works = not self.plain or {moved}")
        head.append(f"        self.uses_rates = {self.uses_rates(*self.linear.accelerations)}")
        head += self._refresh_values("super().refresh_values()")
        return [*head, *(line for method in methods for line in method)]

    def _unwound(self) -> list[str]:
        """The angle is no angle to this model: turns stay in it; its inertia is constant."""
        constant = ["", "    def magnifies(self) -> float:", "        return 1.0"]
        return [
            *(constant if self.magnified else []),
            "",
            f"    def place(self, {SETTINGS}) -> None:",
            "        self.scale()",
            "",
            "    def settle(self, h: float) -> None:",
            '        """Nothing: turns stay in the angle."""',
            "",
            "    def advance_frame(self, duration: float) -> None:",
            "        if self.moving or self.reshapes:",
            "            self.move_frame(duration)",
            "            self.refresh()",
        ]

    def _acceleration(self) -> list[str]:
        numerators, denominator = self.linear.accelerations
        lines = ["", f"    def acceleration(self, {self.arguments()}) -> None:"]
        lines.append("        if self.plain:")
        pairs = self._solution([n.subs(self.off) for n in numerators], denominator)
        constants = [*self._constant_symbols(), *self.shapes]
        lines += self.body(pairs, self.state, indent=" " * 12, hoist=constants)
        lines.append("            return")
        pairs = self._solution(numerators, denominator)
        return lines + self.body(pairs, self.state, hoist=self._constant_symbols(), moving=True)

    def _jacobian(self) -> list[str]:
        numerators, denominator = self.linear.accelerations
        lines = ["", f"    def jacobian(self, {self.arguments()}) -> None:"]
        pairs = [(f"self.a{i}", n / denominator) for i, n in enumerate(numerators)]
        pairs += [
            (f"self.a{i}_{field}", n.diff(s) / denominator)
            for i, n in enumerate(numerators)
            for s, field in (*self.coordinates, *self.rates)
            if n.diff(s) != 0
        ]
        return lines + self.body(pairs, self.state, moving=True)

    def _system(self) -> list[str]:
        rows = [
            ", ".join(f"self.a{i}_{f}" for f in ("q0", "q1", "v0", "v1")) + f", self.a{i}"
            for i in (0, 1)
        ]
        return [
            "",
            "    def linear_system(self) -> list[list[float]]:",
            "        self.jacobian(0.0, 0.0, 0.0, 0.0, 0.0)",
            "        return [",
            "            [0.0, 0.0, 1.0, 0.0, 0.0],",
            "            [0.0, 0.0, 0.0, 1.0, 0.0],",
            f"            [{rows[0]}],",
            f"            [{rows[1]}],",
            "            [0.0, 0.0, 0.0, 0.0, 0.0],",
            "        ]",
        ]

    def _power(self) -> list[str]:
        arguments = f"{self.arguments()}, a0: float, a1: float"
        lines = ["", f"    def power(self, {arguments}) -> float:"]
        return lines + self.body([("return", self.linear.power)], self.state, moving=True)

    def _power_form(self) -> list[str]:
        still = {s.rate: ZERO for s in self.shapes}
        power = self.linear.power.subs(still)
        fields = dict(self.coordinates + self.rates)
        symbols: list[Symbol | None] = [None] * 5
        for s, field in fields.items():
            symbols[("q0", "q1", "v0", "v1").index(field)] = s
        zero = dict.fromkeys(fields, ZERO)

        def entry(i: int, k: int) -> Expr:
            a, b = symbols[i], symbols[k]
            if i == 4 and k == 4:
                return power.subs(zero)
            if (a is None and i != 4) or (b is None and k != 4):
                return ZERO
            found = power
            for s in (a, b):
                if s is not None:
                    found = found.diff(s)
            return found.subs(zero) / 2

        pairs = [
            (f"c{i}{k}", entry(i, k)) for i in range(5) for k in range(i, 5) if entry(i, k) != 0
        ]
        known = {name for name, _ in pairs}
        lines = ["", "    def power_form(self) -> list[list[float]]:", *self.body(pairs)]
        lines.append("        return [")
        for i in range(5):
            names = (f"c{min(i, k)}{max(i, k)}" for k in range(5))
            lines.append(f"            [{', '.join(n if n in known else '0.0' for n in names)}],")
        return [*lines, "        ]"]

    def _energies(self) -> list[str]:
        terms = self.linear.potential_terms
        pairs = [("self.kinetic", self.linear.kinetic)]
        pairs += [(f"part{i}", e) for i, e in enumerate(terms)]
        lines = ["", "    def energies_at(self, t: float) -> None:"]
        lines += self.body(pairs, moving=True) + potential_sums(len(terms))
        # linear equations have one solution, and not all of their energy is the whole one's
        lines += ["", "    def balance(self, t: float) -> None:"]
        return [*lines, "        self.balance_energy = 0.0", "        self.balance_size = 1.0"]

    def _call(self, of: str) -> str:
        own = ", ".join(f"self.{f}" for f in ("q0", "q1", "v0", "v1"))
        return f"        {of}.acceleration(0.0, {own})"

    def _forces(self) -> list[str]:
        """Newton's law of the masses in exact geometry, with the linear accelerations."""
        if not self.outputs.forces:
            return []
        d = self.d
        forces = {}
        for r in d.raw:
            moved = sympy.Add(*(j * a for j, a in zip(r.slopes, ACCELERATIONS, strict=False)))
            forces[r.of.reaction[r.axis]] = r.mass * (moved + r.left - r.field) - r.external
        at = self.outputs.at
        pairs = []
        if self.m.frame:
            for axis, n in enumerate("xy"):
                total = sympy.Add(*(forces[m.reaction[axis]] for m in self.m.masses))
                pairs.append((at[f"{self.m.frame}.f{n}"], -total))
        for name, e in self.m.observed.items():
            pairs.append((at[name], sympy.sympify(e).subs(forces)))
        lines = ["", "    def write_forces(self, values: Values, first: int) -> None:"]
        lines += [self._call("self"), "        a0 = self.a0", "        a1 = self.a1"]
        return lines + self.body(pairs, ACCELERATIONS)

    def _compare(self) -> list[str]:
        weights = [*self.linear.weights, ZERO][:2]
        lines = ["", "    def compare(self) -> None:"]
        lines += self.body([("w0", weights[0]), ("w1", weights[1])])
        for of, name in (("self", "linear"), ("super()", "full")):
            lines.append(self._call(of))
            lines += [f"        self.{name}{i} = w{i} * self.a{i}" for i in (0, 1)]
        return lines

"""The outputs of a kernel module's models: in which group each is, and what computes them."""

from __future__ import annotations

from functools import cached_property

import sympy
from sympy import Expr

from .kernel_sizes import SizeParts
from .sums import ZERO

__all__ = ["FORCES", "PLACES", "VELOCITIES", "Outputs"]

#: outputs of one group are computed together
PLACES, VELOCITIES, FRAME, ENERGIES, FORCES, LINEAR = range(6)


class Outputs:
    """Of the models that `writer` writes; at: where each goes, by name."""

    def __init__(self, writer: SizeParts) -> None:
        self.writer = writer
        self.d, self.m = writer.d, writer.m
        self.at = {n: f"values[first + {i}]" for i, n in enumerate(self.m.outputs)}

    @cached_property
    def forces(self) -> dict[str, Expr]:
        """Those that are forces."""
        found: dict[str, Expr] = {}
        reactions = self.d.reactions
        if self.m.frame:
            found = {f"{self.m.frame}.f{a}": -reactions.held[i] for i, a in enumerate("xy")}
        if self.d.constraint is not None:
            found["constraint.multiplier"] = self.d.constraint.multiplier
            found["constraint.force"] = self.d.constraint.force
            found["constraint.drift"] = ZERO
        for name, e in self.m.observed.items():
            found[name] = reactions.observed(sympy.sympify(e))
        return found

    @property
    def groups(self) -> dict[str, int]:
        """The group of each."""
        return {name: self._group(name) for name in self.m.outputs}

    @property
    def feedthrough(self) -> list[int]:
        """The groups that depend on inputs of the same instant."""
        found = [FORCES] if self.forces else []
        return found + ([LINEAR] if self.m.linear_about is not None else [])

    def _group(self, name: str) -> int:
        if name.startswith("energy."):
            return ENERGIES
        if name in self.forces:
            return FORCES
        if name == "model.acceleration_error":
            return LINEAR
        own = [n for x in self.m.shapes for n in (x.name, x.rate.name)]
        if name in own or (self.m.frame and name.rpartition(".")[0] == self.m.frame):
            return FRAME
        masses = {f"{x.name}.v{a}" for x in self.m.masses for a in "xy"}
        return VELOCITIES if name in masses else PLACES

    def lines(self) -> list[str]:
        """The methods that compute them."""
        at, d, writer = self.at, self.d, self.writer
        places: list[tuple[str, Expr]] = []
        velocities: list[tuple[str, Expr]] = []
        for r in d.raw:
            axis = "xy"[r.axis]
            places.append((at[f"{r.of.name}.{axis}"], d.place[r.axis] + r.position))
            velocities.append((at[f"{r.of.name}.v{axis}"], d.motion[r.axis] + d.velocity(r)))
        lines = ["", "    def observe(self, group: int, values: Values, first: int) -> None:"]
        deep = " " * 12
        lines.append(f"        if group == {PLACES}:")
        for (c, f), (v, g) in zip(writer.coordinates, writer.rates, strict=True):
            value = f"self.{f}"
            if f in writer.turning:
                value = f"unwind(self.{f}, self.{writer.turns_of(f)})"
            lines += [f"{deep}{at[c.name]} = {value}", f"{deep}{at[v.name]} = self.{g}"]
        lines += writer.body(places, indent=deep)
        lines.append(f"        elif group == {VELOCITIES}:")
        lines += writer.body(velocities, indent=deep)
        own = [(f"{self.m.frame}.{n}", n) for n in ("x", "y", "vx", "vy")] if self.m.frame else []
        own += [(s.name, writer.names[s]) for x in self.m.shapes for s in (x, x.rate)]
        if own:
            lines.append(f"        elif group == {FRAME}:")
            lines += [f"{deep}{at[name]} = self.{field}" for name, field in own]
        lines.append(f"        elif group == {ENERGIES}:")
        start = self.m.outputs.index("energy.kinetic")
        lines.append(f"{deep}self.write_energies(values, first + {start})")
        if self.forces:
            lines.append(f"        elif group == {FORCES}:")
            lines.append(f"{deep}self.write_forces(values, first)")
        if self.m.linear_about is not None:
            lines += ["        else:"]
            lines.append(f"{deep}{at['model.acceleration_error']} = self.acceleration_error()")
        if self.forces:
            lines += ["", "    def write_forces(self, values: Values, first: int) -> None:"]
            lines.append(f'        """Write the outputs of group {FORCES}."""')
            lines += writer.body([(at[n], e) for n, e in self.forces.items()])
        return lines

"""What the models of a kernel module have beside their equations: fields, inputs, motion, words."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from functools import cached_property

import sympy
from sympy import Symbol

from .derivation import Derivation
from .elements import Input
from .kernel_outputs import Outputs
from .kernel_sizes import SEARCHED, SizeParts
from .names import Names
from .source import Printer
from .sums import ZERO

__all__ = ["SETTINGS", "ModelParts", "any_of"]

SETTINGS = "parameters: dict[str, float], choices: dict[str, int]"


class ModelParts(SizeParts):
    """Writes all of `class Derived(FramedModel)` but its equations."""

    def __init__(self, derivation: Derivation, names: Names) -> None:
        super().__init__(derivation, names)
        self.outputs = Outputs(self)
        moving = {s for x in self.shapes for s in (x, x.rate, x.acceleration)}
        #: symbols that are fields, constant over a communication step
        self.fields = [s for s in self._symbols if s not in self.state and s not in moving]
        #: what is zero without forces, damping and change of shape
        self.off = {
            **dict.fromkeys((*self.d.external_inputs, *self.resisting), ZERO),
            **{s.rate: ZERO for s in self.shapes},
            **{s.acceleration: ZERO for s in self.shapes},
        }

    @cached_property
    def _symbols(self) -> list[Symbol]:
        d = self.d
        numerators, denominator = d.accelerations
        stated = [*numerators, denominator, *d.shared.values(), d.kinetic, *d.potential_terms]
        stated += [*d.fed, *self.outputs.forces.values()]
        stated += [r.external for r in d.raw] + [r.drag for r in d.raw] + d.couples
        known = {*d.place, *d.motion, *d.shared, *d.field}
        if d.constraint is not None:
            c = d.constraint
            stated += [c.equation, c.coordinate, c.distance]
            known |= {*c.p}
        used = {s for e in stated for s in sympy.sympify(e).free_symbols} - known
        return sorted(used, key=str)

    @cached_property
    def resisting(self) -> list[Symbol]:
        """Coefficients of the dampers."""
        return [x.coefficient for x in self.m.damping]

    @cached_property
    def always_pushed(self) -> bool:
        """Whether there are forces or couples without any input."""
        still = dict.fromkeys(self.d.external_inputs, ZERO)
        return any(e.subs(still) != 0 for e in [r.external for r in self.d.raw] + self.d.couples)

    def arguments(self) -> str:
        """Arguments of acceleration(): time, coordinates, rates."""
        own = [self.names[s] for s in self.d.q] + ["_q1"] * (2 - len(self.d.q))
        own += [self.names[s] for s in self.d.v] + ["_v1"] * (2 - len(self.d.v))
        return ", ".join(f"{n}: float" for n in ["t", *own])

    def _head(self) -> list[str]:
        m = self.m
        choices = ["model.formulation", "constraint.stabilization"] if m.constraint else []
        choices += ["model.fidelity"] if m.linear_about is not None else []
        lines = ["class Derived(FramedModel):", f'    """{self._meaning()}"""', ""]
        lines += _tuple("PARAMETERS", m.parameters) + _tuple("CHOICES", choices)
        lines += _tuple("INPUTS", m.inputs)
        lines.append("    OUTPUTS: ClassVar[dict[str, int]] = {")
        lines += [f'        "{n}": {group},' for n, group in self.outputs.groups.items()]
        lines.append("    }")
        numbers = "".join(f"{g}, " for g in self.outputs.feedthrough).strip()
        lines.append(f"    FEEDTHROUGH: ClassVar[tuple[int, ...]] = ({numbers})")
        lines += [] if m.is_affine else ["    AFFINE: ClassVar[bool] = False"]
        lines += ["", "    def __init__(self) -> None:", "        super().__init__()"]
        for s in self.fields:
            if s not in self.d.gravity:
                lines.append(f"        self.{self.names[s]}: float = 0.0")
        for x in self.shapes:
            for s in (x, x.rate, x.acceleration):
                lines.append(f"        self.{self.names[s]}: float = 0.0")
            lines.append(f"        self.{self.names[x]}_jerk: float = 0.0")
            lines.append(f"        self.kept_{self.names[x]}: float = 0.0")
            lines.append(f"        self.kept_{self.names[x.rate]}: float = 0.0")
        lines += ["        # gravity less the acceleration of the frame"]
        lines += ["        self.ex: float = 0.0", "        self.ey: float = 0.0"]
        lines += [
            "        #: whether there is any force, or damping",
            "        self.pushed: bool = False",
            "        self.damped: bool = False",
        ]
        lines += ["        #: whether a shape moves", "        self.reshapes: bool = False"]
        lines += ["        #: neither", "        self.plain: bool = True"]
        if self.magnified:
            lines += ["        # of the search for what magnifies errors"]
            lines += [f"        self.{f}: float = 0.0" for f in SEARCHED]
            lines += ["        # 1 until the first inputs after the start have been seen"]
            lines += ["        self.fresh: float = 0.0"]
            lines += [f"        self.kept_{f}: float = 0.0" for f in ("magnification", "fresh")]
        if len(self.turning) > 1:
            lines += ["        self.turns1: float = 0.0", "        self.kept_turns1: float = 0.0"]
        lines += [f"        self.{s.name}: float = 0.0" for s in self.constants.values()]
        return lines

    def _meaning(self) -> str:
        found = [f"{f} = {c.name}" for c, f in self.coordinates]
        return ", ".join(found) + "."

    def _start(self) -> list[str]:
        lines = [
            "",
            "    def start(self, parameters: dict[str, float], choices: dict[str, int]) -> None:",
        ]
        lines.append("        self.rest_frame(parameters)")
        shape_symbols = {s for x in self.shapes for s in (x, x.rate)}
        for s in self.fields:
            if s in self.d.gravity or s in shape_symbols:
                continue
            value = "0.0" if isinstance(s, Input) else f'parameters["{s.name}"]'
            lines.append(f"        self.{self.names[s]} = {value}")
        for x in self.shapes:
            lines.append(f'        self.{self.names[x]} = parameters["{x.name}_start"]')
            lines.append(f'        self.{self.names[x.rate]} = parameters["{x.rate.name}_start"]')
            a = self.names[x]
            lines.append(f"        self.{self.names[x.acceleration]} = self.{a}_jerk = 0.0")
        lines += ["        self.ex = self.gx", "        self.ey = self.gy"]
        for (c, f), (v, g) in zip(self.coordinates, self.rates, strict=True):
            lines.append(f'        self.{f} = parameters["{c.name}_start"]')
            lines.append(f'        self.{g} = parameters["{v.name}_start"]')
        lines += ["        self.turns = 0.0", "        self.settles = False"]
        lines += ["        self.place(parameters, choices)"]
        lines += ["        self.note_initial_energy()", "        self.refresh()"]
        lines += ["        self.fresh = 1.0"] if self.magnified else []
        lines += [
            "",
            "    def place(self, parameters: dict[str, float], choices: dict[str, int]) -> None:",
        ]
        lines += ['        """Bring the initial state into the form that is integrated."""']
        for f in self.turning:
            turns = self.turns_of(f)
            lines.append(f"        self.{f}, self.{turns} = reduce_angle(self.{f})")
            lines.append(f"        self.settles = self.settles or self.{turns} != 0.0")
        lines += ["        self.scale()", "", "    def scale(self) -> None:"]
        lines += ['        """Natural sizes: how far until the slope of a position has turned."""']
        return [*lines, *self._scales(), *self._magnifies()]

    def _take_inputs(self) -> list[str]:
        lines = ["", "    def take_inputs(self, t: float) -> None:"]
        of = {s.name: s for s in self.fields}
        of |= {x.acceleration.name: x.acceleration for x in self.shapes}
        for i, name in enumerate(self.m.inputs):
            now = f"self.inputs[{i}] + t * self.slopes[{i}]"
            if self.m.frame and name in (f"{self.m.frame}.ax", f"{self.m.frame}.ay"):
                lines.append(f"        self.{name[-2:]} = {now}")
                lines.append(f"        self.j{name[-1]} = self.slopes[{i}]")
            elif name in of:
                lines.append(f"        self.{self.names[of[name]]} = {now}")
            lines += [
                f"        self.{self.names[x]}_jerk = self.slopes[{i}]"
                for x in self.shapes
                if x.acceleration.name == name
            ]
        lines += ["        self.ex = self.gx - self.ax", "        self.ey = self.gy - self.ay"]
        if self.magnified:
            lines += ["", "    def hold_inputs(self) -> None:"]
            lines += ["        super().hold_inputs()"]
            lines += ["        if self.fresh != 0.0:", "            self.fresh = 0.0"]
            lines += ["            self.magnification = self.magnifies()"]
        return lines

    def _refresh(self) -> list[str]:
        lines = ["", "    def refresh(self) -> None:"]
        if self.m.frame:
            fields = ("self.ax", "self.ay", "self.vx", "self.vy")
            lines.append(f"        self.moving = {any_of(fields)}")
        if self.shapes:
            own = [self.names[s] for x in self.shapes for s in (x.rate, x.acceleration)]
            lines.append(f"        self.reshapes = {any_of(f'self.{n}' for n in own)}")
            lines.append("        self.is_constant = not self.reshapes")
        if self.always_pushed:
            lines.append("        self.pushed = True")
        elif self.d.external_inputs:
            own = [self.names[s] for s in self.d.external_inputs]
            lines.append(f"        self.pushed = {any_of(f'self.{n}' for n in own)}")
        if self.resisting:
            own = [self.names[s] for s in self.resisting]
            lines.append(f"        self.damped = {any_of(f'self.{n}' for n in own)}")
        lines.append("        self.plain = not (self.pushed or self.damped or self.reshapes)")
        lines.append("        self.works = self.moving or not self.plain")
        return lines

    def _refresh_values(self, first: str) -> list[str]:
        """Lines that compute what is constant between two moves of frame and inputs."""
        lines = ["", "    def refresh_values(self) -> None:", f"        {first}"]
        known = {s for e in self.constants for s in e.free_symbols}
        lines += [f"        {self.local(s)} = self.{self.field(s)}" for s in sorted(known, key=str)]
        printer = Printer({s: self.local(s) for s in known})
        for e, s in self.constants.items():
            lines.append(f"        self.{s.name} = {printer(e)}")
        return lines

    # -- motion of frame, shapes and angles ------------------------------------------------------
    def _motion(self) -> list[str]:
        lines: list[str] = []
        if self.turning:
            lines += ["", "    def settle(self, h: float) -> None:", *self._reduced("")]
        lines += ["", "    def advance_frame(self, duration: float) -> None:"]
        lines += self._reduced("self.settles = True")
        lines += ["        if self.moving or self.reshapes:"]
        lines += ["            self.move_frame(duration)", "            self.refresh()"]
        if not self.shapes:
            return lines
        lines += ["", "    def move_frame(self, t: float) -> None:"]
        lines += ["        super().move_frame(t)", "        if self.reshapes:"]
        lines += ["            half = 0.5 * t"]
        for x in self.shapes:
            a = self.names[x]
            bend = f"half * self.{a}_acceleration - THIRD * t * t * self.{a}_jerk"
            lines.append(f"            bend = {bend}")
            lines.append(f"            self.{a} = self.kept_{a} + t * (self.kept_{a}_rate + bend)")
            rate = f"self.{a}_acceleration - half * self.{a}_jerk"
            lines.append(f"            self.{a}_rate = self.kept_{a}_rate + t * ({rate})")
        return lines

    def _reduced(self, then: str) -> list[str]:
        lines = []
        for f in self.turning:
            lines.append(f"        if math.fabs(self.{f}) > TURN:")
            lines.append(f"            self.{f}, turns = reduce_angle(self.{f})")
            lines.append(f"            self.{self.turns_of(f)} += turns")
            lines += [f"            {then}"] if then else []
        return lines

    def _saved(self) -> list[str]:
        others = ["turns1"] if len(self.turning) > 1 else []
        others += ["magnification", "fresh"] if self.magnified else []
        more = [*(self.names[s] for x in self.shapes for s in (x, x.rate)), *others]
        lines = ["", "    def set_state(self, state: list[float]) -> None:"]
        lines.append("        super().set_state(state)")
        lines += [f"        self.{n} = state[{12 + i}]" for i, n in enumerate(more)]
        lines.append("        self.refresh()")
        if not more:
            return lines
        values = ", ".join(f"self.{n}" for n in more)
        lines += ["", "    def get_state(self) -> list[float]:"]
        lines.append(f"        return [*super().get_state(), {values}]")
        lines += ["", "    def keep(self) -> None:", "        super().keep()"]
        lines += [f"        self.kept_{n} = self.{n}" for n in more]
        lines += ["", "    def undo(self) -> None:"]
        lines += [f"        self.{n} = self.kept_{n}" for n in more]
        return [*lines, "        super().undo()"]

    def _words(self) -> list[str]:
        lines: list[str] = []
        remedies = []
        if self.m.linear_about is not None:
            remedies += [
                ("linear", "set model.fidelity = 1 (linear), or "),
                ("nonlinear", "set model.fidelity = 2 (nonlinear), or start smaller"),
            ]
        if self.m.constraint is not None:
            remedy = "set constraint.stabilization = 3 (projection) or model.formulation = 2"
            remedies.append(("drift", remedy))
        if remedies:
            lines += ["", "    def remedy(self, trouble: str) -> str:"]
            for trouble, remedy in remedies:
                lines += [f'        if trouble == "{trouble}":', f'            return "{remedy}"']
            lines.append('        return ""')
        if self.shapes:
            lines += ["", "    def variation(self) -> str:"]
            parts = [
                f"{s.name} = {{self.{self.names[s]}!r}}"
                for x in self.shapes
                for s in (x.rate, x.acceleration)
            ]
            lines.append(f'        return f"{" and ".join(parts)}"')
        return lines


def any_of(fields: Iterable[str]) -> str:
    """A condition: any of the fields is not zero."""
    return " or ".join(f"{f} != 0.0" for f in fields)


def _tuple(name: str, values: Sequence[str]) -> list[str]:
    lines = [f"    {name}: ClassVar[tuple[str, ...]] = ("]
    if not values:
        return [f"{lines[0]})"]
    return [*lines, *(f'        "{v}",' for v in values), "    )"]

"""The class of a kernel module for one mass in Cartesian coordinates, held by a multiplier."""

from __future__ import annotations

import sympy

from .constrained import Constrained
from .derivation import Derivation
from .kernel_class import DerivedClass, potential_sums
from .kernel_outputs import FORCES, PLACES, VELOCITIES
from .kernel_parts import SETTINGS
from .kernel_writer import FREE, INVERSE, PUSH
from .names import Names

__all__ = ["ConstrainedClass"]


class ConstrainedClass(DerivedClass):
    """Writes `class Constrained(Derived)`."""

    name = "Constrained"
    prefix = "c"

    def __init__(self, derivation: Derivation, names: Names) -> None:
        super().__init__(derivation, names)
        assert derivation.constraint is not None
        self.c: Constrained = derivation.constraint
        self.known = [*self.c.p, *self.c.v]
        own = dict(zip(self.c.p, ("px", "py"), strict=True))
        own |= dict(zip(self.c.v, ("pvx", "pvy"), strict=True))
        own |= {self.c.damping: "feedback_damping", self.c.stiffness: "feedback_stiffness"}
        self.own_names = own
        self._fields |= {
            self.c.p[0]: "q0", self.c.p[1]: "q1", self.c.v[0]: "v0", self.c.v[1]: "v1",
        }  # fmt: skip

    def arguments(self) -> str:
        return "t: float, px: float, py: float, pvx: float, pvy: float"

    def lines(self) -> list[str]:
        methods = [
            self._place(),
            self._acceleration(),
            self._power(),
            self._jacobian(),
            self._energies(),
            self._settle(),
            ["", "    def magnifies(self) -> float:", "        return 1.0"]
            if self.magnified
            else [],
            self._observed(),
        ]
        head = [
            "class Constrained(Derived):",
            '    """q = position, v = velocity of the mass."""',
            "",
        ]
        head += ["    def __init__(self) -> None:", "        super().__init__()"]
        head += ["        #: whether positions and velocities are projected onto the curve"]
        head += ["        self.projects: bool = False"]
        head += ["        # Baumgarte's feedback of the constraint and its rate"]
        head += ["        self.feedback_stiffness: float = 0.0"]
        head += ["        self.feedback_damping: float = 0.0"]
        head += ["        self.feeds_back: bool = False"]
        head += ["        # position and rate after the last internal step, for counting turns"]
        head += [f"        self.last_{n}: float = 0.0" for n in ("x", "y", "side", "rate")]
        head += [f"        self.{s.name}: float = 0.0" for s in self.constants.values()]
        head += ["", "    def refresh(self) -> None:", "        super().refresh()"]
        head += ["        self.uses_rates = True"]
        head += ["        self.last_x = self.q0", "        self.last_y = self.q1"]
        head += self.body([("self.last_side", self._side()), ("self.last_rate", self._rate())])
        head += self._refresh_values("super().refresh_values()")
        return [*head, *(line for method in methods for line in method)]

    def _rate(self) -> sympy.Expr:
        return sympy.Add(
            *(self.c.coordinate.diff(x) * v for x, v in zip(self.c.p, self.c.v, strict=True))
        )

    def _side(self) -> sympy.Expr:
        """Of the cut at which the coordinate's principal value jumps; 0 where that is not known."""
        of = self.c.coordinate
        return of.args[0] if isinstance(of, sympy.atan2) else sympy.Integer(0)

    def _place(self) -> list[str]:
        d = self.d
        place = [r.position for r in d.raw]
        motion = [r.slopes[0] * d.v[0] for r in d.raw]
        pairs = [("px", place[0]), ("py", place[1]), ("pvx", motion[0]), ("pvy", motion[1])]
        lines = [
            "",
            f"    def place(self, {SETTINGS}) -> None:",
        ]
        lines += ['        stabilization = choices["constraint.stabilization"]']
        lines += ["        if stabilization < 1 or stabilization > 3:"]
        lines += ["            raise ValueError("]
        lines += [
            '                f"constraint.stabilization is {stabilization}: choose 1 (none), "'
        ]
        lines += ['                "2 (baumgarte) or 3 (projection)"', "            )"]
        lines += ["        self.projects = stabilization == 3"]
        lines += ["        self.feedback_damping = self.feedback_stiffness = 0.0"]
        lines += ["        self.feeds_back = stabilization == 2", "        if self.feeds_back:"]
        for n in ("damping", "stiffness"):
            lines.append(f'            self.feedback_{n} = parameters["constraint.{n}"]')
        lines += ["        super().place(parameters, choices)"]
        lines += self.body(pairs)
        if self.turning:
            lines += ["        before = self.q0"]
        lines += [f"        self.{f} = {n}" for n, f in (
            ("px", "q0"), ("py", "q1"), ("pvx", "v0"), ("pvy", "v1"))]  # fmt: skip
        if self.turning:
            lines += self.body([("after", self.c.coordinate)])
            lines.append("        self.turns += nearest_whole((before - after) / TURN)")
        lines += ["        self.q0_scale = self.q1_scale = math.sqrt(px * px + py * py) or 1.0"]
        return [*lines, "        self.settles = True"]

    def _acceleration(self) -> list[str]:
        deep = " " * 12
        constants = [*self._constant_symbols(), self.c.damping, self.c.stiffness]
        free = [(s.name, e) for s, e in zip(FREE, self.c.free, strict=True)]
        plain = [(name, e.subs(self.off)) for name, e in free]
        # a reciprocal, which does not wait for the velocity that a Runge-Kutta stage knows last
        lines = ["", f"    def acceleration(self, {self.arguments()}) -> None:"]
        lines += self.body([("inverse", 1 / self.c.square)], self.known, hoist=constants)
        lines += ["        if self.plain:", *self.body(plain, self.known, indent=deep)]
        lines += ["        else:", *self.body(free, self.known, indent=deep, hoist=constants)]
        known = [*self.known, INVERSE, *FREE, PUSH]
        lines += self.body([("push", self.c.leaving(FREE))], known)
        lines += ["        if self.feeds_back:"]
        fed = PUSH + self.c.feedback
        lines += self.body([("push", fed)], known, indent=deep, hoist=constants)
        held = self.c.held(FREE, -PUSH * INVERSE)
        return lines + self.body([(f"self.a{i}", e) for i, e in enumerate(held)], known)

    def _power(self) -> list[str]:
        lines = ["", f"    def power(self, {self.arguments()}, a0: float, a1: float) -> float:"]
        gx, gy = self.c.gradient
        lines.append("        if self.projects:")
        lines.append("            # what the projection takes back of the motion has done no work")
        deep = " " * 12
        lines += self.body([("gx_", gx), ("gy_", gy)], self.known, indent=deep)
        lines.append(f"{deep}normal = (gx_ * pvx + gy_ * pvy) / (gx_ * gx_ + gy_ * gy_)")
        lines += [f"{deep}pvx -= normal * gx_", f"{deep}pvy -= normal * gy_"]
        d = self.d
        a = sympy.symbols("a0 a1", real=True)
        dampers = sympy.Add(*(x.coefficient for x in self.m.damping if x.of == d.rows[0].of))
        power = sympy.Add(
            *(
                r.external * (v + w) - dampers * v * v + (r.mass * (acc - r.field) - r.external) * w
                for r, v, w, acc in zip(d.raw, self.c.v, d.motion, a, strict=True)
            )
        )
        return lines + self.body([("return", power)], [*self.known, *a], moving=True)

    def _jacobian(self) -> list[str]:
        lines = ["", f"    def jacobian(self, {self.arguments()}) -> None:"]
        symbols = zip(self.known, ("q0", "q1", "v0", "v1"), strict=True)
        pairs = [(f"self.a{i}", e) for i, e in enumerate(self.c.accelerations)]
        pairs += [
            (f"self.a{i}_{field}", e.diff(s))
            for s, field in symbols
            for i, e in enumerate(self.c.accelerations)
        ]
        return lines + self.body(pairs, self.known)

    def _energies(self) -> list[str]:
        d = self.d
        pairs = [
            ("self.kinetic", sympy.Add(*(
                r.mass * (w + v) ** 2 / 2 for r, w, v in zip(d.raw, d.motion, self.c.v, strict=True)
            ))),
        ]  # fmt: skip
        for i, (r, x, p) in enumerate(zip(d.raw, d.place, self.c.p, strict=True)):
            pairs.append((f"part{i}", -r.mass * d.gravity[r.axis] * (x + p)))
        lines = ["", "    def energies_at(self, t: float) -> None:"]
        return lines + self.body(pairs, moving=True) + potential_sums(2)

    def _settle(self) -> list[str]:
        c = self.c
        lines = ["", "    def settle(self, h: float) -> None:"]
        lines += ['        """Project onto the curve, if chosen, and count turns."""']
        lines += ["        px = self.q0", "        py = self.q1", "        pvx = self.v0"]
        lines += ["        pvy = self.v1", "        if self.projects:"]
        far = [("far", c.equation / c.square), ("gx_", c.gradient[0]), ("gy_", c.gradient[1])]
        near = "math.fabs(far) * (math.fabs(gx_) + math.fabs(gy_)) > 1e-8 * self.q0_scale"
        for inner, condition in ((" " * 12, ""), (" " * 16, f"            if {near}:")):
            lines += [condition] if condition else []
            lines += self.body(far, self.known, indent=inner)
            lines += [f"{inner}px -= far * gx_", f"{inner}py -= far * gy_"]
        lines += self.body(far[1:], self.known, indent=" " * 12)
        lines += [
            "            normal = (gx_ * pvx + gy_ * pvy) / (gx_ * gx_ + gy_ * gy_)",
            "            pvx -= normal * gx_",
            "            pvy -= normal * gy_",
            "            self.q0 = px",
            "            self.q1 = py",
            "            self.v0 = pvx",
            "            self.v1 = pvy",
        ]
        if self.turning:
            lines += self.body([("side", self._side()), ("rate", self._rate())], self.known)
            # a small step on one side of the cut makes no turn
            move = "h * (math.fabs(rate) + math.fabs(self.last_rate))"
            lines += [f"        if not (side * self.last_side > 0.0 and {move} < 3.0):"]
            deep = " " * 12
            lines += self.body([("now", c.coordinate)], self.known, indent=deep)
            lines += [f"{deep}px = self.last_x", f"{deep}py = self.last_y"]
            lines += self.body([("before", c.coordinate)], self.known, indent=deep)
            lines += [
                f"{deep}expected = before + 0.5 * h * (self.last_rate + rate)",
                f"{deep}self.turns += nearest_whole((expected - now) / TURN)",
                "        self.last_x = self.q0",
                "        self.last_y = self.q1",
                "        self.last_side = side",
                "        self.last_rate = rate",
            ]
        lines += ["", "    def advance_frame(self, duration: float) -> None:"]
        lines += ["        if self.moving or self.reshapes:"]
        return [*lines, "            self.move_frame(duration)", "            self.refresh()"]

    def _observed(self) -> list[str]:
        at, d, c = self.outputs.at, self.d, self.c
        (coordinate,), (rate,) = d.q, d.v
        name = d.raw[0].of.name
        deep = " " * 12
        lines = ["", "    def observe(self, group: int, values: Values, first: int) -> None:"]
        lines.append(f"        if group == {PLACES}:")
        places = [(at[f"{name}.{a}"], x + p) for a, x, p in zip("xy", d.place, c.p, strict=True)]
        places += [("coordinate", c.coordinate), (at[rate.name], self._rate())]
        lines += self.body(places, indent=deep)
        value = "unwind(coordinate, self.turns)" if self.turning else "coordinate"
        lines.append(f"{deep}{at[coordinate.name]} = {value}")
        lines.append(f"        elif group == {VELOCITIES}:")
        moved = [(at[f"{name}.v{a}"], w + v) for a, w, v in zip("xy", d.motion, c.v, strict=True)]
        lines += self.body(moved, indent=deep)
        lines.append("        else:")
        lines.append(f"{deep}super().observe(group, values, first)")
        dampers = sympy.Add(*(x.coefficient for x in self.m.damping if x.of == d.rows[0].of))
        multiplier = c.specific * c.mass
        forces = [(at["constraint.multiplier"], multiplier)]
        forces += [(at["constraint.force"], multiplier * sympy.sqrt(c.square))]
        forces += [(at["constraint.drift"], c.distance)]
        if self.m.frame:
            for a, g, v in zip("xy", c.gradient, c.v, strict=True):
                forces.append((at[f"{self.m.frame}.f{a}"], dampers * v - multiplier * g))
        for observed, e in self.m.observed.items():
            reaction = [multiplier * g - dampers * v for g, v in zip(c.gradient, c.v, strict=True)]
            own = dict(zip(d.raw[0].of.reaction, reaction, strict=True))
            own |= {coordinate: c.coordinate, rate: self._rate()}
            forces.append((at[observed], sympy.sympify(e).subs(own)))
        lines += ["", "    def write_forces(self, values: Values, first: int) -> None:"]
        lines.append(f'        """Write the outputs of group {FORCES}."""')
        return lines + self.body(forces)

"""The words of a mechanics.py: what stands on the blackboard before anything is derived.

Every symbol bears the name of the FMU's variable that it stands for; expressions are sympy's.
Positions are counted from the origin of the frame, x to the right and y up.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from functools import cached_property

import sympy
from sympy import Expr, Symbol

from .elements import (
    Angle,
    Constraint,
    Coordinate,
    Drag,
    Input,
    Mass,
    Parameter,
    Reaction,
    Shape,
)
from .statement_checks import check, planar

__all__ = [
    "Constraint",
    "Mechanics",
    "angle",
    "drag",
    "input_",
    "length",
    "mass",
    "parameter",
    "shape",
]


@dataclass(frozen=True)
class Mechanics:
    """A mechanical system in one or two generalised coordinates.

    coordinates: one or two. masses: the point masses.
    frame: name of what the positions are counted from; inputs NAME.ax, .ay move it, outputs
        NAME.x, .y, .vx, .vy say where it is and NAME.fx, .fy what acts on it. None: it rests.
    damping: drags. potential: energy (J) besides that of gravity, of coordinates and parameters.
    couples: generalised forces on coordinates (N, on an angle N.m), of inputs, parameters, state.
    forces: further external forces on masses, two components each (N).
    constraint: the Cartesian form, see Constraint.
    observed: further outputs, expressions that may contain reactions.
    linear_about: a state of rest about which there is a linear fidelity too (the quadratic part
        of the Lagrangian): choice model.fidelity, output model.acceleration_error.

    Raises ValueError for what cannot be derived.
    """

    coordinates: Sequence[Coordinate]
    masses: Sequence[Mass]
    frame: str | None = None
    damping: Sequence[Drag] = ()
    potential: Expr = field(default_factory=lambda: sympy.Integer(0))
    couples: Mapping[Coordinate, Expr] = field(default_factory=dict)
    forces: Mapping[Mass, tuple[Expr, Expr]] = field(default_factory=dict)
    constraint: Constraint | None = None
    observed: Mapping[str, Expr] = field(default_factory=dict)
    linear_about: Mapping[Coordinate, float] | None = None

    def __post_init__(self) -> None:
        check(self)

    @cached_property
    def _all_symbols(self) -> list[Symbol]:
        stated = [e for m in self.masses for e in (m.x, m.y)]
        stated += [self.potential, *self.couples.values(), *self.observed.values()]
        stated += [e for pair in self.forces.values() for e in pair]
        place = (Symbol("x", real=True), Symbol("y", real=True))
        if self.constraint is not None:
            c = self.constraint
            stated += [of(*place) for of in (c.equation, c.coordinate, c.distance) if of]
        found = {s for e in stated for s in sympy.sympify(e).free_symbols} - {*place}
        return sorted(found, key=str)

    @property
    def is_affine(self) -> bool:
        """Whether forces are affine in inputs, and what is observed in inputs and reactions."""
        stated = [*self.couples.values(), *self.observed.values()]
        stated += [e for pair in self.forces.values() for e in pair]
        for e in map(sympy.sympify, stated):
            given = [s for s in e.free_symbols if isinstance(s, Input | Reaction)]
            if any(sympy.expand(e.diff(a, b)) != 0 for a in given for b in given):
                return False
        return True

    @property
    def shapes(self) -> list[Shape]:
        """The shapes that positions contain."""
        return [s for s in self._all_symbols if isinstance(s, Shape)]

    @property
    def parameters(self) -> list[str]:
        """Names of all parameters, gravity and start values included."""
        names = ["gravity.x", "gravity.y"]
        for s in self.shapes:
            names += [f"{s.name}_start", f"{s.name}_rate_start"]
        of_shapes = {s.rate for s in self.shapes}
        names += [m.mass.name for m in self.masses]
        names += [s.name for s in self._all_symbols if type(s) is Parameter and s not in of_shapes]
        names += [d.name for d in self.damping]
        if self.constraint is not None:
            names += ["constraint.stiffness", "constraint.damping"]
        for c in self.coordinates:
            names += [f"{c.name}_start", f"{c.rate.name}_start"]
        return list(dict.fromkeys(names))

    @property
    def inputs(self) -> list[str]:
        """Names of all inputs."""
        names = [f"{self.frame}.ax", f"{self.frame}.ay"] if self.frame else []
        names += [s.acceleration.name for s in self.shapes]
        names += [f.name for m in self.masses for f in m.force]
        names += [s.name for s in self._all_symbols if type(s) is Input]
        return list(dict.fromkeys(names))

    @property
    def outputs(self) -> list[str]:
        """Names of all outputs of the motion and its forces."""
        names = [n for c in self.coordinates for n in (c.name, c.rate.name)]
        names += [f"{m.name}.{n}" for m in self.masses for n in ("x", "y", "vx", "vy")]
        if self.frame:
            names += [f"{self.frame}.{n}" for n in ("x", "y", "vx", "vy")]
        names += [n for s in self.shapes for n in (s.name, s.rate.name)]
        names += [f"energy.{n}" for n in ("kinetic", "potential", "total", "residual")]
        if self.frame:
            names += [f"{self.frame}.fx", f"{self.frame}.fy"]
        if self.constraint is not None:
            names += [f"constraint.{n}" for n in ("multiplier", "force", "drift")]
        names += list(self.observed)
        if self.linear_about is not None:
            names.append("model.acceleration_error")
        return names


def parameter(name: str) -> Parameter:
    """A parameter of the FMU by its name; fmu.py says its unit, start value and domain."""
    return Parameter(name)


def input_(name: str) -> Input:
    """An input of the FMU by its name, for couples and forces; fmu.py says its unit."""
    return Input(name)


def shape(name: str) -> Shape:
    """A number whose motion is prescribed, see Shape."""
    return Shape(name)


def length(name: str) -> Coordinate:
    """A coordinate that is measured in m (or in any unit but rad)."""
    return Coordinate(name)


def angle(name: str) -> Coordinate:
    """A coordinate that is measured in rad."""
    return Angle(name)


def mass(name: str, x: Expr, y: Expr, *more: Expr) -> Mass:
    """A point mass at (x, y) from the origin of the frame, see Mass; ValueError for `more`."""
    planar(f"the position of mass {name}", (x, y, *more))
    return Mass(name, sympy.sympify(x), sympy.sympify(y))


def drag(name: str, of: Mass | Coordinate) -> Drag:
    """Viscous damping of a mass or a coordinate with the coefficient `name`, see Drag."""
    return Drag(name, of)

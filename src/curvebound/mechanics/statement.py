"""The words of a mechanics.py: what stands on the blackboard before anything is derived.

Every symbol bears the name of the FMU's variable that it stands for; expressions are sympy's.
Positions are counted from the origin of the frame, x to the right and y up.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from functools import cached_property

import sympy
from sympy import Expr, Matrix, Symbol

__all__ = [
    "Constraint",
    "Coordinate",
    "Drag",
    "Input",
    "Mass",
    "Mechanics",
    "Parameter",
    "Rate",
    "Shape",
    "angle",
    "drag",
    "input_",
    "length",
    "mass",
    "parameter",
    "shape",
]


#: symbols of derivations
_RESERVED = {f"{what}.{axis}" for what in ("field", "position", "velocity") for axis in "xy"}


class Parameter(Symbol):  # type: ignore[misc]
    """A parameter of the FMU, constant in time."""

    def __new__(cls, name: str) -> Parameter:
        made: Parameter = super().__new__(cls, name, real=True)
        return made


class Input(Parameter):
    """An input of the FMU, constant over a communication step."""


class Rate(Parameter):
    """The rate of a coordinate."""


class Reaction(Parameter):
    """A component of the force with which constraints, damping and potential act on a mass."""


class Coordinate(Parameter):
    """A generalised coordinate: an output, with NAME_start and the start of its rate."""

    @property
    def is_angle(self) -> bool:
        """Whether it is measured in rad."""
        return False

    @property
    def rate(self) -> Rate:
        """Its rate: the output NAME_rate; of an angle called angle, angular_velocity."""
        name = self.name
        if self.is_angle and name.rpartition(".")[2] == "angle":
            return Rate(name[: -len("angle")] + "angular_velocity")
        return Rate(name + "_rate")


class Angle(Coordinate):
    """A coordinate in rad."""

    @property
    def is_angle(self) -> bool:
        return True


class Shape(Parameter):
    """A number in the positions whose motion is prescribed.

    Outputs NAME and NAME_rate, parameters NAME_start and NAME_rate_start, input NAME_acceleration.
    """

    @property
    def rate(self) -> Parameter:
        """Its rate."""
        return Parameter(self.name + "_rate")

    @property
    def acceleration(self) -> Input:
        """The input that drives it."""
        return Input(self.name + "_acceleration")


@dataclass(frozen=True)
class Mass:
    """A point mass: parameter NAME.mass, inputs NAME.fx, .fy, outputs NAME.x, .y, .vx, .vy.

    x, y: its position from the origin of the frame (m).
    """

    name: str
    x: Expr
    y: Expr

    @property
    def mass(self) -> Parameter:
        """The parameter NAME.mass (kg)."""
        return Parameter(f"{self.name}.mass")

    @property
    def force(self) -> Matrix:
        """The external force on it (N), from the inputs NAME.fx and NAME.fy."""
        return Matrix([Input(f"{self.name}.fx"), Input(f"{self.name}.fy")])

    @property
    def velocity(self) -> Matrix:
        """Its velocity (m/s) relative to the frame."""
        return Matrix([_rate_of(self.x), _rate_of(self.y)])

    @property
    def reaction(self) -> Matrix:
        """The force on it (N) that is neither gravity nor external: what holds and damps it."""
        return Matrix([Reaction(f"{self.name}.reaction.x"), Reaction(f"{self.name}.reaction.y")])


def _rate_of(expression: Expr) -> Expr:
    symbols = sorted(expression.free_symbols, key=str)
    moving = [s for s in symbols if isinstance(s, Coordinate | Shape)]
    return sympy.Add(*(expression.diff(s) * s.rate for s in moving))


@dataclass(frozen=True)
class Drag:
    """Viscous damping with the coefficient `name`.

    of: a mass, whose motion along its curve (the shape held) it resists by a force, or a
        coordinate, whose rate it resists by a couple.
    """

    name: str
    of: Mass | Coordinate

    @property
    def coefficient(self) -> Parameter:
        """The parameter, N.s/m; N.m.s/rad on an angle."""
        return Parameter(self.name)


@dataclass(frozen=True)
class Constraint:
    """One mass once more, in Cartesian coordinates held by a multiplier.

    equation: C(x, y), zero on the curve; the constraint force is multiplier times its gradient.
    coordinate: the generalised coordinate as a function of x, y.
    distance: from the curve (m), for the drift; C over the size of its gradient where not given.

    Variables: choices model.formulation (1 this, 2 the coordinate) and constraint.stabilization
    (1 none, 2 baumgarte, 3 projection), parameters constraint.stiffness and .damping, outputs
    constraint.multiplier, .force, .drift.
    """

    equation: Callable[[Symbol, Symbol], Expr]
    coordinate: Callable[[Symbol, Symbol], Expr]
    distance: Callable[[Symbol, Symbol], Expr] | None = None


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
        if not 1 <= len(self.coordinates) <= 2:
            raise ValueError(
                f"{len(self.coordinates)} coordinates are declared: state one or two, and the "
                "positions of all masses by them"
            )
        if not self.masses:
            raise ValueError("no mass is declared: state at least one, with its position")
        if self.constraint is not None and (len(self.masses), len(self.coordinates)) != (1, 1):
            raise ValueError("a constraint with a multiplier holds one mass of one coordinate")
        stray = [
            s
            for m in self.masses
            for s in (sympy.sympify(m.x) + sympy.sympify(m.y)).free_symbols
            if not isinstance(s, Coordinate | Shape | Parameter) or isinstance(s, Input | Rate)
        ]
        unknown = [c for c in self._all_symbols if isinstance(c, Coordinate)]
        stray += [c for c in unknown if c not in self.coordinates]
        if stray:
            raise ValueError(
                f"{stray[0]} in a position or force is no symbol of this system: make it a "
                "parameter, a shape or one of the declared coordinates"
            )
        taken = Counter([*self.parameters, *self.inputs, *self.outputs])
        for name, count in taken.items():
            if count > 1 or name in _RESERVED:
                raise ValueError(
                    f"{name} would stand for two things: a mass or frame NAME has the outputs "
                    "NAME.x, .y, .vx and .vy; call a coordinate or parameter otherwise, as in "
                    f"{name.partition('.')[0]}.u, and no two masses alike"
                )

    @cached_property
    def _all_symbols(self) -> list[Symbol]:
        stated = [e for m in self.masses for e in (m.x, m.y)]
        stated += [self.potential, *self.couples.values(), *self.observed.values()]
        stated += [e for pair in self.forces.values() for e in pair]
        if self.constraint is not None:
            x, y = Symbol("x", real=True), Symbol("y", real=True)
            stated += [self.constraint.equation(x, y).subs({x: 0, y: 0})]
        found = {s for e in stated for s in sympy.sympify(e).free_symbols}
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


def mass(name: str, x: Expr, y: Expr) -> Mass:
    """A point mass at (x, y) from the origin of the frame, see Mass."""
    return Mass(name, sympy.sympify(x), sympy.sympify(y))


def drag(name: str, of: Mass | Coordinate) -> Drag:
    """Viscous damping of a mass or a coordinate with the coefficient `name`, see Drag."""
    return Drag(name, of)

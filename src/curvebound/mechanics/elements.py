"""The symbols of a statement, and what it consists of: masses, drags, a constraint."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import sympy
from sympy import Expr, Matrix, Symbol

__all__ = [
    "Angle",
    "Constraint",
    "Coordinate",
    "Drag",
    "Input",
    "Mass",
    "Parameter",
    "Rate",
    "Reaction",
    "Shape",
]


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

    Forces on the mass may depend on inputs and parameters, damping is on the mass, the curve keeps
    its shape: what else depends on the coordinate or its rate has no Cartesian form.

    Variables: choices model.formulation (1 this, 2 the coordinate) and constraint.stabilization
    (1 none, 2 baumgarte, 3 projection), parameters constraint.stiffness and .damping, outputs
    constraint.multiplier, .force, .drift.
    """

    equation: Callable[[Symbol, Symbol], Expr]
    coordinate: Callable[[Symbol, Symbol], Expr]
    distance: Callable[[Symbol, Symbol], Expr] | None = None

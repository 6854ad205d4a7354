"""The physics of a system, stated once: the words of a mechanics.py.

Coordinates, one or two; positions are sympy expressions of them (from sympy import cos, sin):

    length(NAME)            a coordinate in m: outputs NAME, NAME_rate, parameters NAME_start, ...
    angle(NAME)             a coordinate in rad
    .rate                   the rate of a coordinate or shape, for forces, couples and observed

What moves, in a plane, x to the right and y up, in m from the origin of the frame:

    mass(NAME, x, y)        a point mass: parameter NAME.mass, inputs NAME.fx, .fy, outputs NAME.x,
                            .y, .vx, .vy; .reaction is the force of curves, rods and dampers on it
    parameter(NAME)         a number of fmu.py, constant in time
    shape(NAME)             a number whose motion the input NAME_acceleration drives
    input_(NAME)            a number that the host gives, for forces, couples and observed

How they belong together, MECHANICS = Mechanics(coordinates=[...], masses=[...], ...) with

    frame=NAME              what positions are counted from: inputs NAME.ax, .ay move it
    damping=[...]           of drag(NAME, of): viscous, NAME is the coefficient; on a mass (N.s/m)
                            against its motion along its curve, on a coordinate against its rate
    potential=              energy in J besides that of gravity, of coordinates, shapes, parameters
    forces={mass: (x, y)}   further external forces in N, of coordinates, rates, inputs, parameters
    couples={coordinate: e} generalised forces, in N, on an angle in N.m, of the same
    observed={NAME: e}      further outputs, of the same and of reactions
    constraint=             Constraint(equation, coordinate, distance): one mass, held on its curve
                            by a multiplier; without shapes, couples and a potential
    linear_about={...}      a rest, coordinate: value, about which there is a linear model too

Gravity is there already, with parameters gravity.x and gravity.y, and so are the energies.
Limits: planar, point masses only; one or two coordinates, each of which moves a mass at every
state that is reached; no dry friction and no impacts.
`curvebound new NAME` writes a system to begin with; fmu.py says units, start values and domains.
"""

# The words are imported when first used: who only reads what was derived needs no sympy.

from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from .statement import (
        Constraint,
        Mechanics,
        angle,
        drag,
        input_,
        length,
        mass,
        parameter,
        shape,
    )

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


def __getattr__(name: str) -> Any:
    if name not in __all__:
        raise AttributeError(f"module {__name__} has no attribute {name}")
    from . import statement

    return getattr(statement, name)


def __dir__() -> list[str]:
    return sorted({*globals(), *__all__})

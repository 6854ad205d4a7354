"""A bead on an ellipse, its angle measured from the centre, and in Cartesian coordinates."""

from sympy import atan2, cos, sin, sqrt

from curvebound.mechanics import Constraint, Mechanics, angle, drag, mass, parameter

a, b = parameter("wire.width"), parameter("wire.height")
th = angle("bead.angle")
r = a * b / sqrt((b * sin(th)) ** 2 + (a * cos(th)) ** 2)
bead = mass("bead", r * sin(th), -r * cos(th))

MECHANICS = Mechanics(
    coordinates=[th],
    masses=[bead],
    frame="wire",
    damping=[drag("bead.damping", bead)],
    constraint=Constraint(
        lambda x, y: (x**2 / a**2 + y**2 / b**2 - 1) / 2, coordinate=lambda x, y: atan2(x, -y)
    ),
)

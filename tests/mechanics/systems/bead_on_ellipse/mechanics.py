"""A bead on an ellipse, by its eccentric anomaly, and in Cartesian coordinates."""

from sympy import atan2, cos, sin

from curvebound.mechanics import Constraint, Mechanics, angle, drag, mass, parameter

a, b = parameter("wire.width"), parameter("wire.height")
th = angle("bead.angle")
bead = mass("bead", a * sin(th), -b * cos(th))

MECHANICS = Mechanics(
    coordinates=[th],
    masses=[bead],
    frame="wire",
    damping=[drag("bead.damping", bead)],
    constraint=Constraint(
        lambda x, y: (x**2 / a**2 + y**2 / b**2 - 1) / 2,
        coordinate=lambda x, y: atan2(b * x, -a * y),
    ),
)

"""A bead on a circular wire: p = r (sin phi, -cos phi) from the centre, which may be moved."""

from sympy import atan2, cos, sin, sqrt

from curvebound.mechanics import Constraint, Mechanics, angle, drag, mass, parameter

r = parameter("wire.radius")
phi = angle("bead.angle")

bead = mass("bead", r * sin(phi), -r * cos(phi))

MECHANICS = Mechanics(
    coordinates=[phi],
    masses=[bead],
    frame="wire",
    damping=[drag("bead.damping", bead)],
    # the same in Cartesian coordinates, held on the wire by a multiplier
    constraint=Constraint(
        lambda x, y: (x**2 + y**2 - r**2) / 2,
        coordinate=lambda x, y: atan2(x, -y),
        distance=lambda x, y: (x**2 + y**2 - r**2) / (sqrt(x**2 + y**2) + r),
    ),
)

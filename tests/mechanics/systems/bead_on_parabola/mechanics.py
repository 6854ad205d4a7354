"""A bead on a wire bent as y = a x^2."""

from curvebound.mechanics import Mechanics, drag, length, mass, parameter

a = parameter("wire.coefficient")
x = length("bead.u")

bead = mass("bead", x, a * x**2)

MECHANICS = Mechanics(coordinates=[x], masses=[bead], damping=[drag("bead.damping", bead)])

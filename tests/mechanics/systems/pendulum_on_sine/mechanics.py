"""A pendulum whose pivot slides along a wire bent as y = b sin(k x)."""

from sympy import Matrix, cos, sin

from curvebound.mechanics import Mechanics, angle, drag, length, mass, parameter

b = parameter("wire.amplitude")
k = parameter("wire.wavenumber")
r = parameter("rod.length")
x = length("pivot.u")
th = angle("rod.angle")

pivot = mass("pivot", x, b * sin(k * x))
bob = mass("bob", pivot.x + r * sin(th), pivot.y - r * cos(th))

MECHANICS = Mechanics(
    coordinates=[x, th],
    masses=[pivot, bob],
    frame="wire",
    damping=[drag("pivot.damping", pivot), drag("rod.damping", th)],
    observed={"rod.tension": Matrix([-sin(th), cos(th)]).dot(bob.reaction)},
)

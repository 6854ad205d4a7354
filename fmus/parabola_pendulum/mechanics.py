"""A slider on the parabola y = a u^2 and a bob that hangs from it on a massless rod."""

from sympy import Matrix, cos, sin, sqrt

from curvebound.mechanics import Mechanics, angle, drag, length, mass, parameter, shape

a = shape("parabola.coefficient")
r = parameter("pendulum.length")
u = length("slider.u")
th = angle("pendulum.angle")

slider = mass("slider", u, a * u**2)
bob = mass("pendulum", slider.x + r * sin(th), slider.y - r * cos(th))

normal = Matrix([-2 * a * u, 1]) / sqrt(1 + 4 * a**2 * u**2)
towards_slider = Matrix([-sin(th), cos(th)])

MECHANICS = Mechanics(
    coordinates=[u, th],
    masses=[slider, bob],
    frame="parabola",
    damping=[drag("slider.damping", slider), drag("pendulum.damping", th)],
    observed={
        "constraint.normal_force": normal.dot(slider.reaction + bob.reaction),
        "pendulum.tension": towards_slider.dot(bob.reaction),
    },
    linear_about={u: 0, th: 0},
)

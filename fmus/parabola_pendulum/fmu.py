"""ParabolaPendulum: a slider on the parabola y = a u^2 and a pendulum that hangs from it.

The vertex of the parabola can be accelerated, its coefficient can change, forces can be applied to
slider and bob; damping acts along the parabola and on the pendulum's rotation.
"""

from curvebound.fmi.common import ENERGY, GRAVITY, SOLVER
from curvebound.fmi.declaration import Enumeration, Fmu, choice, input_, output, parameter
from curvebound.fmi.ranges import Angle, Items, Range

FIDELITY = Enumeration(
    "Fidelity",
    "terms of the Lagrangian that are kept",
    (
        ("linear", "the quadratic part about slider.u = pendulum.angle = 0"),
        ("nonlinear", "all terms"),
    ),
)

FMU = Fmu(
    name="ParabolaPendulum",
    description="Pendulum that hangs from a mass sliding on a parabola, driven and damped",
    variables=(
        *GRAVITY,
        parameter(
            "parabola.coefficient_start", "1/m", 0.5, "initial coefficient a of y = a u^2, any sign"
        ),
        parameter(
            "parabola.coefficient_rate_start", "1/(m.s)", 0.0, "initial rate of the coefficient"
        ),
        parameter("slider.mass", "kg", 1.0, "mass of the slider (above zero)", above=0.0),
        parameter("pendulum.mass", "kg", 1.0, "mass of the bob (above zero)", above=0.0),
        parameter("pendulum.length", "m", 1.0, "length of the rod (above zero)", above=0.0),
        parameter(
            "slider.damping",
            "N.s/m",
            0.0,
            "viscous damping of the slider along the parabola",
            at_least=0.0,
        ),
        parameter(
            "pendulum.damping",
            "N.m.s/rad",
            0.0,
            "viscous damping of the pendulum's rotation",
            at_least=0.0,
        ),
        parameter("slider.u_start", "m", 0.5, "initial abscissa of the slider from the vertex"),
        parameter("slider.u_rate_start", "m/s", 0.0, "initial rate of the abscissa"),
        parameter(
            "pendulum.angle_start",
            "rad",
            0.5,
            "initial angle of the rod from the downward vertical, counter-clockwise",
        ),
        parameter("pendulum.angular_velocity_start", "rad/s", 0.0, "initial angular velocity"),
        choice("model.fidelity", FIDELITY, "nonlinear", "terms of the Lagrangian that are kept"),
        *SOLVER,
        input_("parabola.ax", "m/s2", "acceleration of the vertex to the right", nominal=10.0),
        input_("parabola.ay", "m/s2", "acceleration of the vertex upward", nominal=10.0),
        input_(
            "parabola.coefficient_acceleration",
            "1/(m.s2)",
            "second time derivative of the coefficient",
        ),
        input_("slider.fx", "N", "external force on the slider to the right", nominal=10.0),
        input_("slider.fy", "N", "external force on the slider upward", nominal=10.0),
        input_("pendulum.fx", "N", "external force on the bob to the right", nominal=10.0),
        input_("pendulum.fy", "N", "external force on the bob upward", nominal=10.0),
        output("slider.u", "m", "abscissa of the slider from the vertex"),
        output("slider.u_rate", "m/s", "rate of the abscissa"),
        output("pendulum.angle", "rad", "angle of the rod from the downward vertical, continuous"),
        output("pendulum.angular_velocity", "rad/s", "rate of the angle"),
        output("slider.x", "m", "position of the slider to the right, world frame"),
        output("slider.y", "m", "position of the slider upward, world frame"),
        output("slider.vx", "m/s", "velocity of the slider to the right, world frame"),
        output("slider.vy", "m/s", "velocity of the slider upward, world frame"),
        output("pendulum.x", "m", "position of the bob to the right, world frame"),
        output("pendulum.y", "m", "position of the bob upward, world frame"),
        output("pendulum.vx", "m/s", "velocity of the bob to the right, world frame"),
        output("pendulum.vy", "m/s", "velocity of the bob upward, world frame"),
        output("parabola.x", "m", "position of the vertex to the right"),
        output("parabola.y", "m", "position of the vertex upward"),
        output("parabola.vx", "m/s", "velocity of the vertex to the right"),
        output("parabola.vy", "m/s", "velocity of the vertex upward"),
        output("parabola.coefficient", "1/m", "coefficient a of y = a u^2"),
        output("parabola.coefficient_rate", "1/(m.s)", "rate of the coefficient"),
        *ENERGY,
        output(
            "constraint.normal_force",
            "N",
            "force of the parabola on the slider along its unit normal, positive upward",
        ),
        output("pendulum.tension", "N", "force in the rod, positive in tension"),
        output("parabola.fx", "N", "force of slider and bob on the parabola to the right"),
        output("parabola.fy", "N", "force of slider and bob on the parabola upward"),
        output(
            "model.acceleration_error",
            "1",
            "linear fidelity: relative difference between linear and nonlinear accelerations",
        ),
    ),
    reference_inputs={"parabola.ax": (1.0, 0.3), "parabola.ay": (1.0, 0.7)},
    plotted=("slider.u", "pendulum.angle", "constraint.normal_force", "energy.residual"),
    ranges={
        "slider.mass": Range(1e-4, 1e4),
        "pendulum.mass": Range(1e-8, 1e8, times="slider.mass"),
        "pendulum.length": Range(1e-3, 1e3),
        "parabola.coefficient_start": Range(1e-4, 1e4, signed=True, share=0.95),
        "slider.u_start": Range(1e-3, 1e3, signed=True, share=0.8),
        "slider.u_rate_start": Range(1e-3, 1e3, signed=True, share=0.7, speed=True),
        "pendulum.angular_velocity_start": Range(1e-3, 1e3, signed=True, share=0.7, speed=True),
        "gravity": Range(1e-3, 1e3),
        "parabola.coefficient_rate_start": Range(1e-4, 1e4, signed=True, share=0.1),
        "slider.damping": Range(1e-6, 1e6, share=0.4),
        "pendulum.damping": Range(1e-6, 1e6, share=0.4),
        "pendulum.angle_start": Angle(),
        "model.fidelity": Items(("nonlinear", "nonlinear", "nonlinear", "linear")),
        "parabola.ax": Range(1e-3, 1e3, signed=True, share=0.15),
        "parabola.ay": Range(1e-3, 1e3, signed=True, share=0.15),
        "parabola.coefficient_acceleration": Range(1e-4, 1e4, signed=True, share=0.1),
        "slider.fx": Range(1e-3, 1e3, signed=True, share=0.15, times="slider.mass"),
        "slider.fy": Range(1e-3, 1e3, signed=True, share=0.15, times="slider.mass"),
        "pendulum.fx": Range(1e-3, 1e3, signed=True, share=0.15, times="pendulum.mass"),
        "pendulum.fy": Range(1e-3, 1e3, signed=True, share=0.15, times="pendulum.mass"),
    },
)

"""BeadOnWire: a bead on a circular wire in a vertical plane, held by a Lagrange multiplier.

The wire's centre can be accelerated, forces can be applied to the bead, viscous damping acts on the
motion relative to the wire.
"""

from curvebound.fmi.common import ENERGY, GRAVITY, SOLVER
from curvebound.fmi.declaration import Enumeration, Fmu, choice, input_, output, parameter
from curvebound.fmi.ranges import Angle, Items, Range

FORMULATION = Enumeration(
    "Formulation",
    "coordinates in which the equations of motion are integrated",
    (
        ("lagrange_multiplier", "Cartesian position and velocity with a Lagrange multiplier"),
        ("angle", "the angle as minimal coordinate"),
    ),
)

STABILIZATION = Enumeration(
    "Stabilization",
    "what keeps the Cartesian position on the wire",
    (
        ("none", "nothing: the constraint holds on acceleration level only and drifts"),
        ("baumgarte", "feedback of the drift and its rate (Baumgarte 1972)"),
        ("projection", "projection of position and velocity after each internal step"),
    ),
)

FMU = Fmu(
    name="BeadOnWire",
    description="Bead on a circular wire in a vertical plane, with viscous damping",
    variables=(
        *GRAVITY,
        parameter("wire.radius", "m", 1.0, "radius of the wire (above zero)", above=0.0),
        parameter("bead.mass", "kg", 1.0, "mass of the bead (above zero)", above=0.0),
        parameter("bead.damping", "N.s/m", 0.0, "viscous damping of the bead", at_least=0.0),
        parameter(
            "bead.angle_start",
            "rad",
            1.5707963267948966,
            "initial angle from the downward vertical, counter-clockwise",
        ),
        parameter("bead.angular_velocity_start", "rad/s", 0.0, "initial angular velocity"),
        parameter(
            "constraint.stiffness",
            "1/s2",
            100.0,
            "Baumgarte feedback of the constraint C = (p.p - r^2)/2",
            at_least=0.0,
            nominal=100.0,
        ),
        parameter(
            "constraint.damping",
            "1/s",
            20.0,
            "Baumgarte feedback of the rate of the constraint",
            at_least=0.0,
            nominal=10.0,
        ),
        choice(
            "model.formulation",
            FORMULATION,
            "lagrange_multiplier",
            "coordinates of the equations of motion",
        ),
        choice(
            "constraint.stabilization",
            STABILIZATION,
            "projection",
            "stabilisation of the constraint, for lagrange_multiplier",
        ),
        *SOLVER,
        input_("wire.ax", "m/s2", "acceleration of the wire's centre to the right", nominal=10.0),
        input_("wire.ay", "m/s2", "acceleration of the wire's centre upward", nominal=10.0),
        input_("bead.fx", "N", "external force on the bead to the right", nominal=10.0),
        input_("bead.fy", "N", "external force on the bead upward", nominal=10.0),
        output("bead.x", "m", "position of the bead, to the right, world frame"),
        output("bead.y", "m", "position of the bead, upward, world frame"),
        output("bead.vx", "m/s", "velocity of the bead to the right, world frame"),
        output("bead.vy", "m/s", "velocity of the bead upward, world frame"),
        output("bead.angle", "rad", "angle from the downward vertical, continuous"),
        output("bead.angular_velocity", "rad/s", "rate of the angle"),
        output("wire.x", "m", "position of the wire's centre to the right"),
        output("wire.y", "m", "position of the wire's centre upward"),
        output("wire.vx", "m/s", "velocity of the wire's centre to the right"),
        output("wire.vy", "m/s", "velocity of the wire's centre upward"),
        output(
            "constraint.drift",
            "m",
            "distance of the bead from the wire's centre, minus the radius",
            nominal=1e-6,
        ),
        *ENERGY,
        output("wire.fx", "N", "force of the bead on the wire to the right, damping included"),
        output("wire.fy", "N", "force of the bead on the wire upward, damping included"),
        output("constraint.multiplier", "N/m", "multiplier lambda: constraint force = lambda p"),
        output("constraint.force", "N", "lambda times the radius, positive outward"),
    ),
    reference_inputs={"wire.ax": (1.0, 0.5), "wire.ay": (2.0, 1.5)},
    plotted=("bead.angle", "constraint.force", "energy.total", "energy.residual"),
    ranges={
        "wire.radius": Range(1e-3, 1e3),
        "bead.mass": Range(1e-8, 1e8),
        "bead.angular_velocity_start": Range(1e-3, 1e3, signed=True, share=0.75, speed=True),
        "model.formulation": Items(("lagrange_multiplier", "angle")),
        "constraint.stabilization": Items(("none", "baumgarte", "projection", "projection")),
        "gravity": Range(1e-3, 1e3),
        "bead.damping": Range(1e-6, 1e6, share=0.6),
        "bead.angle_start": Angle(),
        "wire.ax": Range(1e-3, 1e3, signed=True, share=0.2),
        "wire.ay": Range(1e-3, 1e3, signed=True, share=0.2),
        "bead.fx": Range(1e-3, 1e3, signed=True, share=0.2, times="bead.mass"),
        "bead.fy": Range(1e-3, 1e3, signed=True, share=0.2, times="bead.mass"),
    },
)

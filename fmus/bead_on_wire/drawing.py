"""What to draw of the bead on its wire, in the names of the FMU's variables."""

from curvebound.fmi.drawing import (
    ENERGY_PLOTS,
    FRAME,
    Arrow,
    Circle,
    Drawing,
    Plot,
    Point,
    mass_arrows,
    plane,
)
from curvebound.fmi.sketch import Angle, Length, Sketch

DRAWING = Drawing(
    frame=("wire.x", "wire.y"),
    circles=(Circle("wire.x", "wire.y", "wire.radius", holds="bead"),),
    points=(Point("bead", "bead.x", "bead.y"),),
    arrows=(
        *mass_arrows("bead"),
        Arrow(
            "constraint force",
            "C",
            "bead",
            "constraint.force * sin(bead.angle)",
            "-constraint.force * cos(bead.angle)",
        ),
    ),
    otherwise={
        "wire.radius": (
            "first(hypot(bead.x - wire.x, bead.y - wire.y) - constraint.drift)",
            "first(hypot(bead.x - wire.x, bead.y - wire.y))",
            "first(constraint.force / constraint.multiplier)",
        ),
        "bead.x": ("wire.x + wire.radius * sin(bead.angle)",),
        "bead.y": ("wire.y - wire.radius * cos(bead.angle)",),
    },
    words={
        "bead.angle": "angle",
        "bead.angular_velocity": "angular velocity",
        **plane("bead.v{}", "bead velocity"),
        **plane("bead.f{}", "force on the bead"),
        "wire.radius": "radius",
        **plane("wire.{}", "wire centre"),
        **plane("wire.v{}", "wire velocity"),
        **plane("wire.a{}", "wire acceleration"),
        **plane("wire.f{}", "force on the wire"),
        "constraint.multiplier": "multiplier",
        "constraint.drift": ("drift", "constraint drift"),
    },
    plots=(
        Plot("Angle", ("bead.angle",)),
        *ENERGY_PLOTS,
        Plot("Constraint drift", ("constraint.drift",), error=True),
        Plot("Constraint force", ("constraint.force",)),
        Plot("Force on the wire", ("wire.fx", "wire.fy")),
        Plot("Drive", ("wire.ax", "wire.ay"), moving=True),
        Plot("Motion of the frame", ("wire.x", "wire.y"), moving=True),
        Plot("External force", ("bead.fx", "bead.fy"), moving=True),
        Plot("Angular velocity", ("bead.angular_velocity",), shown=False),
        Plot("Position", ("bead.x", "bead.y"), shown=False),
        Plot("Velocity", ("bead.vx", "bead.vy"), shown=False),
        Plot("Velocity of the frame", ("wire.vx", "wire.vy"), moving=True, shown=False),
        Plot("Multiplier", ("constraint.multiplier",), shown=False),
    ),
    readouts=(
        "bead.angle",
        "bead.angular_velocity",
        "bead.x",
        "bead.y",
        "constraint.force",
        "energy.total",
        "energy.residual",
        "constraint.drift",
        "solver.steps",
    ),
)

SKETCH = Sketch(
    symbols={"bead.mass": "m", "wire.radius": "r", "bead.angle": "θ"},
    masses={"bead": "bead.mass"},
    lengths=(Length(FRAME, "bead", "wire.radius"),),
    angles=(Angle(FRAME, "bead", "bead.angle"),),
    values={"bead.angle": 1.0},
)

"""What to draw of the pendulum on its parabola, in the names of the FMU's variables."""

from curvebound.fmi.drawing import (
    ENERGY_PLOTS,
    FRAME,
    Arrow,
    Curve,
    Drawing,
    Plot,
    Point,
    Rod,
    mass_arrows,
    plane,
)
from curvebound.fmi.sketch import Angle, Length, Sketch

_STEEPNESS = "(2 * parabola.coefficient * slider.u)"
_PUSH = f"constraint.normal_force / sqrt(1 + {_STEEPNESS}**2)"
#: of the rod at the slider
_PULL = (
    "pendulum.tension * sin(pendulum.angle)",
    "-pendulum.tension * cos(pendulum.angle)",
)

DRAWING = Drawing(
    frame=("parabola.x", "parabola.y"),
    curves=(Curve("parabola.x + s", "parabola.y + parabola.coefficient * s**2", holds="slider"),),
    points=(
        Point("slider", "slider.x", "slider.y", shape="square"),
        Point("bob", "pendulum.x", "pendulum.y", shape="round", light=True),
    ),
    rods=(Rod("slider", "bob"),),
    arrows=(
        *mass_arrows("slider"),
        *mass_arrows("pendulum", at="bob"),
        Arrow("normal force", "N", "slider", f"-{_STEEPNESS} * {_PUSH}", _PUSH),
        Arrow("rod tension", "T", "slider", *_PULL),
        Arrow("rod tension", "T", "bob", *(f"-({formula})" for formula in _PULL)),
    ),
    otherwise={
        "parabola.coefficient": (
            "median((slider.y - parabola.y) / (slider.x - parabola.x) ** 2)",
            "parabola.coefficient_start",
        ),
        "slider.x": ("parabola.x + slider.u",),
        "slider.y": ("parabola.y + parabola.coefficient * slider.u**2",),
        "pendulum.x": ("slider.x + pendulum.length * sin(pendulum.angle)",),
        "pendulum.y": ("slider.y - pendulum.length * cos(pendulum.angle)",),
    },
    words={
        "slider.u_rate": "slider rate",
        **plane("slider.v{}", "slider velocity"),
        **plane("slider.f{}", "force on the slider"),
        "pendulum.angle": ("angle", "pendulum angle"),
        "pendulum.angular_velocity": ("angular velocity", "pendulum rate"),
        "pendulum.length": "rod's length",
        **plane("pendulum.{}", "bob"),
        **plane("pendulum.v{}", "bob velocity"),
        **plane("pendulum.f{}", "force on the bob"),
        "pendulum.tension": "rod tension",
        **plane("parabola.{}", "vertex"),
        **plane("parabola.v{}", "vertex velocity"),
        **plane("parabola.a{}", "vertex acceleration"),
        **plane("parabola.f{}", "force on the parabola"),
        "parabola.coefficient": "coefficient",
        "parabola.coefficient_start": "coefficient",
        "parabola.coefficient_rate": "coefficient rate",
        "parabola.coefficient_acceleration": "coefficient acceleration",
        "constraint.normal_force": "normal force",
        "model.acceleration_error": "acceleration error",
    },
    plots=(
        Plot("Angle", ("pendulum.angle",)),
        Plot("Slider on the parabola", ("slider.u",)),
        *ENERGY_PLOTS,
        Plot("Error of the linear model", ("model.acceleration_error",), moving=True, error=True),
        Plot("Normal force and rod tension", ("constraint.normal_force", "pendulum.tension")),
        Plot("Force on the parabola", ("parabola.fx", "parabola.fy")),
        Plot("Drive", ("parabola.ax", "parabola.ay"), moving=True),
        Plot("Drive of the coefficient", ("parabola.coefficient_acceleration",), moving=True),
        Plot("Coefficient of the parabola", ("parabola.coefficient",), moving=True),
        Plot("Motion of the frame", ("parabola.x", "parabola.y"), moving=True),
        Plot(
            "External force", ("slider.fx", "slider.fy", "pendulum.fx", "pendulum.fy"), moving=True
        ),
        Plot("Angular velocity", ("pendulum.angular_velocity",), shown=False),
        Plot("Rate of the slider", ("slider.u_rate",), shown=False),
        Plot("Position", ("slider.x", "slider.y", "pendulum.x", "pendulum.y"), shown=False),
        Plot("Velocity", ("slider.vx", "slider.vy", "pendulum.vx", "pendulum.vy"), shown=False),
        Plot("Velocity of the frame", ("parabola.vx", "parabola.vy"), moving=True, shown=False),
        Plot("Rate of the coefficient", ("parabola.coefficient_rate",), moving=True, shown=False),
    ),
    readouts=(
        "slider.u",
        "slider.u_rate",
        "pendulum.angle",
        "pendulum.angular_velocity",
        "constraint.normal_force",
        "pendulum.tension",
        "energy.total",
        "energy.residual",
        "model.acceleration_error",
        "solver.steps",
    ),
)

SKETCH = Sketch(
    symbols={
        "slider.mass": "m₁",
        "pendulum.mass": "m₂",
        "pendulum.length": "r",
        "slider.u": "u",
        "pendulum.angle": "θ",
        "parabola.coefficient": "a",
    },
    masses={"slider": "slider.mass", "bob": "pendulum.mass"},
    lengths=(
        Length(FRAME, "slider", "slider.u", horizontal=True),
        Length("slider", "bob", "pendulum.length"),
    ),
    angles=(Angle("slider", "bob", "pendulum.angle"),),
    curve="y = a x²",
    values={"slider.u": 0.9, "pendulum.angle": 0.6},
)

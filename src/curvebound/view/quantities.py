"""What the variables of the FMUs are called in pictures, and which of them share a plot.

The units repeat those that the FMUs declare; a test compares the two.
"""

from __future__ import annotations

from dataclasses import dataclass

__all__ = ["PLOTS", "QUANTITIES", "READOUTS", "Plot", "Quantity", "quantity"]


@dataclass(frozen=True)
class Quantity:
    """One variable for the eye: its name in words, its unit, and whether it measures an error."""

    label: str
    unit: str = ""
    error: bool = False  # kept with constant relative accuracy, so that a logarithmic axis works
    full: str = ""  # the name where no title of a plot stands above it

    @property
    def name(self) -> str:
        """The name that needs no title to be understood."""
        return self.full or self.label


@dataclass(frozen=True)
class Plot:
    """Variables of one unit that share axes.

    `moving` plots are dropped where every variable is constant; those not `shown` are offered only.
    """

    title: str
    names: tuple[str, ...]
    moving: bool = False
    shown: bool = True


def _plane(name: str, label: str, unit: str) -> dict[str, Quantity]:
    """The two components of a vector, `name` with a place for the axis."""
    return {name.format(axis): Quantity(f"{label} {axis}", unit) for axis in ("x", "y")}


QUANTITIES: dict[str, Quantity] = {
    "bead.angle": Quantity("angle", "rad"),
    "bead.angular_velocity": Quantity("angular velocity", "rad/s"),
    **_plane("bead.{}", "bead", "m"),
    **_plane("bead.v{}", "bead velocity", "m/s"),
    **_plane("bead.f{}", "force on the bead", "N"),
    **_plane("wire.{}", "wire centre", "m"),
    **_plane("wire.v{}", "wire velocity", "m/s"),
    **_plane("wire.a{}", "wire acceleration", "m/s2"),
    **_plane("wire.f{}", "force on the wire", "N"),
    "constraint.multiplier": Quantity("multiplier", "N/m"),
    "constraint.force": Quantity("constraint force", "N"),
    "constraint.drift": Quantity("drift", "m", error=True, full="constraint drift"),
    "slider.u": Quantity("slider u", "m"),
    "slider.u_rate": Quantity("slider rate", "m/s"),
    **_plane("slider.{}", "slider", "m"),
    **_plane("slider.v{}", "slider velocity", "m/s"),
    **_plane("slider.f{}", "force on the slider", "N"),
    "pendulum.angle": Quantity("angle", "rad", full="pendulum angle"),
    "pendulum.angular_velocity": Quantity("angular velocity", "rad/s", full="pendulum rate"),
    **_plane("pendulum.{}", "bob", "m"),
    **_plane("pendulum.v{}", "bob velocity", "m/s"),
    **_plane("pendulum.f{}", "force on the bob", "N"),
    "pendulum.tension": Quantity("rod tension", "N"),
    **_plane("parabola.{}", "vertex", "m"),
    **_plane("parabola.v{}", "vertex velocity", "m/s"),
    **_plane("parabola.a{}", "vertex acceleration", "m/s2"),
    **_plane("parabola.f{}", "force on the parabola", "N"),
    "parabola.coefficient": Quantity("coefficient", "1/m"),
    "parabola.coefficient_rate": Quantity("coefficient rate", "1/(m.s)"),
    "parabola.coefficient_acceleration": Quantity("coefficient acceleration", "1/(m.s2)"),
    "constraint.normal_force": Quantity("normal force", "N"),
    "model.acceleration_error": Quantity("acceleration error", "1", error=True),
    "energy.kinetic": Quantity("kinetic", "J", full="kinetic energy"),
    "energy.potential": Quantity("potential", "J", full="potential energy"),
    "energy.total": Quantity("total", "J", full="total energy"),
    "energy.residual": Quantity("residual", "J", error=True, full="energy residual"),
    "solver.steps": Quantity("steps", "", full="solver steps"),
    "solver.evaluations": Quantity("evaluations", "", full="solver evaluations"),
}

# In the order in which they are shown.
PLOTS: tuple[Plot, ...] = (
    Plot("Angle", ("bead.angle", "pendulum.angle")),
    Plot("Slider on the parabola", ("slider.u",)),
    Plot("Energy", ("energy.kinetic", "energy.potential", "energy.total")),
    Plot("Energy residual", ("energy.residual",)),
    Plot("Constraint drift", ("constraint.drift",)),
    Plot("Error of the linear model", ("model.acceleration_error",), moving=True),
    Plot("Constraint force", ("constraint.force",)),
    Plot("Normal force and rod tension", ("constraint.normal_force", "pendulum.tension")),
    Plot("Force on the wire", ("wire.fx", "wire.fy")),
    Plot("Force on the parabola", ("parabola.fx", "parabola.fy")),
    Plot("Drive", ("wire.ax", "wire.ay", "parabola.ax", "parabola.ay"), moving=True),
    Plot("Drive of the coefficient", ("parabola.coefficient_acceleration",), moving=True),
    Plot("Coefficient of the parabola", ("parabola.coefficient",), moving=True),
    Plot("Motion of the frame", ("wire.x", "wire.y", "parabola.x", "parabola.y"), moving=True),
    Plot(
        "External force",
        ("bead.fx", "bead.fy", "slider.fx", "slider.fy", "pendulum.fx", "pendulum.fy"),
        moving=True,
    ),
    Plot("Angular velocity", ("bead.angular_velocity", "pendulum.angular_velocity"), shown=False),
    Plot("Rate of the slider", ("slider.u_rate",), shown=False),
    Plot("Position", ("bead.x", "bead.y", "slider.x", "slider.y", "pendulum.x", "pendulum.y"),
         shown=False),
    Plot("Velocity", ("bead.vx", "bead.vy", "slider.vx", "slider.vy", "pendulum.vx", "pendulum.vy"),
         shown=False),
    Plot("Velocity of the frame", ("wire.vx", "wire.vy", "parabola.vx", "parabola.vy"),
         moving=True, shown=False),
    Plot("Rate of the coefficient", ("parabola.coefficient_rate",), moving=True, shown=False),
    Plot("Multiplier", ("constraint.multiplier",), shown=False),
    Plot("Work of the solver", ("solver.steps", "solver.evaluations"), shown=False),
)  # fmt: skip

# What the panel beside the drawing tells of each body.
READOUTS: tuple[str, ...] = (
    "bead.angle",
    "bead.angular_velocity",
    "bead.x",
    "bead.y",
    "slider.u",
    "slider.u_rate",
    "pendulum.angle",
    "pendulum.angular_velocity",
    "constraint.force",
    "constraint.normal_force",
    "pendulum.tension",
    "energy.total",
    "energy.residual",
    "constraint.drift",
    "model.acceleration_error",
    "solver.steps",
)


def quantity(variable: str) -> Quantity:
    """The quantity behind `variable`, a name without its component; an unknown one names itself."""
    return QUANTITIES.get(variable, Quantity(variable))

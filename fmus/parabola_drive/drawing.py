"""What to plot of the drive: the accelerations that it asks for."""

from curvebound.fmi.drawing import Drawing, Plot, plane

DRAWING = Drawing(
    words={
        **plane("parabola.a{}", "vertex acceleration"),
        "parabola.coefficient_acceleration": "coefficient acceleration",
    },
    plots=(
        Plot("Drive", ("parabola.ax", "parabola.ay"), moving=True),
        Plot("Drive of the coefficient", ("parabola.coefficient_acceleration",), moving=True),
    ),
)

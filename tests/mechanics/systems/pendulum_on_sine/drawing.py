from curvebound.fmi.drawing import Curve, Drawing, Point, Rod

DRAWING = Drawing(
    frame=("wire.x", "wire.y"),
    points=(Point("pivot", "pivot.x", "pivot.y"), Point("bob", "bob.x", "bob.y")),
    rods=(Rod("pivot", "bob"),),
    curves=(
        Curve("wire.x + s", "wire.y + wire.amplitude * sin(wire.wavenumber * s)", holds="pivot"),
    ),
)

from curvebound.fmi.drawing import Curve, Drawing, Point

DRAWING = Drawing(
    points=(Point("bead", "bead.x", "bead.y"),),
    curves=(Curve("s", "wire.coefficient * s**2", holds="bead"),),
)

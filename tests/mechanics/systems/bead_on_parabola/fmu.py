from curvebound.fmi.declaration import Fmu, parameter

FMU = Fmu(
    "BeadOnParabola",
    "A bead on a wire bent as y = a x^2",
    (
        parameter("wire.coefficient", "1/m", 0.5, "coefficient a of y = a x^2"),
        parameter("bead.u_start", "m", 1.0, "initial abscissa"),
    ),
)

from curvebound.fmi.declaration import Fmu, output, parameter
from curvebound.fmi.ranges import Range

FMU = Fmu(
    "PendulumOnSine",
    "A pendulum whose pivot slides along a wire bent as y = b sin(k x)",
    (
        parameter("wire.amplitude", "m", 0.3, "amplitude b of the wire"),
        parameter("wire.wavenumber", "1/m", 2.0, "wave number k of the wire"),
        parameter("rod.length", "m", 1.0, "length of the rod (above zero)", above=0.0),
        parameter("rod.angle_start", "rad", 0.5, "initial angle"),
        output("rod.tension", "N", "force in the rod, positive in tension"),
    ),
    ranges={"wire.amplitude": Range(1e-2, 10.0), "wire.wavenumber": Range(1e-2, 10.0)},
)

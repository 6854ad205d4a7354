"""A bead slides on a circular wire, from the horizontal, without friction.

The Cartesian form with a Lagrange multiplier, integrated by RK4 and projected back onto the wire.
The energy stays, the drift is at rounding level; with constraint.stabilization=none it is not (try
it with a solver.step of 1/60).
"""

import math

from curvebound.cosim import Scene

scene = Scene(
    "bead_on_wire",
    "a bead on a circular wire, Cartesian with multiplier, RK4",
    stop_time=10.0,
    step=0.01,
    needs={"bead.bead.x": 1e-6, "bead.bead.y": 1e-6},
    lesson=1,
)
scene.add(
    "bead",
    "BeadOnWire",
    {
        "model.formulation": "lagrange_multiplier",
        "constraint.stabilization": "projection",
        "solver.method": "rk4",
        "bead.angle_start": 0.5 * math.pi,
    },
)
scene.record("bead.bead.*", "bead.constraint.*", "bead.energy.*", "bead.solver.*")

if __name__ == "__main__":
    scene.main()

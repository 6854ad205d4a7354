"""One drive shakes two beads that differ in formulation only: what parts them is their error.

The minimal coordinate against the Cartesian form without stabilisation, both by RK4 at the same
step: the Cartesian bead leaves its wire (constraint.drift) and its partner. Two steps per
communication step keep them within the need; with one (variant `coarse`) they part by centimetres.
"""

import math

from curvebound.cosim import Scene

STEP = 1.0 / 60.0  # s
FREQUENCY = 0.3  # Hz

scene = Scene(
    "two_wires",
    "one drive shakes two beads of different formulation",
    stop_time=60.0,
    step=STEP,
    needs={"bead_angle.bead.x": 1e-3, "bead_angle.bead.y": 1e-3},
    lesson=8,
)
scene.add(
    "drive",
    "ParabolaDrive",
    {
        "waveform.kind": "sine",
        "waveform.amplitude": 2.0,
        "waveform.frequency": FREQUENCY,
        # a cosine, half a step ahead as each value is held: the wires go to and fro
        "waveform.phase": 0.5 * math.pi + math.pi * FREQUENCY * STEP,
    },
)
SOLVER = {"solver.method": "rk4", "solver.step": STEP / 2.0}
scene.add("bead_angle", "BeadOnWire", {"model.formulation": "angle", **SOLVER})
scene.add(
    "bead_cartesian",
    "BeadOnWire",
    {
        "model.formulation": "lagrange_multiplier",
        "constraint.stabilization": "none",
        **SOLVER,
    },
)
for bead in ("bead_angle", "bead_cartesian"):
    scene.connect("drive.parabola.ax", f"{bead}.wire.ax")
    scene.connect("drive.parabola.ay", f"{bead}.wire.ay")
    scene.record(f"{bead}.bead.*", f"{bead}.wire.x", f"{bead}.wire.y")
    scene.record(f"{bead}.constraint.force", f"{bead}.energy.residual")
scene.record("bead_cartesian.constraint.drift")
scene.variant("coarse", {f"{bead}.solver.step": STEP for bead in ("bead_angle", "bead_cartesian")})

if __name__ == "__main__":
    scene.main()

"""The parabola is swayed sideways near the pendulum's slow mode, by a drive FMU coupled to it.

The drive measures and acts at every communication point. It comes first: its outputs follow its
inputs directly, so that the loop has no delay. The waveform's phase is a cosine's, so that the
parabola sways about a point, and half a step ahead, as each value is held over the step.
"""

import math

from curvebound.cosim import Scene

STEP = 0.01  # s
FREQUENCY = 0.35  # Hz; the slow mode is at 0.38 Hz

scene = Scene(
    "swaying_parabola",
    "a drive FMU sways the parabola under slider and pendulum",
    stop_time=20.0,
    step=STEP,
    needs={"plant.slider.u": 1e-3, "plant.pendulum.angle": 1e-3},
    lesson=5,
)
scene.add(
    "drive",
    "ParabolaDrive",
    {
        "waveform.kind": "sine",
        "waveform.axis": "x",
        "waveform.amplitude": 0.5,
        "waveform.frequency": FREQUENCY,
        "waveform.phase": 0.5 * math.pi + math.pi * FREQUENCY * STEP,
    },
)
scene.add("plant", "ParabolaPendulum", {"slider.u_start": 0.0, "pendulum.angle_start": 0.0})
scene.connect_matching("drive", "plant")
scene.connect_matching("plant", "drive")
scene.record(
    "plant.slider.u",
    "plant.pendulum.angle",
    "plant.slider.x",
    "plant.slider.y",
    "plant.pendulum.x",
    "plant.pendulum.y",
    "plant.parabola.x",
    "plant.energy.residual",
)

if __name__ == "__main__":
    scene.main()

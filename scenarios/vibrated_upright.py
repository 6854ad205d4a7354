"""Fast vertical vibration of the parabola holds the pendulum upright, without any feedback.

With the slider heavy the pivot stays in place, and a vibration of amplitude A and angular frequency
W holds the bob up when A W exceeds sqrt(2 g r) = 4.43 m/s (Stephenson 1908; Kapitza 1951). Here it
is 1.3 times that at 20 Hz; the variant `below` vibrates at 0.8 times that, and the bob falls.
"""

import math

from curvebound.cosim import Scene

STEP = 0.001  # s, 50 to a period
FREQUENCY = 20.0  # Hz
OMEGA = 2.0 * math.pi * FREQUENCY
THRESHOLD = math.sqrt(2.0 * 9.81 * 1.0)  # m/s

scene = Scene(
    "vibrated_upright",
    "fast vertical vibration alone holds the pendulum upright",
    stop_time=10.0,
    step=STEP,
    record_every=5,
    needs={"plant.pendulum.angle": 1e-2},
    lesson=7,
)
scene.add(
    "drive",
    "ParabolaDrive",
    {
        "waveform.kind": "sine",
        "waveform.axis": "y",
        "waveform.amplitude": 1.3 * THRESHOLD * OMEGA,
        "waveform.frequency": FREQUENCY,
        # a cosine, half a step ahead as each value is held: the parabola rises and falls about 0
        "waveform.phase": 0.5 * math.pi + math.pi * FREQUENCY * STEP,
    },
)
scene.add(
    "plant",
    "ParabolaPendulum",
    {"slider.mass": 100.0, "slider.u_start": 0.0, "pendulum.angle_start": math.pi - 0.1},
)
scene.connect("drive.parabola.ay", "plant.parabola.ay")
scene.record("plant.slider.*", "plant.pendulum.*", "plant.parabola.*", "plant.energy.*")
scene.record("plant.constraint.normal_force")
scene.variant("below", {"drive.waveform.amplitude": 0.8 * THRESHOLD * OMEGA})

if __name__ == "__main__":
    scene.main()

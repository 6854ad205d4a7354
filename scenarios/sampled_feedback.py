"""The balancing loop, measured and corrected only so often: from smooth to lost.

The gains are those of continuous feedback. Sampled every 0.02 s the loop hardly differs from it,
at 0.1 s it swings, and between 0.20 and 0.21 s the closed loop loses its stability: each variant
is the same scene with another drive.sample.period. Run them together with --variants.
"""

import math

from curvebound.cosim import Scene

scene = Scene(
    "sampled_feedback",
    "the balancing loop at several sample periods, up to the one that loses it",
    stop_time=10.0,
    step=0.01,
    needs={"plant.slider.u": 1e-3, "plant.pendulum.angle": 1e-3},
    lesson=11,
)
scene.add(
    "drive",
    "ParabolaDrive",
    {
        "feedback.slider_u": -55.3053,
        "feedback.slider_u_rate": -12.8888,
        "feedback.pendulum_angle": 87.7991,
        "feedback.pendulum_angular_velocity": 23.0244,
        "feedback.parabola_x": -1.0,
        "feedback.parabola_vx": -2.3716,
        "reference.pendulum_angle": math.pi,
        "sample.period": 0.02,
        "limit.acceleration": 100.0,
    },
)
scene.add(
    "plant",
    "ParabolaPendulum",
    {"slider.u_start": 0.0, "pendulum.angle_start": math.pi - 0.02},
)
scene.connect_matching("drive", "plant")
scene.connect_matching("plant", "drive")
scene.record("plant.slider.*", "plant.pendulum.*", "plant.parabola.*", "plant.energy.*")
scene.record("plant.constraint.normal_force", "drive.parabola.ax")
for period in (0.1, 0.2, 0.22):
    scene.variant(f"{period:g} s", {"drive.sample.period": period})

if __name__ == "__main__":
    scene.main()

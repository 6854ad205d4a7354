"""Feedback holds the pendulum upright, and catches it after a push.

The gains come from the linear model about the upright position (curvebound.study.regulator). At 5 s
a force of 4 N pushes the bob for 0.2 s: a scene input, a table with jumps.
"""

import math

from curvebound.cosim import Scene

scene = Scene(
    "inverted_balance",
    "feedback balances the pendulum upright against a push",
    stop_time=20.0,
    step=0.01,
    needs={"plant.slider.u": 1e-2, "plant.pendulum.angle": 1e-2},
    lesson=10,
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
    },
)
scene.add(
    "plant",
    "ParabolaPendulum",
    {"slider.u_start": 0.0, "pendulum.angle_start": math.pi - 0.1},
)
scene.connect_matching("drive", "plant")
scene.connect_matching("plant", "drive")
scene.input("plant.pendulum.fx", ([0.0, 5.0, 5.0, 5.2, 5.2], [0.0, 0.0, 4.0, 4.0, 0.0]))
scene.record("plant.slider.*", "plant.pendulum.*", "plant.parabola.*", "plant.energy.*")
scene.record("plant.constraint.normal_force", "drive.parabola.ax")

if __name__ == "__main__":
    scene.main()

"""Feedback to the parabola's acceleration brings slider, pendulum and parabola to rest.

The gains minimise a quadratic cost of the linear model (continuous Riccati equation, solved by
curvebound.study.regulator); the plant is the full model. Undamped, it would swing for ever; here
all six states go to zero in about 10 s.
"""

from curvebound.cosim import Scene

scene = Scene(
    "active_damping",
    "state feedback brings pendulum and parabola to rest",
    stop_time=20.0,
    step=0.01,
    needs={"plant.slider.u": 1e-2, "plant.pendulum.angle": 1e-2},
    lesson=9,
)
scene.add(
    "drive",
    "ParabolaDrive",
    {
        "feedback.slider_u": -3.8619,
        "feedback.slider_u_rate": -1.5254,
        "feedback.pendulum_angle": 0.8948,
        "feedback.pendulum_angular_velocity": -0.0051,
        "feedback.parabola_x": 1.0,
        "feedback.parabola_vx": 1.8987,
    },
)
scene.add("plant", "ParabolaPendulum", {"slider.u_start": 0.5, "pendulum.angle_start": 0.5})
scene.connect_matching("drive", "plant")
scene.connect_matching("plant", "drive")
scene.record("plant.slider.*", "plant.pendulum.*", "plant.parabola.*", "plant.energy.*")
scene.record("plant.constraint.normal_force", "drive.parabola.ax")

if __name__ == "__main__":
    scene.main()

"""Feedback to the parabola's acceleration brings slider, pendulum and parabola to rest.

The gains minimise a quadratic cost of the linear model (continuous Riccati equation); the plant is
the full model. Undamped, it would swing for ever; here all six states go to zero in about 10 s.
"""

from curvebound.cosim import Scene
from curvebound.study.regulator import gains

scene = Scene(
    "active_damping",
    "state feedback brings pendulum and parabola to rest",
    stop_time=20.0,
    step=0.01,
    needs={"plant.slider.u": 1e-2, "plant.pendulum.angle": 1e-2},
)
scene.add("drive", "ParabolaDrive", gains())
scene.add("plant", "ParabolaPendulum", {"slider.u_start": 0.5, "pendulum.angle_start": 0.5})
scene.connect_matching("drive", "plant")
scene.connect_matching("plant", "drive")
scene.record("plant.slider.*", "plant.pendulum.*", "plant.parabola.*", "plant.energy.*")
scene.record("drive.parabola.ax")

if __name__ == "__main__":
    scene.main()

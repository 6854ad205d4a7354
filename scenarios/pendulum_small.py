"""A pendulum hung from a mass on a parabola, in the linear model.

The quadratic part of the Lagrangian about rest: a sum of two normal modes. At each moment
model.acceleration_error tells how far the linear model is from the full one; solver.method=exact
makes the run free of integration error.
"""

from curvebound.cosim import Scene

scene = Scene(
    "pendulum_small",
    "a pendulum on a parabola, linear model",
    stop_time=10.0,
    step=0.01,
    needs={"plant.slider.u": 1e-6, "plant.pendulum.angle": 1e-6},
    lesson=2,
)
scene.add(
    "plant",
    "ParabolaPendulum",
    {
        "model.fidelity": "linear",
        "solver.method": "rk4",
        "slider.u_start": 0.5,
        "pendulum.angle_start": 0.5,
    },
)
scene.record("plant.slider.*", "plant.pendulum.*", "plant.energy.*", "plant.model.*")
scene.record("plant.parabola.coefficient", "plant.constraint.normal_force")

if __name__ == "__main__":
    scene.main()

"""A pendulum hung from a mass on a parabola, in the full model, started high: chaotic.

The slider starts far up and the bob nearly upright, so that the linear model is of no use, and the
distance of neighbouring starts grows a millionfold within 20 s (some 27 times within these 10 s): a
hard case for every method, judged by its energy.
"""

from curvebound.cosim import Scene

scene = Scene(
    "pendulum_large",
    "a pendulum on a parabola, full model, started high",
    stop_time=10.0,
    step=0.01,
    needs={"plant.slider.u": 1e-3, "plant.pendulum.angle": 1e-3},
    lesson=3,
)
scene.add(
    "plant",
    "ParabolaPendulum",
    {
        "model.fidelity": "nonlinear",
        "solver.method": "adaptive",
        "solver.tolerance": 1e-9,
        "slider.u_start": 1.5,
        "pendulum.angle_start": 2.8,
    },
)
scene.record("plant.slider.*", "plant.pendulum.*", "plant.energy.*", "plant.constraint.*")
scene.record("plant.parabola.coefficient")

if __name__ == "__main__":
    scene.main()

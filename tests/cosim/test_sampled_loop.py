"""Drive and plant coupled, against the same sampled loop integrated in one piece by scipy."""

from __future__ import annotations

import math

import numpy as np
import pytest
from scipy.integrate import solve_ivp

from curvebound.cosim import Adaptive, load_scene

G = 9.81
PLANT = {
    "slider_u": "plant.slider.u",
    "slider_u_rate": "plant.slider.u_rate",
    "pendulum_angle": "plant.pendulum.angle",
    "pendulum_angular_velocity": "plant.pendulum.angular_velocity",
    "parabola_x": "plant.parabola.x",
    "parabola_vx": "plant.parabola.vx",
}
OUTPUTS = list(PLANT.values())
GAIN = np.array(
    [load_scene("active_damping").components["drive"].start[f"feedback.{n}"] for n in PLANT]
)
START = np.array([0.5, 0.0, 0.5, 0.0, 0.0, 0.0])


def motion(state, push):
    """Time derivative of the full model at the default parameters, for vertex acceleration push.

    From the Lagrangian's two equations with a = 1/2, m1 = m2 = r = 1, solved as they stand.
    """
    u, v, th, w, _, x_rate = state
    q, s, c = u, math.sin(th), math.cos(th)
    mass = np.array([[2.0 * (1.0 + q * q), c + q * s], [c + q * s, 1.0]])
    right = np.array(
        [
            -2.0 * (push + q * G + u * v * v) - w * w * (q * c - s),
            -(G * s + push * c + s * v * v),
        ]
    )
    du, dth = np.linalg.solve(mass, right)
    return np.array([v, du, w, dth, x_rate, push])


def sampled(gain, step, count):
    """States at n * step of the loop that holds push = -gain . state over each step."""
    states = [START]
    for _ in range(count):
        push = -float(gain @ states[-1])
        solution = solve_ivp(
            lambda _, y, p=push: motion(y, p), (0.0, step), states[-1],
            method="DOP853", rtol=1e-12, atol=1e-13,
        )  # fmt: skip
        states.append(solution.y[:, -1])
    return np.array(states)


@pytest.fixture(scope="module")
def damping():
    scene = load_scene("active_damping")
    scene.recorded.clear()
    scene.record(*OUTPUTS)
    scene.set("plant.solver.method", "adaptive").set("plant.solver.tolerance", 1e-12)
    return scene


@pytest.mark.parametrize("step", [0.01, 0.05])
def test_gauss_seidel_is_the_sampled_loop(damping, step):
    count = round(2.0 / step)
    scene = damping.copy()
    scene.step, scene.stop_time = step, 2.0
    result = scene.run()
    expected = sampled(GAIN, step, count)
    for i, name in enumerate(OUTPUTS):
        assert np.max(np.abs(result[name] - expected[:, i])) < 1e-9


def test_a_sample_period_of_some_steps_is_a_sampled_loop_too(damping):
    scene = damping.copy()
    scene.step, scene.stop_time = 0.01, 4.0
    scene.set("drive.sample.period", 0.1)
    result = scene.run()
    expected = sampled(GAIN, 0.1, 40)
    for i, name in enumerate(OUTPUTS):
        assert np.max(np.abs(result[name][::10] - expected[:, i])) < 1e-9


def test_jacobi_gives_the_same_where_one_component_has_no_state(damping):
    """The drive acts by direct feedthrough alone, so that both algorithms evaluate one loop."""
    scene = damping.copy()
    scene.stop_time = 2.0
    first = scene.run()
    scene.algorithm = "jacobi"
    assert np.array_equal(first.data, scene.run().data)


def test_adaptive_steps_follow_the_continuous_loop(damping):
    """Error proportional to the tolerance, and fewer steps than the fixed step of equal error."""
    gain = GAIN
    exact = solve_ivp(
        lambda _, y: motion(y, -float(gain @ y)), (0.0, 20.0), START,
        method="DOP853", rtol=1e-11, atol=1e-12, dense_output=True,
    ).sol  # fmt: skip

    def error(result):
        states = exact(result.time)
        return max(float(np.max(np.abs(result[n] - states[i]))) for i, n in enumerate(OUTPUTS))

    scene = damping.copy()
    scene.step = 0.01
    fixed = error(scene.run()) / scene.step  # first order: error per second of step
    tolerances = [0.1, 0.03, 0.01, 0.003]
    errors = []
    for tolerance in tolerances:
        scene.adaptive = Adaptive(tolerance=tolerance)
        result = scene.run()
        errors.append(error(result))
        equal = 20.0 * fixed / errors[-1]  # steps of the fixed step of equal error
        if tolerance < 0.1:
            assert result.steps < equal / 2.0
            assert result.trials < equal / 1.3
    assert np.polyfit(np.log(tolerances), np.log(errors), 1)[0] > 0.8

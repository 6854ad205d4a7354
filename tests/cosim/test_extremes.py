"""Stiff coupling and slow feedback: amplification per macro step, in closed form and measured."""

from __future__ import annotations

import math

import numpy as np
import pytest
from amplification import jacobi_radius, masses, radius, sampled

from curvebound.cosim import RunFailed, Scene, load_scene
from curvebound.cosim.scene_parts import ALGORITHMS

STARTS = ("one.x_start", "one.v_start", "two.x_start", "two.v_start")
STATE = ("one.x", "one.v", "two.x", "two.v")
H = 0.1
#: coupling stiffness (N/m): soft, H sqrt(kc) = 1, and stiffer than any macro step of H resolves
COUPLING = (1.0, 100.0, 350.0, 2.5e3, 1e6)
PLANT = (
    "slider.u", "slider.u_rate", "pendulum.angle", "pendulum.angular_velocity",
    "parabola.x", "parabola.vx",
)  # fmt: skip


@pytest.fixture(scope="module")
def prepared(request, mass_fmu):
    """The two masses made ready, by algorithm."""
    ready = {}
    for algorithm in ALGORITHMS:
        scene = Scene("loop", stop_time=1.0, step=H, algorithm=algorithm)
        scene.add("one", mass_fmu, {"k": 10.0, "kc": 1.0})
        scene.add("two", mass_fmu, {"k": 1000.0, "kc": 1.0})
        scene.connect("one.x", "two.other").connect("two.x", "one.other")
        ready[algorithm] = scene.record(*STATE).prepare()
    yield ready
    for one in ready.values():
        one.close()


def run(prepared, kc, start, steps, k=None):
    values = {"one.kc": kc, "two.kc": kc, **dict(zip(STARTS, start, strict=True))}
    if k is not None:
        values |= {"one.k": k, "two.k": k}
    result = prepared.run(values, stop_time=steps * H)
    return np.stack([result[name] for name in STATE], axis=1)


@pytest.mark.parametrize("algorithm", ALGORITHMS)
@pytest.mark.parametrize("kc", COUPLING)
def test_a_macro_step_is_its_matrix(prepared, algorithm, kc) -> None:
    measured = np.stack([run(prepared[algorithm], kc, e, 1)[1] for e in np.eye(4)], axis=1)
    expected = masses(algorithm, (10.0, 1000.0), kc, H)
    scale = np.array([1.0, math.sqrt(1000.0 + kc)] * 2)  # v beside x
    difference = (measured - expected) / scale[:, None] * scale
    assert np.abs(difference).max() < 1e-12 * np.abs(expected / scale[:, None] * scale).max()


@pytest.mark.parametrize("algorithm", ALGORITHMS)
@pytest.mark.parametrize("kc", COUPLING)
def test_growth_over_many_steps_is_the_spectral_radius(prepared, algorithm, kc) -> None:
    """Per step, over the second half of 400 steps, whether the algorithm is stable there or not."""
    states = run(prepared[algorithm], kc, (1.0, 0.0, -0.3, 0.0), 400)
    size = np.hypot(states, 0.0) / np.array([1.0, math.sqrt(1000.0 + kc)] * 2)
    largest = [float(size[a : a + 100].max()) for a in (100, 300)]
    measured = (largest[1] / largest[0]) ** (1.0 / 200.0)
    expected = radius(masses(algorithm, (10.0, 1000.0), kc, H))
    # nothing damps, and no algorithm may, but for midpoint, which conserves nothing
    assert expected > 1.0 - 1e-9 or algorithm == "midpoint"
    # powers of a matrix that is not normal vary about those of its radius
    assert math.log(measured) == pytest.approx(math.log(expected), abs=1.5e-3)


@pytest.mark.parametrize("kc", COUPLING)
def test_jacobi_amplifies_any_coupling(prepared, kc) -> None:
    """Closed form for equal masses: more than one at any macro step, sqrt(1 + p (1 - cos))."""
    expected = jacobi_radius(100.0, kc, H)
    assert expected == pytest.approx(radius(masses("jacobi", (100.0, 100.0), kc, H)), rel=1e-12)
    assert expected > 1.0
    states = run(prepared["jacobi"], kc, (1.0, 0.0, -1.0, 0.0), 200, k=100.0)
    size = np.abs(states[:, 0])
    measured = (size[150:].max() / size[50:100].max()) ** 0.01
    assert math.log(measured) == pytest.approx(math.log(expected), rel=0.1, abs=2e-3)


def test_where_gauss_seidel_and_strang_end() -> None:
    """Both multiply volumes by one: they are stable up to a coupling, and beyond it in bands."""
    for algorithm in ("gauss_seidel", "strang"):
        for kc in (1.0, 100.0):
            matrix = masses(algorithm, (10.0, 1000.0), kc, H)
            assert np.linalg.det(matrix) == pytest.approx(1.0, abs=1e-12)
            assert radius(matrix) == pytest.approx(1.0, abs=1e-9)
    # strang is gauss_seidel seen from the middle of a step: the same radius
    for kc in COUPLING:
        pair = [radius(masses(a, (10.0, 1000.0), kc, H)) for a in ("gauss_seidel", "strang")]
        assert pair[0] == pytest.approx(pair[1], rel=1e-6)


# feedback at long sample periods


@pytest.fixture(scope="module")
def loop():
    scene = load_scene("active_damping")
    scene.recorded.clear()
    scene.record(*(f"plant.{name}" for name in PLANT))
    scene.set("plant.model.fidelity", "linear").set("plant.solver.method", "exact")
    scene.set("drive.limit.acceleration", 1e300)  # or the drive would end the growth
    with scene.prepare() as ready:
        yield ready


@pytest.fixture(scope="module")
def gain():
    start = load_scene("active_damping").components["drive"].start
    return np.array([start[f"feedback.{name.replace('.', '_')}"] for name in PLANT])


@pytest.fixture(scope="module")
def last_stable(gain) -> float:
    """The sample period (s) at which the sampled loop loses its stability."""
    low, high = 0.01, 2.0
    assert radius(sampled(gain, low)) < 1.0 < radius(sampled(gain, high))
    periods = np.linspace(low, high, 100)
    high = next(h for h in periods if radius(sampled(gain, h)) > 1.0)
    low = high - (periods[1] - periods[0])
    for _ in range(20):
        middle = 0.5 * (low + high)
        low, high = (middle, high) if radius(sampled(gain, middle)) < 1.0 else (low, middle)
    return low


@pytest.mark.parametrize("share", [0.3, 0.9, 1.1, 2.0])
def test_slow_feedback_grows_as_the_sampled_loop_does(loop, gain, last_stable, share) -> None:
    """Macro step for sample period, below and above the end of stability."""
    h = share * last_stable
    matrix = sampled(gain, h)
    result = loop.run(stop_time=60.0 * h, step=h)
    states = np.stack([result[f"plant.{name}"] for name in PLANT], axis=1)
    expected = [states[0]]
    for _ in range(len(states) - 1):
        expected.append(matrix @ expected[-1])
    largest = np.maximum.accumulate(np.abs(expected).max(axis=1))
    assert np.all(np.abs(states - expected).max(axis=1) < 1e-9 * largest)
    assert (np.abs(states[-1]).max() < np.abs(states[0]).max()) == (share < 1.0)


def test_holding_in_the_drive_is_as_slow_feedback(loop, gain, last_stable) -> None:
    """sample.period on small macro steps ends at the same period."""
    for share in (0.9, 1.2):
        h = round(share * last_stable, 2)
        result = loop.run({"drive.sample.period": h}, stop_time=60.0 * h, step=0.01)
        angle = np.abs(result["plant.pendulum.angle"])
        grows = angle[-len(angle) // 6 :].max() > angle[: len(angle) // 6].max()
        assert grows == (radius(sampled(gain, h)) > 1.0) == (share > 1.0)


def test_far_too_slow_feedback_of_the_full_model_is_finite_or_says_so() -> None:
    """Where the linear loop has long since grown beyond sense, nothing hangs and nothing is NaN."""
    scene = load_scene("active_damping").copy()
    scene.stop_time = 200.0
    for h in (0.5, 2.0, 10.0):
        scene.step = h
        failure = None
        try:
            result = scene.run()
        except RunFailed as error:
            failure, result = error, error.result
        assert failure is None or (failure.component == "plant" and failure.cause)
        assert all(np.all(np.isfinite(result[name])) for name in result.names)

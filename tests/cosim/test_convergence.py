"""Orders and invariants of the algorithms on two coupled masses whose motion is known."""

from __future__ import annotations

import math

import numpy as np
import pytest

from curvebound.cosim import Scene
from curvebound.cosim.scene_parts import ALGORITHMS
from curvebound.errors import CurveboundError

TWO_PI = 2.0 * math.pi
#: largest errors at H = 0.04 and 1/1600, as measured: a change of either is one of the algorithm
ERRORS = {
    "jacobi": (1.93, 2.47e-2),
    "gauss_seidel": (0.412, 6.54e-3),
    "strang": (5.29e-2, 1.296e-5),
    "midpoint": (6.46e-2, 1.288e-5),
}


def symmetric(two_masses, step, **settings):
    """u1,2 = (cos 2 pi t +- cos 6 pi t)/2 for m = 1, k = 4 pi^2, k12 = 16 pi^2, u = (1, 0)."""
    k = 4.0 * math.pi**2
    return two_masses((k, k), 16.0 * math.pi**2, (1.0, 0.0), (0.0, 0.0), 1.0, step, **settings)


def symmetric_error(result):
    t = result.time
    slow, fast = np.cos(TWO_PI * t), np.cos(3.0 * TWO_PI * t)
    return max(
        np.max(np.abs(result["one.x"] - 0.5 * (slow + fast))),
        np.max(np.abs(result["two.x"] - 0.5 * (slow - fast))),
    )


def stiff(two_masses, step, **settings):
    """Springs 10, 100 (coupling) and 1000 N/m, v = (100, -100) m/s, energy 10000 J."""
    return two_masses((10.0, 1000.0), 100.0, (0.0, 0.0), (100.0, -100.0), 10.0, step, **settings)


def stiff_error(result):
    return max(abs(result["one.x"][-1] + 4.46079749), abs(result["two.x"][-1] + 0.96493284))


def energy(result):
    x1, x2, v1, v2 = (result[name] for name in ("one.x", "two.x", "one.v", "two.v"))
    return 0.5 * (v1**2 + v2**2 + 10.0 * x1**2 + 1000.0 * x2**2 + 100.0 * (x1 - x2) ** 2)


@pytest.mark.parametrize("algorithm", ALGORITHMS)
def test_fitted_order(two_masses, algorithm):
    first, last = ERRORS[algorithm]
    steps = [1.0 / (25 * 2**i) for i in range(7)]
    errors = []
    for step in steps:
        result = symmetric(two_masses, step, algorithm=algorithm).run()
        assert result.steps == round(1.0 / step)
        errors.append(symmetric_error(result))
    asymptotic = slice(2, None)  # the coarsest two are no longer small errors for jacobi
    slope = np.polyfit(np.log(steps[asymptotic]), np.log(errors[asymptotic]), 1)[0]
    assert abs(slope - ALGORITHMS[algorithm].order) < 0.1, (slope, errors)
    assert errors[0] == pytest.approx(first, rel=0.02)
    assert errors[-1] == pytest.approx(last, rel=0.02)


def at_a_millisecond(two_masses, algorithm, found={}):  # noqa: B006
    """The stiff case, run once for all tests."""
    if algorithm not in found:
        found[algorithm] = stiff(two_masses, 1e-3, algorithm=algorithm).run()
    return found[algorithm]


def test_gauss_seidel_keeps_the_energy_and_jacobi_does_not(two_masses):
    kept, lost = (at_a_millisecond(two_masses, name) for name in ("gauss_seidel", "jacobi"))
    # The coupled map of Gauss-Seidel is conjugate to a symplectic one: its energy error stays.
    assert np.max(np.abs(energy(kept) - 10000.0)) < 1.0
    assert energy(kept)[-1] == pytest.approx(10000.0, abs=1e-6)
    assert energy(lost)[-1] > 10200.0


@pytest.mark.parametrize(
    ("algorithm", "bound"), [("gauss_seidel", 1e-3), ("jacobi", 0.3), ("strang", 1e-3)]
)
def test_stiff_case_reaches_its_reference(two_masses, algorithm, bound):
    result = at_a_millisecond(two_masses, algorithm)
    assert stiff_error(result) < bound
    if algorithm == "strang":
        coarser = stiff(two_masses, 2e-3, algorithm=algorithm).run()
        assert stiff_error(coarser) / stiff_error(result) == pytest.approx(4.0, rel=0.05)


def test_initial_point_is_recorded_and_times_are_multiples(two_masses):
    step = 1.0 / 60.0
    result = symmetric(two_masses, step).run()
    assert result["one.x"][0] == 1.0
    assert result["two.x"][0] == 0.0
    assert len(result.time) == 61
    assert np.array_equal(result.time[:-1], [n * step for n in range(60)])
    assert result.time[-1] == 1.0


def test_a_rest_is_stepped_too(two_masses):
    scene = symmetric(two_masses, 0.03)
    result = scene.run()
    assert result.steps == 34
    assert result.time[-2:] == pytest.approx([0.99, 1.0])
    exact = 0.5 * (math.cos(TWO_PI) + math.cos(3.0 * TWO_PI))
    assert abs(result["one.x"][-1] - exact) < 0.5


def test_order_given_reverses_the_roles(two_masses):
    forward = symmetric(two_masses, 0.01).run()
    backward = symmetric(two_masses, 0.01, order=["two", "one"]).run()
    # the mass that steps second sees the other's new position
    assert not np.array_equal(forward["one.x"], backward["one.x"])
    assert symmetric_error(backward) < 0.2


def test_record_every_keeps_the_last_point(two_masses):
    scene = symmetric(two_masses, 0.01, record_every=7)
    every = symmetric(two_masses, 0.01).run()
    result = scene.run()
    assert result.steps == 100
    assert list(result.time) == [*every.time[::7], 1.0]
    assert np.array_equal(result["one.x"][:-1], every["one.x"][::7])
    assert result["one.x"][-1] == every["one.x"][-1]


def test_prepared_runs_repeat_and_vary(two_masses):
    scene = symmetric(two_masses, 0.01)
    once = scene.run()
    with scene.prepare() as prepared:
        first = prepared.run()
        other = prepared.run({"one.x_start": 0.0, "two.x_start": 1.0})
        again = prepared.run()
        short = prepared.run(stop_time=0.5, step=0.005)
    assert np.array_equal(first.data, once.data)
    assert np.array_equal(again.data, once.data)
    assert other["one.x"][0] == 0.0
    assert other["two.x"][0] == 1.0
    assert short.steps == 100
    assert short.time[-1] == 0.5


def test_prepared_runs_refuse_what_makes_no_sense(two_masses):
    with two_masses((1.0, 1.0), 1.0, (1.0, 0.0), (0.0, 0.0), 1.0, 0.1).prepare() as prepared:
        with pytest.raises(CurveboundError, match=r"one\.kd .*did you mean one\.k"):
            prepared.run({"one.kd": 1.0})
        with pytest.raises(CurveboundError, match=r"stop_time is -1.0 s; give one after"):
            prepared.run(stop_time=-1.0)
        with pytest.raises(CurveboundError, match=r"step is 0.0 s; .*above zero"):
            prepared.run(step=0.0)


def test_strang_is_of_second_order_in_scene_inputs_too(mass_fmu):
    """x'' = -2 x + sin 3 t from rest, in either group: inputs at t, t + H/2 and t + H."""
    w = math.sqrt(2.0)
    errors = {"one": [], "two": []}
    steps = [0.1, 0.05, 0.025, 0.0125]
    for step in steps:
        scene = Scene(
            "driven", stop_time=4.0, step=step, algorithm="strang", groups=(["one"], ["two"])
        )
        for name in errors:
            scene.add(name, mass_fmu, {"k": 1.0, "kc": 1.0})
            scene.input(f"{name}.other", lambda t: math.sin(3.0 * t)).record(f"{name}.x")
        result = scene.run()
        t = result.time
        exact = (np.sin(3.0 * t) - 3.0 / w * np.sin(w * t)) / (2.0 - 9.0)
        for name, found in errors.items():
            found.append(np.max(np.abs(result[f"{name}.x"] - exact)))
    for found in errors.values():
        assert abs(np.polyfit(np.log(steps), np.log(found), 1)[0] - 2.0) < 0.1

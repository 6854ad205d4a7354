"""Macro steps chosen by the master: tolerance, work, jumps, refusal."""

from __future__ import annotations

import math

import numpy as np
import pytest

from curvebound.cosim import Adaptive, Scene
from curvebound.cosim.adaptive import _Controller
from curvebound.errors import CurveboundError

W = 2.0 * math.pi
SCALES = {"one.x": 1.0, "two.x": 1.0, "one.v": W, "two.v": W}


def symmetric(two_masses, tolerance, algorithm):
    k = 4.0 * math.pi**2
    return two_masses(
        (k, k), 16.0 * math.pi**2, (1.0, 0.0), (0.0, 0.0), 1.0, 0.01,
        algorithm=algorithm, adaptive=Adaptive(tolerance=tolerance, scales=SCALES),
    )  # fmt: skip


def error(result):
    t = result.time
    return max(
        np.max(np.abs(result["one.x"] - 0.5 * (np.cos(W * t) + np.cos(3 * W * t)))),
        np.max(np.abs(result["two.x"] - 0.5 * (np.cos(W * t) - np.cos(3 * W * t)))),
    )


@pytest.mark.parametrize(
    ("algorithm", "tolerances", "most_steps"),
    [
        ("jacobi", [1.0, 0.3, 0.1], 2000),
        ("gauss_seidel", [1.0, 0.3, 0.1], 2000),
        ("strang", [0.3, 0.1, 0.03, 0.01, 0.003], 500),
    ],
)
def test_error_is_proportional_to_the_tolerance(two_masses, algorithm, tolerances, most_steps):
    errors = []
    for tolerance in tolerances:
        result = symmetric(two_masses, tolerance, algorithm).run()
        errors.append(error(result))
        assert result.steps < most_steps
        assert result.trials >= 1.5 * result.steps
        assert result.rejected < 0.1 * result.trials
        # the bound per second holds, with the factor that the growth over the run allows
        assert errors[-1] < 2.0 * tolerance
    slope = np.polyfit(np.log(tolerances), np.log(errors), 1)[0]
    assert slope > 0.8


def test_the_controller_is_proportional_and_integral():
    controller = _Controller(2)
    # the first step remembers an error that is just what is allowed
    assert controller.taken(0.25) == pytest.approx(0.9 * 4.0**0.35, rel=1e-14)
    assert controller.taken(0.5) == pytest.approx(0.9 * 2.0**0.35 * 0.25**0.2, rel=1e-14)
    assert controller.taken(0.0) == 2.5
    controller = _Controller(2)
    assert controller.rejected(4.0) == pytest.approx(0.9 / 2.0, rel=1e-14)
    assert controller.rejected(math.inf) == 0.2
    assert controller.rejected(1.0) == 0.9
    assert controller.taken(0.25) == 1.0  # none longer than the one that was rejected
    assert controller.taken(0.25) == pytest.approx(0.9 * 4.0**0.35 * 0.25**0.2, rel=1e-14)


def test_it_ends_at_the_stop_time_and_never_below_its_bound(two_masses):
    scene = symmetric(two_masses, 0.03, "gauss_seidel")
    scene.adaptive = Adaptive(tolerance=1e-9, scales=SCALES, smallest=0.004)
    result = scene.run()
    assert result.time[-1] == 1.0
    assert np.min(np.diff(result.time)) > 0.0035
    assert any("lower bound" in note for note in result.notes)


def test_two_runs_give_the_same_bits(two_masses):
    scene = symmetric(two_masses, 0.3, "gauss_seidel")
    with scene.prepare() as prepared:
        first, second = prepared.run(), prepared.run()
    assert np.array_equal(first.data, second.data)
    assert np.array_equal(first.data, scene.run().data)


@pytest.mark.parametrize("told", ["by a table", "by the scene"])
def test_known_jumps_are_met(mass_fmu, told):
    """A mass driven by a table that jumps: a point lies at the jump, steps are long elsewhere."""
    scene = Scene(
        "jump", stop_time=10.0, step=0.01, adaptive=Adaptive(tolerance=0.05, scales={"one.v": 1.0})
    )
    scene.add("one", mass_fmu, {"k": 1.0, "kc": 1.0})
    if told == "by a table":
        scene.input("one.other", ([0.0, 4.9, 4.9], [0.0, 0.0, 1.0]))
    else:
        scene.input("one.other", lambda t: float(t >= 4.9), jumps=[4.9])
    scene.record("one.x", "one.v")
    result = scene.run()
    w = math.sqrt(2.0)
    after = np.maximum(result.time - 4.9, 0.0)
    assert np.min(np.abs(result.time - 4.9)) < 1e-5
    assert np.max(np.abs(result["one.x"] - 0.5 * (1.0 - np.cos(w * after)))) < 1e-5
    assert result.steps < 60


@pytest.mark.parametrize("hold", ["zero", "first"])
def test_jumps_that_are_known_are_points_to_the_last_bit(fmus, hold):
    """A frame driven by a table that jumps at times of no grid: nothing is late, nothing forced."""
    scene = Scene("jump", stop_time=1.0, step=0.1, hold=hold, adaptive=Adaptive(tolerance=1e-6))
    scene.add("bead", fmus / "BeadOnWire.fmu", {"solver.method": "adaptive"})
    scene.input("bead.wire.ax", ([0.0, 0.333, 0.333, 0.7, 0.7], [0.0, 0.0, 5.0, 5.0, -1.0]))
    result = scene.record("bead.wire.vx").run()
    assert {0.333, 0.7} <= set(result.time)
    assert result["bead.wire.vx"][-1] == pytest.approx(5.0 * 0.367 - 0.3, rel=1e-14)
    assert not [note for note in result.notes if "lower bound" in note]


def test_steps_follow_what_the_inputs_do(mass_fmu):
    """A pulse given as a function: steps are short while it changes."""
    scene = Scene(
        "pulse", stop_time=10.0, step=0.01,
        adaptive=Adaptive(tolerance=0.02, scales={"one.v": 1.0}, largest=0.5),
    )  # fmt: skip
    scene.add("one", mass_fmu, {"k": 1.0, "kc": 1.0})
    scene.input("one.other", lambda t: math.exp(-(((t - 5.0) / 0.5) ** 2)))
    result = scene.record("one.x", "one.v").run()
    steps = np.diff(result.time)
    assert np.max(steps[result.time[1:] < 2.0]) > 0.4
    busy = (result.time[1:] > 4.2) & (result.time[1:] < 5.8)
    assert np.max(steps[busy]) < 0.2


def test_refusal_names_the_component_that_cannot_roll_back(mass_fmu, gain_fmu):
    scene = Scene("no_rollback", stop_time=1.0, step=0.1, adaptive=Adaptive())
    scene.add("one", mass_fmu).add("block", gain_fmu)
    scene.connect("block.y", "one.other", 1.0)
    with pytest.raises(CurveboundError, match=r"component block: GainBlock cannot be rolled back"):
        scene.check()


@pytest.fixture(scope="module")
def feedback_fmu(build_fmu):
    return build_fmu("gain_block", canGetAndSetFMUstate=True)


def fed_back(mass_fmu, feedback_fmu, tolerance, algorithm):
    """x'' = -2 x + (-3 x), the last by a component whose output follows its input directly."""
    scene = Scene(
        "fed_back", stop_time=10.0, step=0.01, algorithm=algorithm,
        adaptive=Adaptive(tolerance=tolerance, scales={"one.v": 1.0}),
    )  # fmt: skip
    scene.add("one", mass_fmu, {"k": 1.0, "kc": 1.0, "x_start": 1.0})
    scene.add("gain", feedback_fmu, {"gain": -3.0})
    scene.connect("one.x", "gain.u", 1.0).connect("gain.y", "one.other", 1.0)
    return scene.record("one.x", "one.v")


def test_direct_feedback_is_of_second_order_with_midpoint(mass_fmu, feedback_fmu):
    errors, steps, tolerances = [], [], [1e-2, 1e-3, 1e-4]
    for tolerance in tolerances:
        result = fed_back(mass_fmu, feedback_fmu, tolerance, "midpoint").run()
        errors.append(np.max(np.abs(result["one.x"] - np.cos(math.sqrt(5.0) * result.time))))
        steps.append(result.steps)
        assert errors[-1] < 10.0 * tolerance  # the bound is per second, and these are ten
        assert not any("Direct feedback" in note or "lower bound" in note for note in result.notes)
    assert np.polyfit(np.log(tolerances), np.log(errors), 1)[0] > 0.8
    assert steps[-1] < 6000
    assert steps[-1] < 15 * steps[0]


def test_first_order_in_direct_feedback_says_so(mass_fmu, feedback_fmu):
    scene = fed_back(mass_fmu, feedback_fmu, 1e-7, "gauss_seidel")
    scene.stop_time = 0.01
    notes = scene.run().notes
    assert any(n.startswith("Direct feedback around gain, one is of first order") for n in notes)
    assert any("lower bound" in n and "times as large" in n for n in notes)

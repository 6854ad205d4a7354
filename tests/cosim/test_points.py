"""Communication points of a fixed macro step: its multiples, and the jumps of inputs."""

from __future__ import annotations

import math

import numpy as np
import pytest

from curvebound.cosim import Scene, load_scene
from curvebound.cosim.points import communication_times, macro_steps
from curvebound.cosim.ssp import write_ssp

W = math.sqrt(2.0)  # rad/s, of the driven mass


def test_multiples_and_a_shorter_last_step():
    assert communication_times(0.0, 1.0, 0.25) == [0.0, 0.25, 0.5, 0.75, 1.0]
    assert communication_times(0.0, 0.6, 0.25) == [0.0, 0.25, 0.5, 0.6]
    steps = list(macro_steps(0.0, 1e3, 0.1))
    assert len(steps) == 10000
    assert {step.size for step in steps} == {0.1}
    assert steps[-1].reached == 1e3


def test_jumps_cut_the_step_that_they_lie_in_and_no_other():
    steps = list(macro_steps(0.0, 1.0, 0.25, [0.3, 0.4, 0.75, 1.5]))
    assert [step.reached for step in steps] == [0.25, 0.3, 0.4, 0.5, 0.75, 1.0]
    assert [step.whole for step in steps] == [True, False, False, True, True, True]
    assert sum(step.size for step in steps) == pytest.approx(1.0)


@pytest.mark.parametrize("n", range(1, 100))
def test_a_jump_at_a_multiple_adds_no_step_and_is_not_missed_by_rounding(n):
    jump = float(f"{n / 100:.2f}")
    times = communication_times(0.0, 1.0, 0.01, [jump])
    assert len(times) == 101
    assert jump in times


@pytest.mark.parametrize("step", [1e7, 1e9, 1e300])
def test_a_run_far_shorter_than_its_step_is_one_step_and_keeps_its_jumps(step):
    assert communication_times(0.0, 0.1, step) == [0.0, 0.1]
    assert communication_times(0.0, 0.1, step, [0.05]) == [0.0, 0.05, 0.1]


def driven(mass_fmu, jump, **settings):
    scene = Scene("jump", stop_time=5.0, step=0.15, **settings)
    scene.add("one", mass_fmu, {"k": 1.0, "kc": 1.0})
    return scene.record("one.x").input("one.other", lambda t: float(t >= jump), jumps=[jump])


@pytest.mark.parametrize("algorithm", ["gauss_seidel", "jacobi"])
@pytest.mark.parametrize("jump", [2.0, 0.07, 4.999, 3.0])
def test_fixed_macro_steps_end_at_a_jump(mass_fmu, algorithm, jump):
    result = driven(mass_fmu, jump, algorithm=algorithm).run()
    exact = 0.5 * (1.0 - np.cos(W * np.maximum(result.time - jump, 0.0)))
    assert jump in result.time
    assert np.max(np.abs(result["one.x"] - exact)) < 1e-12


def test_tables_that_jump_likewise_and_through_an_ssp(mass_fmu, tmp_path):
    scene = driven(mass_fmu, 2.0)
    scene.inputs.clear()
    scene.input("one.other", ([0.0, 2.0, 2.0], [0.0, 0.0, 1.0]))
    result = scene.run()
    assert 2.0 in result.time
    again = load_scene(write_ssp(scene, tmp_path / "jump.ssp")).run()
    assert np.array_equal(result.data, again.data)


def test_recording_keeps_to_the_macro_steps(mass_fmu):
    result = driven(mass_fmu, 2.0, record_every=4).run()
    assert np.allclose(np.diff(result.time)[:-1], 0.6)


def test_what_takes_one_step_size_only_is_told_of(mass_fmu, monkeypatch):
    scene = driven(mass_fmu, 2.0)
    fmu = scene.check().nodes["one"].fmu
    monkeypatch.setitem(fmu.__dict__, "can_vary_step", False)
    scene.stop_time = 3.0
    (note,) = scene.check().notes
    assert note.startswith("The jump of one.other at 2 s acts at the communication point after it")

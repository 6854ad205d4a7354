"""A component that fails in mid-run: the others end well, and what was recorded is kept."""

from __future__ import annotations

import sys
from pathlib import Path
from types import ModuleType

import pytest

from curvebound.cosim import RunFailed, Scene, command, read_csv
from curvebound.cosim.algorithms import advance_of
from curvebound.cosim.command import main
from curvebound.cosim.instance import Instance
from curvebound.errors import CurveboundError


@pytest.fixture
def scene(mass_fmu, gain_fmu):
    scene = Scene("failing", stop_time=1.0, step=0.01)
    scene.add("sound", mass_fmu, {"x_start": 1.0})
    scene.add("faulty", gain_fmu, {"fail_time": 0.505})
    scene.connect("sound.x", "faulty.u", 1.0)
    return scene.record("sound.x", "faulty.y")


def test_message_and_partial_result(scene):
    with pytest.raises(RunFailed) as caught:
        scene.run()
    error = caught.value
    assert error.component == "faulty"
    assert error.time == pytest.approx(0.5)
    assert "fmi2DoStep returned fmi2Discard" in error.cause
    assert "the gain block was told to fail" in error.cause
    assert str(error).startswith("The scene failing failed at t = 0.5 s: component faulty: ")
    assert len(error.result.data) == 51
    assert error.result["faulty.y"][-1] == error.result["sound.x"][-1]
    assert not error.result.complete
    assert error.result.failure == str(error)


def test_the_others_are_terminated_and_freed(scene, monkeypatch):
    calls = []
    terminate, free = Instance.terminate, Instance.free

    def seen(what, method):
        def call(self):
            calls.append((what, self.name, self.alive, self.failed))
            method(self)

        return call

    monkeypatch.setattr(Instance, "free", seen("free", free))
    monkeypatch.setattr(Instance, "terminate", seen("terminate", terminate))
    with scene.prepare() as prepared:
        with pytest.raises(RunFailed):
            prepared.run()
        assert ("terminate", "sound", True, False) in calls
        assert ("free", "faulty", True, True) in calls
        assert not prepared._instances
        # and it works again, with a value that does not fail
        result = prepared.run({"faulty.fail_time": 1e9})
        assert result.complete
        assert result.steps == 100


def test_an_exception_in_the_fmu_is_fatal_and_survived(scene):
    scene.set("faulty.failure", 2)
    with pytest.raises(RunFailed, match="component faulty") as caught:
        scene.run()
    assert len(caught.value.result.data) == 51


def test_single_fmus_fail_alike(gain_fmu):
    scene = Scene("single", stop_time=1.0, step=0.01).add("a", gain_fmu, {"fail_time": 0.305})
    scene.record("a.y")
    with pytest.raises(RunFailed, match=r"component a: .*told to fail") as caught:
        scene.run()
    assert len(caught.value.result.data) == 31
    assert caught.value.time == pytest.approx(0.3)


def test_the_command_writes_what_there_is(scene, tmp_path, capsys):
    out = tmp_path / "partial.csv"
    assert main(scene, ["--out", str(out)]) == 1
    assert len(read_csv(out)) == 51
    message = capsys.readouterr().err
    assert "component faulty" in message
    assert "The result up to there is in" in message


def test_failing_initialization_names_the_component(mass_fmu):
    scene = Scene("bad_start", stop_time=1.0, step=0.1)
    scene.add("one", mass_fmu, {"m": 1.0}).add("two", mass_fmu, {"m": -1.0})
    scene.connect("one.x", "two.other").connect("two.x", "one.other")
    with pytest.raises(RunFailed, match=r"failed at t = 0 s: component two: .*fmi2DoStep"):
        scene.run()


def test_an_interrupted_run_is_no_failed_one_and_keeps_what_it_has(scene, tmp_path, monkeypatch):
    stop = iter([None] * 20)

    def interrupt(schedule):
        advance = advance_of(schedule)

        def step(time, size):
            if next(stop, stop) is stop:
                raise KeyboardInterrupt
            advance(time, size)

        return step

    monkeypatch.setattr("curvebound.cosim.prepared.advance_of", interrupt)
    out = tmp_path / "partial.csv"
    assert main(scene, ["--out", str(out)]) == 1
    assert len(read_csv(out)) == 21
    with scene.prepare() as prepared, pytest.raises(KeyboardInterrupt) as caught:
        prepared.run()
    assert not isinstance(caught.value, CurveboundError)
    assert len(caught.value.result.data) == 1


def test_a_component_that_ends_the_simulation_ends_it(scene):
    scene.set("faulty.failure", 3)
    result = scene.run()
    assert result.complete
    assert len(result.data) == 51
    (note,) = [note for note in result.notes if "ended the simulation" in note]
    assert note == "The component faulty ended the simulation at t = 0.5 s."


@pytest.mark.parametrize("every", [1, 7])
def test_a_scene_of_one_ends_alike(gain_fmu, every):
    scene = Scene("single", stop_time=1.0, step=0.01, record_every=every)
    scene.add("a", gain_fmu, {"fail_time": 0.305, "failure": 3}).record("a.y")
    result = scene.run()
    assert result.complete
    assert result.time[-1] == pytest.approx(0.3)
    assert "The component a ended the simulation at t = 0.3 s." in result.notes
    with scene.prepare() as prepared:
        for _ in range(2):
            assert len(prepared.run().data) == len(result.data)


def test_two_drives_in_a_circle_of_gain_one_are_told_what_helps():
    scene = Scene("circle", stop_time=1.0, step=0.1, loop_tolerance=1e-9)
    for name in ("a", "b"):
        start = {"feedback.slider_u": -1.0, "waveform.kind": "step"}
        scene.add(name, "ParabolaDrive", start)
    scene.connect("a.parabola.ax", "b.slider.u", 1.0).connect("b.parabola.ax", "a.slider.u", 1.0)
    with pytest.raises(RunFailed, match="the gain around it is 1") as caught:
        scene.run()
    assert "loop_tolerance" not in str(caught.value)
    scene.set("a.feedback.slider_u", 0.5)
    assert scene.run()["a.parabola.ax"][-1] == pytest.approx(1.0 / 3.0)


@pytest.mark.parametrize("folder", [None, Path("/of/its/own")])
def test_a_scene_of_a_script_looks_beside_the_script(folder, monkeypatch, tmp_path) -> None:
    """Unless it was told where."""
    run = []
    monkeypatch.setattr(command, "run_all", lambda scene, options: run.append(scene.folder))
    scene = Scene("own", stop_time=1.0, step=0.1)
    scene.folder = folder
    script = ModuleType("__main__")
    monkeypatch.setitem(sys.modules, "__main__", script)
    assert main(scene, []) == 0
    script.__file__ = str(tmp_path / "script.py")
    assert main(scene, []) == 0
    assert run == [folder, folder or tmp_path.resolve()]

"""A plant that fails in mid-scene, under every algorithm: the others end well, nothing is lost."""

from __future__ import annotations

import re

import numpy as np
import pytest

from curvebound.cosim import Adaptive, RunFailed, Scene, read_csv
from curvebound.cosim.command import main
from curvebound.cosim.instance import Instance, Library
from curvebound.cosim.scene_parts import ALGORITHMS

#: explicit Euler at a hundred times its stable step, so that the state leaves the finite numbers
FAILING = {
    "solver.method": "explicit_euler",
    "solver.step": 0.01,
    "pendulum.damping": 2e4,
    "pendulum.angle_start": 0.1,
    "pendulum.angular_velocity_start": 1.0,
}


def trio(order: list[str], **settings: object) -> Scene:
    """A drive and two pendulums that follow it; `broken` fails after some steps."""
    scene = Scene("trio", stop_time=5.0, step=0.02, **settings)  # type: ignore[arg-type]
    drive = {"feedback.pendulum_angle": 1.0}
    parts = {
        "drive": ("ParabolaDrive", drive),
        "sound": ("ParabolaPendulum", {"pendulum.angle_start": 0.1}),
        "broken": ("ParabolaPendulum", FAILING),
    }
    for name in order:
        scene.add(name, *parts[name])
    scene.connect("sound.pendulum.angle", "drive.pendulum.angle")
    scene.connect("drive.parabola.ax", "sound.parabola.ax")
    scene.connect("drive.parabola.ax", "broken.parabola.ax")
    return scene.record("sound.pendulum.angle", "broken.pendulum.angle", "drive.parabola.ax")


CASES = [
    (algorithm, order, adaptive)
    for algorithm in ALGORITHMS
    for order in (["drive", "sound", "broken"], ["broken", "sound", "drive"])
    for adaptive in (False, True)
]


@pytest.mark.parametrize(("algorithm", "order", "adaptive"), CASES)
def test_the_others_end_well_and_what_was_recorded_is_kept(
    algorithm: str, order: list[str], adaptive: bool, monkeypatch: pytest.MonkeyPatch
) -> None:
    ended: list[tuple[str, str, bool]] = []
    for what in ("terminate", "free"):
        method = getattr(Instance, what)

        def seen(self, what=what, method=method):
            method(self)
            ended.append((what, self.name, self.failed))

        monkeypatch.setattr(Instance, what, seen)
    called: list[str] = []
    function = Library.function

    def noted(self, name):
        called.append(name)
        return function(self, name)

    monkeypatch.setattr(Library, "function", noted)
    control = Adaptive(tolerance=1.0, smallest=0.02) if adaptive else None
    groups = (["drive"], ["sound", "broken"]) if algorithm == "strang" else None
    scene = trio(order, algorithm=algorithm, adaptive=control, groups=groups)
    with scene.prepare() as prepared:
        with pytest.raises(RunFailed) as caught:
            prepared.run()
        assert not prepared._instances
        assert called.count("fmi2Terminate") == 2
        assert called.count("fmi2FreeInstance") == 3
        # each freed once, the failed one not asked to terminate before
        freed = sorted(name for what, name, _ in ended if what == "free")
        assert freed == ["broken", "drive", "sound"]
        assert {name for what, name, failed in ended if what == "terminate" and not failed} == {
            "drive",
            "sound",
        }
        # and the same scene, mended, runs
        mended = prepared.run({"broken.pendulum.damping": 0.1}, stop_time=0.2)
        assert mended.complete
    failure = caught.value
    assert failure.component == "broken"
    assert 0.0 < failure.time < 5.0
    assert re.search(r"fmi2DoStep returned fmi2(Error|Discard): .*solver\.step", failure.cause)
    assert str(failure).startswith(f"The scene trio failed at t = {failure.time:.6g} s: ")
    data = failure.result.data
    assert data["time"][-1] == failure.time
    assert len(data) > 2
    assert all(np.all(np.isfinite(data[name])) for name in data.dtype.names)
    assert np.all(np.diff(data["time"]) > 0.0)
    assert not failure.result.complete


@pytest.mark.parametrize("algorithm", ALGORITHMS)
def test_what_was_recorded_is_the_run_up_to_there(algorithm: str) -> None:
    groups = (["drive"], ["sound", "broken"]) if algorithm == "strang" else None
    scene = trio(["drive", "sound", "broken"], algorithm=algorithm, groups=groups)
    with pytest.raises(RunFailed) as caught:
        scene.run()
    early = caught.value.result
    shorter = scene.copy()
    shorter.stop_time = caught.value.time
    whole = shorter.run()
    assert len(whole.data) == len(early.data)
    for name in whole.names:
        assert np.array_equal(whole[name], early[name])


def test_the_command_writes_what_there_is_and_says_who_failed(tmp_path, capsys) -> None:
    out = tmp_path / "trio.csv"
    assert main(trio(["sound", "drive", "broken"]), ["--out", str(out)]) == 1
    said = re.sub(r"\s+", " ", capsys.readouterr().err)
    found = re.search(r"failed at t = ([0-9.]+) s: component broken: .*solver\.step", said)
    assert found, said
    assert "The result up to there is in" in said
    table = read_csv(out)
    assert table["time"][-1] == pytest.approx(float(found.group(1)))

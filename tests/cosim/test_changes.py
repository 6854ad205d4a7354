"""What options change of a scene, what a result is by default, and what drawings are told."""

from __future__ import annotations

import argparse
from pathlib import Path

import numpy as np
import pytest
from descriptions import BARE, packed

from curvebound.cosim import Adaptive, Result, Scene, prepared
from curvebound.cosim.options import changed, chosen, configure


def scene(folder: Path) -> Scene:
    packed(BARE, folder / "bare.fmu")
    found = Scene("s", stop_time=1.0, step=0.5).add("a", folder / "bare.fmu", {"u": 2.0})
    return found.variant("other", {"a.u": 3.0}).variant("third", {"a.u": 4.0, "step": 0.25})


def options(*words: str) -> argparse.Namespace:
    parser = argparse.ArgumentParser()
    configure(parser)
    return parser.parse_args(words)


def settings(one: Scene) -> dict[str, object]:
    names = ("stop_time", "step", "algorithm", "hold", "adaptive")
    return {**{n: getattr(one, n) for n in names}, "u": one.components["a"].start["u"]}


@pytest.mark.parametrize(
    ("words", "expected"),
    [
        ([], {}),
        (["--stop", "2"], {"stop_time": 2.0}),
        (["--step", "0.125"], {"step": 0.125}),
        (["--algorithm", "strang"], {"algorithm": "strang"}),
        (["--hold", "first"], {"hold": "first"}),
        (["--adaptive", "1e-3"], {"adaptive": Adaptive(tolerance=1e-3)}),
        (["--set", "a.u=5"], {"u": "5"}),
        (["--variant", "other"], {"u": 3.0}),
        (["--variant", "other", "--set", "a.u=5", "--stop", "3"], {"u": "5", "stop_time": 3.0}),
    ],
)
def test_each_option_changes_its_setting_and_no_other(
    words: list[str], expected: dict[str, object], tmp_path: Path
) -> None:
    own = scene(tmp_path)
    before = settings(own)
    assert settings(changed(own, options(*words))) == {**before, **expected}
    assert settings(own) == before


def test_the_scenes_to_run(tmp_path: Path) -> None:
    own = scene(tmp_path)

    def told(*words: str) -> list[tuple[str, object, float]]:
        found = chosen(own, options(*words))
        return [(label, one.components["a"].start["u"], one.step) for label, one in found]

    assert told() == [("s", 2.0, 0.5)]
    assert told("--variant", "other", "--step", "0.1") == [("other", 3.0, 0.1)]
    assert told("--variants") == [("s", 2.0, 0.5), ("other", 3.0, 0.5), ("third", 4.0, 0.25)]


def test_a_result_by_default() -> None:
    data = np.array([(0.0, 1.0), (0.5, 3.0)], dtype=[("time", float), ("a.x", float)])
    found = Result("s", data)
    assert {k: v for k, v in vars(found).items() if k != "data"} == {
        "scene": "s", "wall": 0.0, "stepping": 0.0, "steps": 0, "trials": 0, "rejected": 0,
        "units": {}, "drawings": {}, "inputs": {}, "notes": [], "settings": {},
        "complete": True, "failure": "",
    }  # fmt: skip
    assert (found.names, found.time.tolist()) == (["a.x"], [0.0, 0.5])
    assert found["a.x"].tolist() == [1.0, 3.0]
    assert repr(found) == "<Result of s: 2 points, 0 to 0.5 s, a.x>"
    assert repr(Result("s", data[:0])) == "<Result of s: 0 points, a.x>"


def test_forces_of_a_picture_are_those_that_act() -> None:
    """Held, driven by the scene, and through two connections with a factor and an offset."""
    held = Scene("s", stop_time=1.0, step=0.5)
    for name in ("one", "two"):
        held.add(name, "ParabolaPendulum", {"slider.fx": 2.0})
    held.connect("one.slider.u", "two.slider.fx", 3.0, 1.0)
    held.connect("one.slider.u_rate", "two.slider.fy", 1.0, -1.0)
    held.input("two.pendulum.fx", lambda t: 10.0 * t)
    kinds = [("time", float), ("one.slider.u", float)]
    data = np.array([(0.0, 0.5), (0.5, -1.0)], dtype=kinds)
    found = {k: v.tolist() for k, v in held.check().acting(data).items()}
    assert found["one.slider.fx"] == [2.0, 2.0]
    assert found["one.slider.fy"] == [0.0, 0.0]
    assert found["two.slider.fx"] == [2.5, -2.0]
    assert found["two.pendulum.fx"] == [0.0, 5.0]
    assert "two.slider.fy" not in found


def test_progress_is_told_at_each_communication_point(
    interpreting: None, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(prepared, "_BEAT", -1.0)
    own = Scene("s", stop_time=0.5, step=0.125).add("a", "ParabolaDrive").record("a.*")
    heard: list[float] = []
    result = own.run(progress=heard.append)
    assert heard == [0.125, 0.25, 0.375, 0.5, 0.5]
    assert (result.steps, result.trials, result.rejected) == (4, 4, 0)
    assert 0.0 < result.stepping < result.wall

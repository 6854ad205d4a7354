"""What `curvebound` offers to scripts is documented, works as that says, and is found by help()."""

from __future__ import annotations

import doctest
import inspect
import pydoc
import subprocess
import sys
from pathlib import Path
from typing import Any, ClassVar

import numpy as np
import pytest

import curvebound

FUNCTIONS = [name for name in curvebound.__all__ if inspect.isfunction(getattr(curvebound, name))]
METHODS = [
    name
    for name, value in inspect.getmembers(curvebound.Scene, inspect.isfunction)
    if not name.startswith("_") or name == "__init__"
]


def is_told(function: object) -> list[str]:
    """What the docstring of a function does not tell."""
    text = inspect.getdoc(function) or ""
    signature = inspect.signature(function)  # type: ignore[arg-type]
    names = [name for name in signature.parameters if name != "self"]
    missing = [name for name in names if name not in text]
    if names and "Parameters\n----------" not in text:
        missing.append("Parameters")
    if signature.return_annotation != "None" and "Returns\n-------" not in text:
        missing.append("Returns")
    return missing


@pytest.mark.parametrize("name", FUNCTIONS)
def test_a_function_tells_its_parameters_and_what_it_gives_back(name: str) -> None:
    assert is_told(getattr(curvebound, name)) == []


@pytest.mark.parametrize("name", METHODS)
def test_so_does_what_a_scene_can_do(name: str) -> None:
    assert is_told(getattr(curvebound.Scene, name)) == []


def test_help_shows_all_of_it() -> None:
    page = pydoc.plain(pydoc.render_doc(curvebound))
    for name in curvebound.__all__:
        assert name in page
    assert "Largest error at any time by output path" in page  # of tune


def test_the_example_of_the_package_runs() -> None:
    assert doctest.testmod(curvebound).failed == 0


def test_importing_it_takes_no_numpy() -> None:
    code = "import curvebound, sys; assert 'numpy' not in sys.modules; curvebound.Scene"
    subprocess.run([sys.executable, "-c", code], check=True)
    with pytest.raises(AttributeError, match="no attribute sweeps"):
        _ = curvebound.sweeps


@pytest.mark.usefixtures("points_here", "timed_once")
def test_a_scene_is_run_tuned_and_swept(tmp_path: Path) -> None:
    pytest.importorskip("mpmath")
    scene = curvebound.load_scene("bead_on_wire")
    scene.set("stop_time", 0.5).set("bead.bead.damping", 0.1)
    result = curvebound.run(scene, {"bead.wire.radius": 2.0}, stop_time=0.2)
    assert result.time[-1] == 0.2
    assert np.hypot(result["bead.bead.x"], result["bead.bead.y"])[-1] == pytest.approx(2.0)
    choice = curvebound.tune(scene, 1e-3)
    assert choice.chosen is not None
    assert max(v.worst for v in choice.chosen.verdicts.values()) <= 1e-3
    made = curvebound.sweep(
        "bead_on_wire", ["bead.bead.damping=0:1:3"], tmp_path / "a.csv", workers=1
    )
    assert (made.points, made.run, made.failed) == (3, 3, 0)
    assert len(made.path.read_text().splitlines()) == 1 + 3


def test_a_scene_without_bounds_is_told_so() -> None:
    scene = curvebound.load_scene("bead_on_wire")
    scene.needs.errors = {}
    with pytest.raises(curvebound.CurveboundError, match="give bounds"):
        curvebound.tune(scene)


class Noting:
    """A tuner that tells what it was made with and asked for."""

    made: ClassVar[list[Any]] = []

    def __init__(self, scene: Any, outputs: Any, **settings: Any) -> None:
        self.made[:] = [outputs, settings]

    def tune(self, bounds: Any, *, budget: float | None) -> Any:
        return bounds, budget

    def close(self) -> None:
        self.made.append("closed")


def test_tune_asks_for_what_was_given_or_what_the_scene_needs(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    monkeypatch.setattr("curvebound.api.Tuner", Noting)
    scene = curvebound.load_scene("bead_on_wire")
    scene.needs.errors = {"bead.bead.x": 1e-3, "bead.bead.y": 0.0}
    scene.needs.budget = 0.5
    assert curvebound.tune(scene) == ({"bead.bead.x": 1e-3}, 0.5)
    settings = {"continuous": False, "frame_rate": None, "limit": 5.0, "keep": None}
    assert Noting.made == [["bead.bead.x"], settings, "closed"]
    assert curvebound.tune(scene, {"bead.bead.y": 2.0}, budget=0.0) == ({"bead.bead.y": 2.0}, 0.0)
    every, budget = curvebound.tune(scene, 1e-2, continuous=True, frame_rate=30.0, limit=1.0)
    assert budget == 0.5
    assert Noting.made[1] == settings | {"continuous": True, "frame_rate": 30.0, "limit": 1.0}
    assert set(every.values()) == {1e-2}
    assert {"bead.bead.x", "bead.bead.y"} <= set(every)
    scene.needs.budget = None
    assert curvebound.tune(scene)[1] is None

"""The demo runs the FMUs that it has built, and goes on past a scene that cannot run."""

from __future__ import annotations

import json
import subprocess
import sys
from pathlib import Path
from types import SimpleNamespace

import pytest

from curvebound.cli import main
from curvebound.cli.demo import _place
from curvebound.cosim import Scene, load_scene, scene_names
from curvebound.errors import CurveboundError
from curvebound.view import read_result


@pytest.mark.usefixtures("short_reference")
def test_demo_runs_what_it_built(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    def load(name: str) -> Scene:
        if name == "absent":
            raise CurveboundError("The scene absent needs [one] more thing.")
        scene = load_scene(name)
        scene.stop_time = 0.1
        return scene

    def refuse(name: str) -> Path:
        raise AssertionError(f"{name} is built a second time")

    monkeypatch.setattr("curvebound.cosim.scene_names", lambda: ["absent", "pendulum_small"])
    monkeypatch.setattr("curvebound.cosim.load_scene", load)
    monkeypatch.setattr("curvebound.cosim.capabilities._BUILT", {})
    monkeypatch.setattr("curvebound.cosim.capabilities._build", refuse)
    assert main(["demo", "--no-compile", "--json", "--out", str(tmp_path)]) == 1
    heard = capsys.readouterr()
    said = " ".join(heard.err.split())
    assert "failed: absent: The scene absent needs [one] more thing." in said
    assert "pendulum_small 0.1 s" in said
    data = json.loads(heard.out)
    assert data["failures"] == ["absent: The scene absent needs [one] more thing."]
    (row,) = data["scenes"]
    result = read_result(Path(row["file"])).data
    assert row["scene"] == "pendulum_small"
    assert row["steps"] == result["plant.solver.steps"][-1] > 0
    assert 1e-9 > row["residual"] == abs(result["plant.energy.residual"]).max() > 0.0
    assert row["drift"] is None
    assert (tmp_path / "pendulum_small.csv").is_file()
    assert (tmp_path / "pendulum_small.html").is_file()
    gallery = (tmp_path / "index.html").read_text(encoding="utf-8")
    assert "pendulum_small" in gallery
    assert "Each card is a scene" in gallery
    assert gallery.count('href="documentation/ParabolaPendulum/index.html"') == 2, "page and card"
    assert gallery.count('href="documentation/BeadOnWire/index.html"') == 1
    assert (tmp_path / "documentation/ParabolaPendulum/reference.csv").is_file()


def test_demo_fails_where_a_scene_misses_its_need(
    fmus: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    def built(name: str, *_: object, **__: object) -> SimpleNamespace:
        return SimpleNamespace(path=fmus / f"{name}.fmu", message="")

    def load(name: str) -> Scene:
        scene = load_scene("bead_on_wire")
        scene.stop_time = 1.0
        scene.needs.errors = {"bead.bead.x": 1e-15, "bead.bead.y": 1.0}
        return scene

    monkeypatch.setattr("curvebound.fmi.build.build", built)
    monkeypatch.setattr("curvebound.study.extras.missing", lambda _: "no pictures needed")
    monkeypatch.setattr("curvebound.cosim.scene_names", lambda: ["bead_on_wire"])
    monkeypatch.setattr("curvebound.cosim.load_scene", load)
    assert main(["demo", "--no-compile", "--out", str(tmp_path)]) == 1
    said = " ".join(capsys.readouterr().out.split())
    assert "failed: bead_on_wire: The error of bead.bead.x reaches" in said
    assert "m where the scene needs 1e-15" in said
    assert "bead.bead.y" not in said


BLOCKED = """
import importlib.abc, sys

class Blocker(importlib.abc.MetaPathFinder):
    def find_spec(self, name, path=None, target=None):
        if name.partition(".")[0] in ("scipy", "mpmath", "matplotlib", "PIL", "distributed"):
            raise ModuleNotFoundError(f"No module named {name!r}", name=name)

sys.meta_path.insert(0, Blocker())
import importlib.util
found = importlib.util.find_spec

def find_spec(name, package=None):
    try:
        return found(name, package)
    except ModuleNotFoundError:
        return None

importlib.util.find_spec = find_spec
"""


def test_the_scenes_need_no_extra_and_what_is_missing_is_said_once(tmp_path: Path) -> None:
    script = BLOCKED + (
        "from curvebound import cosim\n"
        "from curvebound.cli import main\n"
        "from curvebound.fmi import documentation\n"
        "documentation.reference_result = lambda _: None  # most of the time of a build\n"
        "for name in cosim.scene_names():\n"
        "    cosim.load_scene(name)\n"
        "cosim.scene_names = lambda: ['pendulum_small']\n"
        "raise SystemExit(main(['list']) or main(['demo', '--no-compile', '--out', sys.argv[1]]))\n"
    )
    done = subprocess.run(
        [sys.executable, "-c", script, str(tmp_path)], capture_output=True, text=True
    )
    assert done.returncode == 0, done.stderr
    assert done.stdout.count("not installed") == 1
    assert "pip install 'curvebound[plots]'" in " ".join(done.stdout.split())
    assert done.stderr == ""


def test_the_gallery_is_a_course() -> None:
    """One body, small and large; then coupled ones; then feedback."""
    scenes = sorted(map(load_scene, scene_names()), key=lambda scene: _place((scene, None)))  # type: ignore[arg-type]
    assert [scene.lesson for scene in scenes] == list(range(1, len(scenes) + 1))
    alone = [len(scene.components) == 1 for scene in scenes]
    assert alone == sorted(alone, reverse=True), "one FMU alone before coupled ones"
    fed_back = [
        any(name.startswith("feedback.") for one in scene.components.values() for name in one.start)
        for scene in scenes
    ]
    assert fed_back == sorted(fed_back), "feedback is last"
    stray = Scene("a_scene", stop_time=1.0, step=0.1)
    assert _place((stray, None)) > _place((scenes[-1], None))  # type: ignore[arg-type]

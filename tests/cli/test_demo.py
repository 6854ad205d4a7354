"""The demo runs the FMUs that it has built, and goes on past a scene that cannot run."""

from __future__ import annotations

from pathlib import Path

import pytest

from curvebound.cli import main
from curvebound.cosim import Scene, load_scene
from curvebound.errors import CurveboundError


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
    monkeypatch.setattr("curvebound.cosim.capabilities._built", refuse)
    assert main(["demo", "--no-compile", "--out", str(tmp_path)]) == 1
    said = " ".join(capsys.readouterr().out.split())
    assert "failed: The scene absent needs [one] more thing." in said
    assert "pendulum_small 0.1 s" in said
    assert (tmp_path / "pendulum_small.csv").is_file()
    assert (tmp_path / "pendulum_small.html").is_file()
    assert "pendulum_small" in (tmp_path / "index.html").read_text(encoding="utf-8")

"""--json gives one document on standard output; --quiet leaves out what is for people."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import pytest

from curvebound.cli import live, main
from curvebound.errors import CurveboundError
from curvebound.study.sweep.engine import Sweep, SweepResult


def given(capsys: pytest.CaptureFixture[str], *words: str) -> Any:
    assert main([*words, "--json"]) == 0
    return json.loads(capsys.readouterr().out)


def test_a_scene_and_a_system_can_be_touched() -> None:
    assert live._scene("bead_on_wire").name == "bead_on_wire"
    scene = live._scene("BeadOnWire")
    assert (scene.name, list(scene.components)) == ("BeadOnWire", ["bead_on_wire"])


def test_list_and_show(capsys: pytest.CaptureFixture[str]) -> None:
    data = given(capsys, "list")
    assert data["scenes"]["bead_on_wire"].startswith("a bead on a circular wire")
    assert set(data["fmus"]) == {"BeadOnWire", "ParabolaDrive", "ParabolaPendulum"}
    (fmu,) = given(capsys, "list", "BeadOnWire")["fmus"]
    radius = next(v for v in fmu["variables"] if v["name"] == "wire.radius")
    assert (radius["unit"], radius["start"], radius["causality"]) == ("m", 1.0, "parameter")
    scene = given(capsys, "show", "inverted_balance")
    assert scene["needs"] == {"plant.slider.u": 1e-2, "plant.pendulum.angle": 1e-2}
    assert scene["units"]["plant.pendulum.angle"] == "rad"
    model = given(capsys, "linearize", "BeadOnWire", "--input", "bead.fx")
    assert (model["inputs"], model["units"]["bead.fx"]) == (["bead.fx"], "N")
    assert {"name", "fmu", "start"} == set(scene["components"][0])
    (first, *_) = given(capsys, "show", "solver.method")["found"]
    assert first["items"]["adaptive"] == 4


@pytest.mark.usefixtures("short_reference")
def test_build_and_run(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    (built,) = given(capsys, "build", "ParabolaDrive", "--no-compile", "--out", str(tmp_path))
    assert Path(built["path"]).is_file()
    out = tmp_path / "r.npz"
    (run,) = given(capsys, "run", "bead_on_wire", "--stop", "1", "--out", str(out))
    assert run["steps"] == 100
    assert run["outputs"]["bead.bead.x"]["unit"] == "m"
    assert run["outputs"]["bead.bead.x"]["largest"] == 1.0
    assert run["file"] == str(out)


def test_sweep_and_tune(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    pytest.importorskip("mpmath")
    out = tmp_path / "s.csv"
    sweep = given(
        capsys, "sweep", "bead_on_wire", "--vary", "bead.bead.damping=0,1", "--workers", "1",
        "--set", "stop_time=0.1", "--out", str(out),
    )  # fmt: skip
    assert sweep == {"file": str(out), "points": 2, "run": 2, "failed": 0, "maps": []}


@pytest.mark.parametrize(
    ("counts", "said"),
    [
        ((1, 1, 0), "1 point"),
        ((5, 5, 2), "5 points; 2 failed, see the column message"),
        ((5, 3, 0), "5 points, 2 of them from an earlier run"),
    ],
)
def test_what_a_sweep_says(
    counts: tuple[int, int, int], said: str, capsys: pytest.CaptureFixture[str], monkeypatch
) -> None:
    def run(self: Sweep, out: Path, **options: Any) -> SweepResult:
        return SweepResult(out, *counts)

    monkeypatch.setattr(Sweep, "run", run)
    words = ["--vary", "bead.bead.damping=0,1", "--out", "s.csv"]
    assert main(["sweep", "bead_on_wire", *words]) == 0
    assert capsys.readouterr().out == f"s.csv: {said}\n"


def test_quiet_prints_errors_only(capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["run", "bead_on_wire", "--stop", "0.1", "--quiet"]) == 0
    heard = capsys.readouterr()
    assert (heard.out, heard.err) == ("", "")
    assert main(["run", "bead_on_wir", "--quiet"]) == 1
    assert "did you mean bead_on_wire" in capsys.readouterr().err


def test_warnings_of_the_program_follow_the_level(
    capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    import logging

    def warn() -> list[str]:
        logging.getLogger("curvebound").warning("careful")
        return []

    monkeypatch.setattr("curvebound.cosim.scene_names", warn)
    assert main(["list"]) == 0
    assert capsys.readouterr().err == "careful\n"
    assert main(["list", "--log-level", "error"]) == 0
    assert capsys.readouterr().err == ""


@pytest.mark.parametrize(
    ("words", "recorded"),
    [([], []), (["--replay"], ["bead.*"]), (["--picture", "a.png"], ["bead.*"]),
     (["--gif", "a.gif"], ["bead.*"])],
    ids=str,
)  # fmt: skip
def test_what_is_drawn_is_recorded(words, recorded, tmp_path: Path, monkeypatch) -> None:
    """Of a scene that names nothing to record; without a picture it is left at that."""
    script = tmp_path / "bare.py"
    script.write_text(
        "from curvebound.cosim import Scene\n"
        "scene = Scene('bare', stop_time=1.0, step=0.1).add('bead', 'BeadOnWire')\n"
    )
    seen = []

    def run_all(scene, options):
        seen.append(list(scene.recorded))
        raise CurveboundError("that is all")

    monkeypatch.setattr("curvebound.cosim.command.run_all", run_all)
    assert main(["run", str(script), *words]) == 1
    assert seen == [recorded]

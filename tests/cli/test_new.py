"""`curvebound new`: a system of one's own, that builds, runs and passes its tests as it is."""

from __future__ import annotations

import subprocess
import sys
from pathlib import Path

import pytest

from curvebound.cli import main
from curvebound.cosim import load_scene
from curvebound.fmi.folder import find
from curvebound.view.actors import find_actors


@pytest.mark.usefixtures("interpreting", "short_reference")
@pytest.mark.parametrize("dof", [1, pytest.param(2, marks=pytest.mark.slow)])
def test_a_new_system_builds_runs_and_is_drawn_at_once(dof: int, tmp_path: Path, capsys) -> None:
    folder = tmp_path / "my_system"
    assert main(["new", str(folder), "--dof", str(dof)]) == 0
    said = capsys.readouterr().out
    for name in ("fmu.py", "mechanics.py", "drawing.py", "scene.py", "test_my_system.py"):
        assert name in said
        assert len((folder / name).read_text().splitlines()) < 40
    assert main(["build", str(folder), "--out", str(tmp_path), "--no-compile"]) == 0
    assert (tmp_path / "MySystem.fmu").is_file()
    result = load_scene(folder / "scene.py").run()
    drawings = {f"{name}.": one for name, one in result.drawings.items()}
    (actor,) = find_actors(result.data, drawings)
    assert actor.kind == "MySystem"
    assert len(actor.points()) == dof
    assert actor.notes == ()


@pytest.mark.slow
@pytest.mark.parametrize("dof", [1, 2])
def test_what_is_written_passes_its_own_tests(dof: int, tmp_path: Path) -> None:
    folder = tmp_path / "my_system"
    assert main(["new", str(folder), "--dof", str(dof)]) == 0
    command = [sys.executable, "-m", "pytest", "-q", "-p", "no:cacheprovider", str(folder)]
    done = subprocess.run(command, cwd=tmp_path, capture_output=True, text=True)
    assert done.returncode == 0, done.stdout


@pytest.mark.parametrize("name", ["MySystem", "my-system", "2nd", "_x", "x__y", "none"])
def test_a_name_that_no_fmu_can_have_is_refused(name: str, tmp_path: Path, capsys) -> None:
    assert main(["new", str(tmp_path / name)]) == 1
    assert "cannot be the name of a system" in capsys.readouterr().err
    assert list(tmp_path.iterdir()) == []


def test_what_is_there_stays(tmp_path: Path, capsys) -> None:
    (tmp_path / "mine").mkdir()
    assert main(["new", str(tmp_path / "mine")]) == 1
    assert "exists already" in capsys.readouterr().err
    with pytest.raises(Exception, match="no folder of a system"):
        find(tmp_path / "mine")

"""Systems whose folders lie outside the checkout: everything works with nothing changed in src."""

from __future__ import annotations

import re
import shutil
from pathlib import Path

import numpy as np
import pytest

import curvebound
from curvebound.checks import kernel_follows_mechanics
from curvebound.cli import main
from curvebound.cosim import load_scene

SYSTEMS = sorted(path.parent for path in (Path(__file__).parent / "systems").glob("*/fmu.py"))


@pytest.fixture(params=SYSTEMS, ids=lambda path: path.name)
def system(request: pytest.FixtureRequest, tmp_path: Path, monkeypatch) -> Path:
    """A copy of the author's own files, in a working directory of its own."""
    folder = tmp_path / request.param.name
    shutil.copytree(request.param, folder, ignore=shutil.ignore_patterns("__pycache__"))
    assert not folder.resolve().is_relative_to(Path(curvebound.__file__).parents[2])
    monkeypatch.chdir(tmp_path)
    return folder


def name_of(folder: Path) -> str:
    return "".join(word.capitalize() for word in folder.name.split("_"))


@pytest.mark.parametrize("folder", SYSTEMS, ids=lambda path: path.name)
def test_it_takes_few_lines_and_no_derivative_by_hand(folder: Path) -> None:
    text = "".join(path.read_text(encoding="utf-8") for path in folder.glob("*.py"))
    assert len([line for line in text.splitlines() if line.strip()]) <= 60
    assert not re.search(r"\bdiff\b|_rate\b|velocity|acceleration", text)


def test_it_builds_runs_and_is_drawn(system: Path) -> None:
    assert main(["build", system.name, "--no-compile"]) == 0
    assert Path("build", f"{name_of(system)}.fmu").is_file()
    scene = f"{system.name}/scene.py"
    assert main(["run", scene, "--out", "run.csv", "--replay", "run.html"]) == 0
    assert f'"kind":"{name_of(system)}"' in Path("run.html").read_text(encoding="utf-8")
    assert main(["replay", "run.csv", "--system", system.name, "--out", "again.html"]) == 0
    kernel_follows_mechanics(system)
    result = load_scene(system / "scene.py").run()
    (residual,) = (n for n in result.names if n.endswith("energy.residual"))
    (total,) = (n for n in result.names if n.endswith("energy.total"))
    assert np.abs(result[residual]).max() < 1e-5 < 0.1 < np.ptp(result[total])

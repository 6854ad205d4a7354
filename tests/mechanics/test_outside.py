"""Systems whose folders lie outside the checkout: everything works with nothing changed in src."""

from __future__ import annotations

import csv
import re
import shutil
from pathlib import Path

import numpy as np
import pytest

import curvebound
from curvebound.checks import changes_follow_outputs, kernel_follows_mechanics
from curvebound.cli import main
from curvebound.cosim import load_scene

SYSTEMS = sorted(path.parent for path in (Path(__file__).parent / "systems").glob("*/fmu.py"))
#: a parameter for the stability map: the more, the smaller the steps must be
MAPPED = {
    "bead_on_parabola": "wire.bead.damping=10:1000:3:log",
    "pendulum_on_sine": "plant.pivot.damping=10:1000:3:log",
}


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


@pytest.mark.slow  # tests/test_readme_system.py does so with the system of the README
def test_it_builds_runs_and_is_drawn(system: Path) -> None:
    assert main(["build", system.name, "--no-compile"]) == 0
    assert Path("build", f"{name_of(system)}.fmu").is_file()
    scene = f"{system.name}/scene.py"
    assert main(["run", scene, "--out", "run.csv", "--replay", "run.html"]) == 0
    assert f'"kind":"{name_of(system)}"' in Path("run.html").read_text(encoding="utf-8")
    assert main(["replay", "run.csv", "--system", system.name, "--out", "again.html"]) == 0
    kernel_follows_mechanics(system)
    changes_follow_outputs(system)
    result = load_scene(system / "scene.py").run()
    (residual,) = (n for n in result.names if n.endswith("energy.residual"))
    (total,) = (n for n in result.names if n.endswith("energy.total"))
    assert np.abs(result[residual]).max() < 1e-5 < 0.1 < np.ptp(result[total])


@pytest.mark.slow
@pytest.mark.timeout(3600)
def test_it_is_studied_tuned_mapped_and_sampled(system: Path, capsys) -> None:
    scene = f"{system.name}/scene.py"
    assert main(["study", scene, "--quick", "--no-plots"]) == 0
    assert "cheapest setting" in capsys.readouterr().out
    assert list(Path("build", "study").rglob("*.csv"))
    assert main(["tune", scene, "--write"]) == 0
    assert "solver.method" in Path(scene).read_text(encoding="utf-8")
    assert "verified by a run" in capsys.readouterr().out
    mapped = ["--vary", MAPPED[system.name], "--method", "rk4", "--steps", "1e-3:1:8"]
    assert main(["stability", scene, *mapped, "--no-plots"]) == 0
    (table,) = Path("build", "stability").rglob("*_boundaries.csv")
    with table.open(encoding="utf-8", newline="") as lines:
        theory = [float(row["theory_at_rest"]) for row in csv.DictReader(lines)]
    assert theory[0] > 3.0 * theory[1] > 9.0 * theory[2] > 0.0
    assert main(["sample", system.name, "--points", "300", "--out", "sample"]) == 0
    (table,) = Path("sample").rglob("*.csv")
    with table.open(encoding="utf-8", newline="") as lines:
        verdicts = [row["verdict"] for row in csv.DictReader(lines)]
    assert len(verdicts) == 300
    assert verdicts.count("wrong") == verdicts.count("crashed") == 0

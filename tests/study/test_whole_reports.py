"""What studies, maps and sweeps write: tables, pages, sentences and all that is drawn."""

from __future__ import annotations

import json
import math
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest
from fingerprints import as_text, assert_same

from curvebound.cli import study as command
from curvebound.study.precision import lessons, plots, report
from curvebound.study.stability import pictures
from curvebound.study.stability.map_report import write_index, write_map
from curvebound.study.stability.maps import Request
from curvebound.study.stability.probe import ACCURATE, FAILED, INACCURATE, UNSTABLE, Probed
from curvebound.study.stability.stability_map import Column, StabilityMap
from curvebound.study.sweep import Design, axis, heatmap

METHODS = ("explicit_euler", "semi_implicit_euler", "rk4", "implicit", "adaptive", "exact")


def row(method: str, form: str, size: float, macro_step: float, n: int) -> dict[str, Any]:
    """A row of a study as settings give it; the eighth of each family fails."""
    order = {"explicit_euler": 1, "semi_implicit_euler": 1, "adaptive": 1.2}.get(method, 3.97)
    error = 0.3 * (size / 0.1) ** order * (160.0 if form == "none" else 1.0) + 1e-12
    failed = n == 8
    return {
        "purpose": "micro", "form": form, "method": method, "size": size,
        "size_is": "tolerance" if method == "adaptive" else "step", "macro_step": macro_step,
        "algorithm": "", "hold": "zero", "coupling": "gauss_seidel",
        "cpu": 3.27e-6 * 1e-2 / size, "cpu_low": 3.1e-6 * 1e-2 / size,
        "cpu_high": 3.5e-6 * 1e-2 / size, "steps": 100 + n, "evaluations": 4000,
        "energy_residual": 2.0 * error * (1 + 0.1 * n), "drift": error / (1 + n),
        "acceleration_error": None if form == "angle" else 0.5 * error, "kinetic": 9.81,
        "failure": "it failed at 3 s" if failed else "", "error": math.inf if failed else error,
        "numerical": math.inf if failed else 0.9 * error, "modelling": 0.0, "judged": n < 7,
        "judged_until": None if failed else 10.0 - 0.5 * (n == 3), "amplitude": 2.0,
    }  # fmt: skip


def rows() -> list[dict[str, Any]]:
    found = [
        row(method, form, 10.0 ** (-0.5 * n), step, n)
        for method in METHODS
        for form in ("angle", "none")
        for n in range(2, 9)
        for step in (0.1, 0.01)
    ]
    for i, coupling in enumerate(("gauss_seidel", "jacobi", "strang")):
        for n in range(4):
            one = row("rk4", "angle", 1e-4, 0.1 / 2**n, n)
            changed = {"purpose": "macro", "coupling": coupling, "error": 0.01 * (i + 1) / 4**n,
                       "from_continuous": 0.02 * (i + 1) / 2**n}  # fmt: skip
            found.append({**one, **changed})
    return found


REFERENCES = [
    {"what": "the scene", "model": {"plant.model.fidelity": "linear"}, "how": "Taylor series",
     "order": 12, "digits": 30, "uncertainty": {"plant.u": 1e-15, "plant.angle": 2e-14}},
]  # fmt: skip


def study() -> Any:
    scene = SimpleNamespace(name="a scene", description="what it shows & more")
    return SimpleNamespace(
        scene=scene, rows=rows(), paths=["plant.u", "plant.angle"], unit="m, rad", complete=False,
        references=REFERENCES,
    )  # fmt: skip


@pytest.fixture
def drawn(monkeypatch: pytest.MonkeyPatch) -> list[str]:
    """Each figure that is drawn, side by side and stacked, as text."""
    found: list[str] = []

    def keep(draw: Any, out: Path, *, narrow: bool = True) -> list[Path]:
        for stacked in (False, True) if narrow else (False,):
            figure = draw(stacked)
            found.append(f"{out.name} {stacked} {figure and as_text(figure)}")
        return []

    for module in (plots, pictures, heatmap):
        monkeypatch.setattr(module, "save", keep)
    monkeypatch.setattr(report, "_footer", lambda: "a machine")
    return found


def test_a_study(drawn: list[str], tmp_path: Path) -> None:
    page = report.write_study(study(), tmp_path / "one")
    for text in drawn:
        assert_same(f"study {text.partition(' figure')[0][:40]}", text)
    assert len(drawn) == 8
    assert_same("study page", page.read_text())
    assert_same("study table", (tmp_path / "one" / "study.csv").read_text())
    assert_same("study data", (tmp_path / "one" / "study.json").read_text())


def test_an_overview(drawn: list[str], tmp_path: Path) -> None:
    report.write_study(study(), tmp_path / "one", plots=False)
    other = study()
    other.scene.name = "other"
    other.rows = [{**r, "energy_residual": 3.0 * r["energy_residual"]} for r in other.rows[::2]]
    report.write_study(other, tmp_path / "two", plots=False)
    (tmp_path / "three").mkdir()
    (tmp_path / "three" / "study.json").write_text("[]")
    assert drawn == []
    found = report.write_overview(tmp_path)
    assert found is not None
    page, sentences = found
    assert_same("overview sentences", "\n".join(sentences))
    assert_same("overview page", page.read_text())
    assert_same("overview plots", "\n".join(drawn))
    assert report.write_overview(tmp_path / "one") is None


def test_what_a_study_teaches() -> None:
    known = rows()
    assert_same("lessons", "\n".join(lessons.lessons(known, "m, rad")))
    assert_same("crossings", as_text([[a, b] for a, b in lessons.crossings(known)]))
    assert_same("pareto", as_text(lessons.pareto(lessons.usable(known))))
    for bound in (1e-2, 1e-6, 1e-20):
        assert_same(f"cheapest {bound}", as_text(lessons.cheapest(known, bound)))
        assert_same(f"equals {bound}", as_text(lessons.equals(known, bound)))
    named = [f"{lessons.name_of(r)}; {lessons.size_of(r)}; {lessons.spread_of(r)}" for r in known]
    assert_same("names of settings", "\n".join(named))


def test_what_the_command_prints(capsys: pytest.CaptureFixture[str]) -> None:
    from rich.console import Console

    console = Console(width=100)
    command._print(console, study(), Path("a/index.html"))
    assert_same("study printed", capsys.readouterr().out)
    assert_same("study as data", json.dumps(command._as_data(study(), Path("a/index.html"))))


def maps() -> list[StabilityMap]:
    found = []
    for number, method in enumerate(METHODS[:5]):
        columns = []
        for i, value in enumerate(10.0 ** np.arange(-2, 3)):
            kinds = [ACCURATE] * (number + 1) + [INACCURATE] * 3 + [UNSTABLE] * (5 - number)
            kinds += [FAILED] * (i == 2)
            sizes = [float(x) for x in np.geomspace(1e-4, 1.0, len(kinds))]
            probed = {x: Probed(k) for x, k in zip(sizes, kinds, strict=True)}
            columns.append(
                Column(float(value), 10.0 + i, probed, accurate=sizes[number],
                       stable=sizes[number + 3], at_rest=0.1, in_motion=0.05 * (i + 1))
            )  # fmt: skip
        found.append(StabilityMap(method, columns))
    return found


def test_a_map(drawn: list[str], tmp_path: Path) -> None:
    request = Request("bead_on_wire", "bead.wire.radius=0.01:100:5:log")
    page = write_map(request, maps(), "bead_on_wire", "m", tmp_path, plots=False)
    for path in sorted(tmp_path.iterdir()):
        assert_same(f"map {path.name}", path.read_text())
    pictures.draw(maps(), "radius (m)", tmp_path / "a.png")
    assert_same("map drawn", "\n".join(drawn))
    index = write_index([("one & two", page)], tmp_path)
    assert_same("maps index", index.read_text())


@pytest.mark.parametrize("sample", [0, 7])
def test_a_heat_map(sample: int, drawn: list[str], tmp_path: Path, monkeypatch) -> None:
    words = ["a.x=1:100:3:log", "a.y=-1:2:4"] if not sample else ["a.x=1:100", "a.y=-1:2"]
    design = Design([axis(text) for text in words], sample, 3)
    header = ["a.x", "a.y", "max(a.z)", "final(a.z)"]
    known = []
    for i in range(len(design)):
        x, y = design[i].values()
        known.append([x, y, math.nan, math.nan] if i == 4 else [x, y, i * 1.5, -i])
    monkeypatch.setattr(heatmap, "read_sweep", lambda _: (header, known))
    table = tmp_path / "a.csv"
    heatmap.draw_heat_map(table, design, ["max(a.z)", "final(a.z)"], tmp_path / "m")
    assert_same(f"heat map of {sample}", "\n".join(drawn))

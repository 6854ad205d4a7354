"""What `curvebound stability` writes of a map, and what it refuses."""

from __future__ import annotations

import csv
import json
import re
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import pytest

from curvebound.cli import main
from curvebound.errors import CurveboundError
from curvebound.study.stability import maps
from curvebound.study.stability.maps import Request

RADIUS = "bead.wire.radius"
VARY = ["--vary", f"{RADIUS}=1:2:2"]


def test_the_command_writes_table_picture_and_page(tmp_path, capsys) -> None:
    pytest.importorskip("matplotlib")
    arguments = ["--method", "rk4", "--method", "adaptive", "--steps", "1e-3:1:5", "--stop", "2"]
    vary = "bead.wire.radius=0.1:10:3:log"
    out = tmp_path / "maps"
    words = ["stability", "bead_on_wire", "--vary", vary, *arguments, "--out", str(out), "--json"]
    assert main(words) == 0
    folder = out / "bead_on_wire"
    (told,) = json.loads(capsys.readouterr().out)["maps"]
    assert all(Path(told[kind]).is_file() for kind in ("page", "file", "boundaries"))
    assert sorted(p.name for p in folder.iterdir()) == [
        "bead.wire.radius.csv",
        "bead.wire.radius.html",
        "bead.wire.radius.png",
        "bead.wire.radius_boundaries.csv",
        "index.html",
    ]
    with (folder / "bead.wire.radius_boundaries.csv").open() as file:
        rows = list(csv.DictReader(file))
    assert [float(row[RADIUS]) for row in rows] == pytest.approx([0.1, 1.0, 10.0] * 2)
    assert float(rows[0]["stable_below"]) < float(rows[0]["theory_at_rest"])
    assert rows[0]["size_is"] == "step (s)"
    assert rows[3]["size_is"] == "tolerance"
    with (folder / "bead.wire.radius.csv").open() as file:
        verdicts = {row["verdict"] for row in csv.DictReader(file)}
    assert {"accurate", "inaccurate"} <= verdicts
    page = (folder / "bead.wire.radius.html").read_text()
    assert "<svg" in page
    assert "Runs of 2 s" in page


def test_maps_unload_their_fmus_finished_or_not(monkeypatch: pytest.MonkeyPatch) -> None:
    seen: list[Any] = []
    columns = SimpleNamespace(
        make=lambda _, i, value: seen.append(value) or [], close=lambda: seen.append("closed")
    )
    monkeypatch.setattr(maps, "_columns", columns)
    requests = [Request("", vary, methods=()) for vary in ("a.b=1:2:2", "a.b=3")]
    assert list(maps.make_maps(requests)) == [(one, []) for one in requests]
    made = maps.make_maps(requests)
    assert next(made) == (requests[0], [])
    made.close()
    assert seen == [1.0, 2.0, 3.0, "closed", 1.0, 2.0, "closed"]


@pytest.mark.parametrize(
    ("vary", "message"),
    [
        ("bead.wire.radios=1:2:3", "did you mean wire.radius"),
        ("bead.model.formulation=1:2:2", "no start value"),
        ("bead.solver.step=1e-3:1e-2:3", "no start value"),
        ("wire.radius=1:2:3", "vary a parameter of bead"),
    ],
)
def test_a_bad_axis_is_refused_by_name(vary: str, message: str, capsys) -> None:
    assert main(["stability", "bead_on_wire", "--vary", vary, "--no-plots"]) == 1
    said = re.sub(r"\s+", " ", capsys.readouterr().err)
    assert message in said
    assert vary.partition("=")[0] in said


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        (["--vary", "bead.wire.radius"], "is not of the form"),
        (["--vary", "bead.wire.radius=1:2"], "say in how many values"),
        (["--vary", "bead.wire.radius=-1:2:3:log"], "one sign"),
        (["--vary", "bead.wire.radius=1,1"], "given twice"),
        (["--vary", "bead.wire.radius=a,b"], "a map varies numbers"),
        (["--vary", "bead.wire.radius=1:2:100000000"], "100000000 values are more than"),
        ([*VARY, "--steps", "1e-3:1:100000000"], "100000000 steps are more than"),
        ([*VARY, "--steps", "1e-3"], "LOW:HIGH:N"),
        ([*VARY, "--steps", "1e-2:1e-3:4"], "0 < LOW < HIGH"),
        ([*VARY, "--steps", "1e-3:1:1"], "N of 2 or more"),
        ([*VARY, "--set", "bead.bead.mass"], "component.variable=value"),
        ([*VARY, "--set", f"{RADIUS}=3"], f"--vary sets {RADIUS}"),
        ([*VARY, "--set", "bead.solver.method=rk4"], "the map sets bead.solver.method"),
        ([*VARY, "--accuracy", "inf"], "no finite number above zero"),
        ([*VARY, "--stop", "inf"], "no finite number above zero"),
    ],
)
def test_a_malformed_map_is_wrong_usage(arguments: list[str], message: str, capsys) -> None:
    with pytest.raises(SystemExit) as caught:
        main(["stability", "bead_on_wire", "--no-plots", *arguments])
    assert caught.value.code == 2
    assert message in capsys.readouterr().err


def test_a_map_without_one_point_says_why(tmp_path, capsys) -> None:
    few = ["--method", "rk4", "--no-plots", "--out", str(tmp_path)]
    assert main(["stability", "bead_on_wire", *VARY, *few, "--set", "bead.bead.mass=-1"]) == 1
    said = capsys.readouterr().out
    assert "nothing is known at any value: " in said
    assert "bead.mass = -1.0 kg is outside its domain" in said


@pytest.mark.parametrize(
    "arguments",
    [
        ["stability", "bead_on_wire", *VARY, "--no-plots"],
        ["sample", "--points", "2"],
    ],
    ids=lambda arguments: arguments[0],
)
def test_a_folder_that_cannot_be_written_is_refused_first(
    arguments: list[str], tmp_path, capsys, monkeypatch
) -> None:
    monkeypatch.setattr("curvebound.study.stability.maps.make_maps", None)
    monkeypatch.setattr("curvebound.study.stability.sample.run_sample", None)
    (tmp_path / "file").touch()
    assert main([*arguments, "--out", str(tmp_path / "file")]) == 2
    assert re.search("file/.* cannot be written", capsys.readouterr().err)


@pytest.mark.parametrize(
    "arguments",
    [
        ["stability"],
        ["stability", "bead_on_wire"],
        ["stability", "--vary", "a.b=1:2:3"],
        ["stability", "bead_on_wire", *VARY, "--jobs", "0"],
        ["stability", "bead_on_wire", *VARY, "--method", "rk5"],
        ["stability", "bead_on_wire", *VARY, "--points", "3"],
        ["sample", "--accuracy", "1e-3"],
        ["sample", "--points", "0"],
        ["sample", "--tolerance", "nan"],
        ["sample", "--times", "0"],
    ],
    ids=" ".join,
)
def test_wrong_usage_is_told_apart(arguments: list[str], capsys) -> None:
    with pytest.raises(SystemExit) as caught:
        main(arguments)
    assert caught.value.code == 2


def test_a_stop_before_the_start_is_refused() -> None:
    with pytest.raises(CurveboundError, match="after the start"):
        Request("bead_on_wire", "bead.wire.radius=1:2:2", stop=-1.0).made()

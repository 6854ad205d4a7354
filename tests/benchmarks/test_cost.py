"""The command runs through and its JSON has the shape promised. No time is asserted."""

from __future__ import annotations

import json
import shutil
from pathlib import Path

import pytest
from benchmarks import contenders, peers
from benchmarks.__main__ import main
from benchmarks.contenders import REFERENCE_OF
from benchmarks.references import error_of
from benchmarks.results import Settings
from benchmarks.sections import SECTIONS, run_sections

from curvebound.errors import CurveboundError

needs_compiler = pytest.mark.skipif(
    not any(map(shutil.which, ("gcc", "cc"))), reason="needs a C compiler"
)


@needs_compiler
@pytest.mark.slow
def test_quick_run_measures_everything(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    path = tmp_path / "bench.json"
    assert main(["cost", "--quick", "--json", str(path)]) == 0
    printed = capsys.readouterr().out
    assert max(map(len, printed.splitlines())) <= 80
    assert "Targets" in printed
    assert "compiler" in printed

    data = json.loads(path.read_text("utf-8"))
    assert list(data["sections"]) == list(SECTIONS)
    assert {"processor", "compiler", "python", "heyoka", "fmpy", "numpy"} <= set(data["machine"])
    tables = {name: section["tables"] for name, section in data["sections"].items()}

    (kernel,) = tables["kernel"]
    assert len(kernel["rows"]) == 5
    for row in kernel["rows"]:
        # interpreted is some thirty times slower than C: that much can be said on any machine
        assert 0.0 < row["C"] < row["interpreted"]
        assert row["compiled/C"] > 0.0

    assert [table["title"] for table in tables["fmu"]] == ["BeadOnWire", "ParabolaPendulum"]
    for table in tables["fmu"]:
        assert len(table["rows"]) == 5
        assert all(row["C FMU"] > 0.0 and row["our FMU"] > 0.0 for row in table["rows"])

    points = tables["accuracy"][-1]["rows"]
    methods = {(row["system"], row["tool"], row["method"]) for row in points}
    for system in REFERENCE_OF:
        for tool in ("FMU", "kernel"):
            for method in ("explicit_euler", "semi_implicit_euler", "rk4", "adaptive", "implicit"):
                assert (system, tool, method) in methods
    for row in points:
        if row["tool"] in ("FMU", "kernel") and row["method"] == "adaptive":
            assert row["error"] < 1.0
        assert row["ms/s"] > 0.0
    by_kind = {(r["system"], r["tool"], r["method"], r["value"]): r["error"] for r in points}
    for (system, tool, method, value), error in by_kind.items():
        if tool == "FMU":
            assert by_kind[system, "kernel", method, value] == pytest.approx(error, abs=1e-10)

    instances, steps = tables["size"]
    assert {row["FMU"] for row in instances["rows"]} == {"ours", "C"}
    assert all(row["us per step"] > 0.0 for row in (*instances["rows"], *steps["rows"]))
    assert any(row["what"] == "build, cached" for row in tables["startup"][0]["rows"])

    targets = data["targets"]
    assert len(targets) == 23
    assert all(isinstance(t["met"], bool) or t["measured"] is None for t in targets)


def test_only_picks_sections_and_refuses_others(capsys: pytest.CaptureFixture[str]) -> None:
    with pytest.raises(SystemExit) as refused:
        main(["cost", "--only", "speed"])
    assert refused.value.code == 2
    assert "kernel" in capsys.readouterr().err


def test_a_file_that_cannot_be_written_is_refused_before_the_first_measurement(
    monkeypatch: pytest.MonkeyPatch, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.setattr("benchmarks.cost.run_sections", None)
    (tmp_path / "file").touch()
    for path in (tmp_path, tmp_path / "file" / "bench.json"):
        assert main(["cost", "--json", str(path)]) == 2
        assert f"{path} cannot be written" in capsys.readouterr().err.replace("\n", "")


def test_a_section_that_cannot_run_is_left_out_with_the_reason(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    from benchmarks import kernel_section

    def broken() -> object:
        raise CurveboundError("there is no compiler: install gcc")

    monkeypatch.setattr(kernel_section.native, "kernel", broken)
    seen: list[tuple[str, int]] = []
    (section,) = run_sections(
        ["kernel"], Settings(quick=True, rounds=1), lambda name, made: seen.append((name, made))
    )
    assert section.notes == ["there is no compiler: install gcc"]
    assert section.tables == []
    assert seen == [("kernel", 0)]


def test_an_absent_tool_is_a_line(monkeypatch: pytest.MonkeyPatch) -> None:
    def absent(name: str) -> object:
        raise ModuleNotFoundError(name=name)

    monkeypatch.setattr(peers.importlib, "import_module", absent)
    found, lines = peers.peers(quick=True)
    assert found == []
    assert [line.split()[0] for line in lines] == ["scipy", "heyoka", "mujoco"]


@pytest.mark.parametrize(
    ("tool", "setting", "bounds"),
    [
        ("scipy", 1e-9, {"bead, angle": 1e-7, "bead, Cartesian": 1e-5, "pendulum": 1e-6}),
        pytest.param(
            "heyoka",
            1e-10,
            {"bead, angle": 1e-11, "bead, Cartesian": 1e-9, "pendulum": 1e-11},
            marks=pytest.mark.slow,
        ),
        pytest.param(
            "MuJoCo", 1e-3, {"bead, angle": 0.02, "pendulum": 1e-3}, marks=pytest.mark.slow
        ),
    ],
)
def test_peers_solve_the_same_equations(
    tool: str, setting: float, bounds: dict[str, float]
) -> None:
    pytest.importorskip({"scipy": "scipy.integrate"}.get(tool, tool.lower()))
    found = [c for c in peers.peers(quick=True)[0] if c.tool == tool]
    assert {c.system for c in found} == set(bounds)
    for contender in found:
        run = contender.prepare(setting)
        errors = []
        for _ in range(2):  # the second run starts anew
            run.reset()
            run.go()
            errors.append(error_of(contenders.REFERENCE_OF[contender.system], run.state()))
        bound = bounds[contender.system] * (20.0 if contender.method == "LSODA" else 1.0)
        assert errors[0] == errors[1] < bound

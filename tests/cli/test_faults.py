"""What data from outside and the system can do: one line with file, place and remedy."""

from __future__ import annotations

import csv
import os
import subprocess
import sys
from pathlib import Path

import pytest

from curvebound.cli import main
from curvebound.cosim import load_scene
from curvebound.cosim.fmu import extracted

CALL = [sys.executable, "-m", "curvebound"]


def heard(done: subprocess.CompletedProcess[str]) -> str:
    assert "Traceback" not in done.stderr
    return " ".join(done.stderr.split())


@pytest.mark.skipif(not Path("/dev/full").exists(), reason="no /dev/full")
def test_output_that_does_not_fit(tmp_path: Path) -> None:
    with open("/dev/full", "w") as full:
        done = subprocess.run(
            [*CALL, "list"], stdout=full, stderr=subprocess.PIPE, text=True, cwd=tmp_path
        )
    assert done.returncode == 2
    assert heard(done) == "error: No space left on device. Make room there."


def test_names_that_the_terminal_cannot_show(tmp_path: Path) -> None:
    scene = tmp_path / "scene.py"
    scene.write_text(
        "from curvebound.cosim import Scene\n"
        "scene = Scene('größe \\u2192', stop_time=0.02, step=0.01)\n"
        "scene.add('bead', 'BeadOnWire')\n",
        encoding="utf-8",
    )
    done = subprocess.run(
        [*CALL, "run", str(scene)], capture_output=True, text=True, cwd=tmp_path,
        env={**os.environ, "PYTHONIOENCODING": "ascii"},
    )  # fmt: skip
    assert done.returncode == 0, done.stderr
    assert "gr\\xf6\\xdfe" in done.stdout


@pytest.mark.parametrize(
    ("words", "limit", "left"),
    [
        (["run", "bead_on_wire", "--out", "r.csv"], 100_000, []),
        (["run", "bead_on_wire", "--stop", "1", "--replay", "r.html"], 50_000, []),
        (["ssp", "bead_on_wire"], 50_000, []),
        (
            ["sweep", "bead_on_wire", "--set", "stop_time=0.1", "--workers", "1", "--out", "s.csv",
             "--vary", "bead.bead.damping=0:1:100", "--metric", "final(bead.bead.y)"],
            4000,
            ["s.csv", "s.csv.sweep.json"],
        ),
    ],
    ids=["run", "replay", "ssp", "sweep"],
)  # fmt: skip
def test_a_disk_that_fills_up(
    words: list[str], limit: int, left: list[str], tmp_path: Path,
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str],
) -> None:  # fmt: skip
    """No file may grow beyond so many bytes."""
    resource = pytest.importorskip("resource", reason="no limits here")
    extracted(load_scene("bead_on_wire").check().nodes["bead"].fmu)  # which is larger
    monkeypatch.setattr(sys, "dont_write_bytecode", True)  # cut short it would stay
    monkeypatch.chdir(tmp_path)
    before = resource.getrlimit(resource.RLIMIT_FSIZE)
    resource.setrlimit(resource.RLIMIT_FSIZE, (limit, before[1]))
    try:
        assert main(words) == 2
    finally:
        resource.setrlimit(resource.RLIMIT_FSIZE, before)
    assert "cannot be written: File too large" in " ".join(capsys.readouterr().err.split())
    assert sorted(path.name for path in tmp_path.iterdir()) == left
    for name in left[:1]:
        text = (tmp_path / name).read_text()
        rows = list(csv.reader(text.splitlines()))
        assert len(rows) > 2
        assert text.endswith("\n")
        assert {len(row) for row in rows} == {4}, "half a row"


HEAD = "from curvebound.cosim import Scene\nscene = Scene('s', stop_time=1.0, step=0.01)\n"
BEAD = f"{HEAD}scene.add('bead', 'BeadOnWire')\n"


@pytest.mark.parametrize(
    ("script", "words"),
    [
        (
            f"{BEAD}scene.input('bead.wire.ax', lambda t: 1 / 0)\n",
            "drives bead.wire.ax fails at t =",
        ),
        (f"{BEAD}scene.input('bead.wire.ax', lambda t: 'x')\n", "drives bead.wire.ax fails at t ="),
        (f"{BEAD}scene.input('bead.wire.ax', ([0, 'q'], [1, 2]))\n", "bead.wire.ax"),
        (f"{BEAD}scene.input('bead.wire.ax', 'none.csv')\n", "none.csv"),
        (f"{BEAD}scene.components['bead'].start['bead.mass'] = [1, 2]\n", "[1, 2] is not a number"),
        (HEAD.replace("1.0", "'x'"), "stop_time: 'x'"),
        (f"{HEAD}raise SystemExit(0)\n", "ends the program while it is loaded"),
        (f"{HEAD}1 / 0\n", "fails to load: ZeroDivisionError"),
        ("scene = (\n", "fails to load: SyntaxError"),
        ("scene = 5\n", "no variable `scene`"),
        (HEAD, "no components"),
    ],
)
def test_a_script_that_is_wrong(
    script: str, words: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    path = tmp_path / "scene.py"
    path.write_text(script)
    assert main(["run", str(path)]) in (1, 2)
    said = " ".join(capsys.readouterr().err.split())
    assert words in said
    assert "Nobody thought of this" not in said


@pytest.mark.parametrize(
    ("content", "words"),
    [
        (b"time,,x\n0,1,2\n1,2,3\n", ""),
        (b"time,x\n0,99999999999999999999\n1,-2\n", ""),
        (b"time,x\n0," + b"1" * 200_000 + b"\n1,2\n", ""),
        (b"\xff\xfe\x00", "not text"),
        (b"time,time\n0,1\n", "time"),
        (b"time,x\n0,1\n0.5\n1,2\n", "Line 3"),
        (b"time,x\nnan,1\n", "not a number"),
        (b'"time\n', ""),
        (b"", "empty"),
    ],
)
def test_a_table_that_is_odd(
    content: bytes, words: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    path = tmp_path / "odd.csv"
    path.write_bytes(content)
    status = main(["replay", str(path)])
    said = " ".join(capsys.readouterr().err.split())
    assert status == (2 if words or b'"' in content else 0)
    assert words in said
    assert "Nobody thought of this" not in said


@pytest.mark.parametrize(
    "journal", ["", "[1]", '{"identity": 1}', "\xff", '{"a"', "[]\n[]", "5\n5"]
)
def test_a_journal_that_is_none_begins_anew(journal: str, tmp_path: Path) -> None:
    pytest.importorskip("mpmath")
    from curvebound.study.precision.study import Study

    path = tmp_path / "study.jsonl"
    path.write_text(journal, encoding="latin-1")
    assert Study.of(load_scene("bead_on_wire"))._open(path) == {}


def test_what_nobody_thought_of_is_a_line_too(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    def fail() -> None:
        raise ZeroDivisionError("division by zero")

    monkeypatch.setattr("curvebound.cosim.scene_names", fail)
    assert main(["list"]) == 2
    said = " ".join(capsys.readouterr().err.split())
    assert said.startswith("error: ZeroDivisionError: division by zero. Nobody thought of this")

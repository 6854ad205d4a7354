"""Ctrl-C in the middle of a study or a sweep, as a terminal sends it, and the command again."""

from __future__ import annotations

import csv
import json
import os
import signal
import subprocess
import sys
import time
from contextlib import suppress
from pathlib import Path

import pytest

pytest.importorskip("mpmath")
pytestmark = [
    pytest.mark.slow,
    pytest.mark.skipif(sys.platform == "win32", reason="process groups of POSIX"),
]

SCENE = """
from curvebound.cosim import Scene
scene = Scene("short", "a bead", stop_time=0.5, step=0.01, needs={"bead.bead.x": 1e-6})
scene.add("bead", "BeadOnWire", {})
scene.record("bead.bead.*")
"""

#: a worker stops here after some points, where ENDLESS is set: the sweep cannot be done too early
SHAKEN = """
import multiprocessing, os, time
from curvebound.cosim import Scene
calls = 0
def still(t):
    global calls
    calls += 1
    if calls > 3000 and "ENDLESS" in os.environ and multiprocessing.parent_process() is not None:
        time.sleep(1000.0)
    return 0.0
scene = Scene("shaken", "a bead", stop_time=0.5, step=0.01)
scene.add("bead", "BeadOnWire", {})
scene.input("bead.wire.ay", still)
scene.record("bead.bead.*")
"""
POINTS = 400


def interrupted(words: list[str], journal: Path, lines: int) -> subprocess.CompletedProcess[str]:
    """Run `curvebound words`, and interrupt its whole group once `journal` has so many lines."""
    process = subprocess.Popen(
        [sys.executable, "-m", "curvebound", *words],
        stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True, start_new_session=True,
        env={**os.environ, "ENDLESS": "1"},
        # jobs in the background ignore it
        preexec_fn=lambda: signal.signal(signal.SIGINT, signal.SIG_DFL),
    )  # fmt: skip
    try:
        give_up = time.monotonic() + 240.0
        while process.poll() is None and time.monotonic() < give_up:
            if journal.is_file() and journal.read_text().count("\n") >= lines:
                os.killpg(process.pid, signal.SIGINT)  # the group that this test started
                break
            time.sleep(0.02)
        else:
            pytest.fail(f"{words[0]} was not interrupted: exit status {process.poll()}")
        out, err = process.communicate(timeout=120)
    finally:
        with suppress(ProcessLookupError):  # all of it has ended
            os.killpg(process.pid, signal.SIGKILL)
        process.wait(timeout=30)
    return subprocess.CompletedProcess(words, process.returncode, out, err)


def test_a_study_that_is_stopped_keeps_its_rows_and_goes_on(tmp_path: Path) -> None:
    scene = tmp_path / "short.py"
    scene.write_text(SCENE)
    journal = tmp_path / "out" / "short" / "study.jsonl"
    words = ["study", str(scene), "--quick", "--no-plots", "--limit", "0.002",
             "--out", str(tmp_path / "out")]  # fmt: skip
    stopped = interrupted(words, journal, lines=5)
    assert stopped.returncode == 1, stopped.stderr
    assert "The same command goes on from there" in stopped.stdout
    assert "Traceback" not in stopped.stderr
    kept = journal.read_text().splitlines()
    folder = journal.parent
    assert "Unfinished" in (folder / "index.html").read_text()
    assert json.loads((folder / "study.json").read_text())["complete"] is False
    again = subprocess.run(
        [sys.executable, "-m", "curvebound", *words], capture_output=True, text=True, timeout=300
    )
    assert again.returncode == 0, again.stderr
    assert journal.read_text().splitlines()[: len(kept)] == kept  # not measured again
    assert "Unfinished" not in (folder / "index.html").read_text()


def test_a_sweep_that_is_stopped_loses_and_doubles_no_point(tmp_path: Path) -> None:
    out = tmp_path / "a.csv"
    scene = tmp_path / "shaken.py"
    scene.write_text(SHAKEN)
    words = ["sweep", str(scene), "--vary", f"bead.bead.damping=0:1:{POINTS}",
             "--metric", "final(bead.bead.y)", "--workers", "2", "--out", str(out)]  # fmt: skip
    stopped = interrupted(words, out, lines=2)
    assert stopped.returncode == 1, stopped.stderr
    assert "the same command goes on" in stopped.stdout
    assert "Traceback" not in stopped.stderr
    done = len(out.read_text().splitlines()) - 1
    assert 0 < done < POINTS
    again = subprocess.run(
        [sys.executable, "-m", "curvebound", *words], capture_output=True, text=True, timeout=300
    )
    assert again.returncode == 0, again.stderr
    assert f"{done} of them from an earlier run" in again.stdout
    with out.open(newline="") as file:
        assert [row[0] for row in csv.reader(file)][1:] == [str(i) for i in range(POINTS)]

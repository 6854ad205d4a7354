"""Long work is told: a line now and then where there is no terminal."""

from __future__ import annotations

import logging
import re
import time
from collections.abc import Iterator
from pathlib import Path

import pytest

from curvebound import progress
from curvebound.cli import main
from curvebound.cosim import capabilities
from curvebound.fmi import cached
from curvebound.fmi.folder import Folder
from curvebound.progress import Progress, duration


@pytest.fixture
def lines(monkeypatch: pytest.MonkeyPatch) -> Iterator[list[str]]:
    """What the log gets, at a line every 0.05 s."""
    found: list[str] = []

    class Keep(logging.Handler):
        def emit(self, record: logging.LogRecord) -> None:
            found.append(record.getMessage())

    log, handler = logging.getLogger("curvebound"), Keep()
    before = log.level
    log.addHandler(handler)
    log.setLevel("INFO")
    monkeypatch.setattr(progress, "EVERY", 0.05)
    yield found
    log.removeHandler(handler)
    log.setLevel(before)


def test_a_line_is_promised_every_20_s() -> None:
    assert progress.EVERY <= 20.0


def test_lines_come_without_news_too_and_end_with_the_work(lines: list[str]) -> None:
    with Progress("study of s", 8, "settings") as tell:
        tell(2, note="rk4")
        time.sleep(0.5)
    count = len(lines)
    assert count >= 3
    assert re.fullmatch(
        r"study of s: 2 of 8 settings \(rk4\), after \d+ s, about \d+ s left", lines[0]
    )
    time.sleep(0.2)
    assert len(lines) == count


def test_what_is_left_is_in_proportion() -> None:
    one = Progress("x", 4)
    one._began = time.monotonic() - 100.0
    one._done = 1.0
    assert one.line() == "x: 1 of 4, after 1 min 40 s, about 5 min 0 s left"
    one._total = None
    assert one.line() == "x, after 1 min 40 s"


def test_nothing_is_written_below_the_level(lines: list[str]) -> None:
    logging.getLogger("curvebound").setLevel("WARNING")
    with Progress("x") as tell:
        tell(1)
        time.sleep(0.2)
    assert lines == []


@pytest.mark.parametrize(
    ("seconds", "said"),
    [(0.2, "0 s"), (59.4, "59 s"), (60, "1 min 0 s"), (3599, "59 min 59 s"), (7500, "2 h 5 min")],
)
def test_times_in_words(seconds: float, said: str) -> None:
    assert duration(seconds) == said


def test_a_terminal_gets_a_bar(monkeypatch: pytest.MonkeyPatch, lines: list[str]) -> None:
    monkeypatch.setattr("sys.stderr.isatty", lambda: True, raising=False)
    with Progress("study of s", 8, "settings") as tell:
        tell(2)
        assert tell._bar is None, "not in the first second"
        monkeypatch.setattr(progress, "_SOON", -1.0)
        tell(3, note="rk4")
        (task,) = tell._bar.tasks
        assert (task.description, task.completed, task.total) == ("study of s", 3, 8)
        assert task.fields == {"far": "3/8 settings", "note": "rk4"}
        tell(4.5, 9, label="more")
        assert (task.description, task.completed, task.total) == ("more", 4.5, 9)
        assert task.fields == {"far": "4.5/9 settings", "note": ""}
        assert tell._bar.live.is_started
    assert not tell._bar.live.is_started
    assert lines == []
    with Progress("x") as tell:
        tell(1.0)
        assert tell._bar.tasks[0].fields == {"far": "", "note": ""}


@pytest.mark.parametrize(
    ("done", "total", "unit", "note", "said"),
    [
        (1.0, 4.0, "s", "a", "x: 1 of 4 s (a), after 20 s, about 1 min 0 s left"),
        (0.0, 4.0, "", "", "x: 0 of 4, after 20 s"),
        (4.0, 4.0, "", "", "x: 4 of 4, after 20 s, about 0 s left"),
        (5.0, 4.0, "", "", "x: 5 of 4, after 20 s"),
        (3.0, None, "s", "b", "x (b), after 20 s"),
    ],
)
def test_lines(done: float, total: float | None, unit: str, note: str, said: str) -> None:
    one = Progress("x", total, unit)
    one._began, one._done, one._note = time.monotonic() - 20.0, done, note
    assert one.line() == said


def test_a_run_that_builds_first_says_so(
    lines: list[str], monkeypatch: pytest.MonkeyPatch, interpreted_fmus: Path
) -> None:
    def slowly(folder: Folder) -> Path:
        time.sleep(0.5)
        return interpreted_fmus / f"{folder.name}.fmu"

    monkeypatch.setattr(cached, "cached_fmu", slowly)
    monkeypatch.setattr(capabilities, "_BUILT", {})
    assert main(["run", "bead_on_wire", "--stop", "0.01"]) == 0
    assert lines[0].startswith("building BeadOnWire, after")
    building = [line.startswith("building") for line in lines]
    assert building == sorted(building, reverse=True)  # the run is not told of before it began

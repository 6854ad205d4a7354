"""The machinery knows no system: no word of one stands in the rooms that are done."""

from __future__ import annotations

import re
from pathlib import Path

import curvebound

_PACKAGE = Path(curvebound.__file__).parent
_WORDS = re.compile(r"bead|slider|pendulum|parabola|\bwires?\b|\bbobs?\b", re.IGNORECASE)
#: rooms where words of a system still stand
_TO_DO = ("bench", "cli", "cosim", "fmi", "integrators", "models", "study")
_FOREIGN = ("uPlot.iife.min.js", "uPlot.min.css", "uPlot.LICENSE")


def test_no_word_of_a_system_in_the_machinery() -> None:
    found = []
    for path in sorted(_PACKAGE.rglob("*")):
        room = path.relative_to(_PACKAGE).parts[0]
        if room in (*_TO_DO, "_fmus", "_scenarios") or path.name in _FOREIGN:
            continue
        if path.suffix in (".py", ".js", ".css", ".html", ".c", ".h"):
            lines = path.read_text(encoding="utf-8").splitlines()
            found += [f"{path}:{n}: {s}" for n, s in enumerate(lines, 1) if _WORDS.search(s)]
    assert not found, "\n".join(found)


def test_no_room_is_listed_as_unfinished_that_is_done() -> None:
    for room in _TO_DO:
        path = _PACKAGE / room
        files = [path] if path.is_file() else sorted(path.rglob("*.py"))
        assert any(_WORDS.search(file.read_text(encoding="utf-8")) for file in files), room

"""The machinery knows no system: no word of one stands in it.

Docstrings may name one in an example.
"""

from __future__ import annotations

import ast
import re
from collections.abc import Iterator
from pathlib import Path

import curvebound

_PACKAGE = Path(curvebound.__file__).parent
_WORDS = re.compile(r"bead|slider|pendulum|parabola|\bwires?\b|\bbobs?\b", re.IGNORECASE)
_FOREIGN = {"uPlot.iife.min.js", "uPlot.min.css", "uPlot.LICENSE"}


def _room(path: Path) -> str:
    return path.relative_to(_PACKAGE).parts[0]


def _docstrings(text: str) -> set[int]:
    """The numbers of the lines that docstrings take."""
    taken: set[int] = set()
    for node in ast.walk(ast.parse(text)):
        if isinstance(node, ast.Module | ast.ClassDef | ast.FunctionDef) and ast.get_docstring(
            node
        ):
            first = node.body[0]
            taken.update(range(first.lineno, (first.end_lineno or first.lineno) + 1))
    return taken


def _found(path: Path) -> Iterator[str]:
    """The lines with a word of a system, docstrings aside."""
    text = path.read_text(encoding="utf-8")
    if not _WORDS.search(text):
        return
    told = _docstrings(text) if path.suffix == ".py" else set()
    for number, line in enumerate(text.splitlines(), 1):
        if number not in told and _WORDS.search(line):
            yield f"{path}:{number}: {line}"


def _sources() -> list[Path]:
    return [
        path
        for path in sorted(_PACKAGE.rglob("*"))
        if path.suffix in (".py", ".js", ".css", ".html", ".c", ".h")
        and path.name not in _FOREIGN
        and _room(path) not in ("_fmus", "_scenarios")
    ]


def test_no_word_of_a_system_in_the_machinery() -> None:
    found = [line for path in _sources() for line in _found(path)]
    assert not found, "\n".join(found)

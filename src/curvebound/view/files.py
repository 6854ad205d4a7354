"""The files that the pages are made of, and writing a page."""

from __future__ import annotations

from importlib.resources import files
from pathlib import Path

from ..files import write_whole

__all__ = ["asset", "write_text"]


def asset(name: str) -> str:
    """The text of a file in view/assets."""
    return (files(__package__) / "assets" / name).read_text(encoding="utf-8")


def write_text(out: Path, text: str) -> Path:
    """Write `text` to `out`, whole or not at all; CurveboundError where that is impossible."""
    return write_whole(out, lambda path: path.write_text(text, encoding="utf-8", newline="\n"))

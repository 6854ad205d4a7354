"""The files that pages are made of: scripts, styles and the bodies of the pages."""

from __future__ import annotations

from importlib.resources import files

__all__ = ["asset"]


def asset(name: str) -> str:
    """The text of a file in view/assets."""
    return (files(__package__) / "assets" / name).read_text(encoding="utf-8")

"""The files that pages are made of: scripts, styles and the bodies of the pages."""

from __future__ import annotations

from importlib.resources import files

from ..pages import common_style

__all__ = ["asset", "scene_script", "scene_style"]

#: what replays and live scenes share, each file after those that it needs when it is read
_SHARED = (
    "data.js",
    "format.js",
    "formula.js",
    "ruler.js",
    "arrows.js",
    "scene.js",
    "shared.js",
    "bounds.js",
    "saving.js",
    "decimate.js",
    "plots.js",
    "phase.js",
    "gestures.js",
    "page.js",
)


def asset(name: str) -> str:
    """The text of a file in view/assets."""
    return (files(__package__) / "assets" / name).read_text(encoding="utf-8")


def scene_script(*own: str) -> str:
    """The script of a page with a drawing and plots, whose own files are `own`."""
    ours = "\n".join(map(asset, (*_SHARED, *own)))
    return f'{asset("uPlot.iife.min.js")}\n(() => {{\n"use strict";\n{ours}}})();\n'


def scene_style(*own: str) -> str:
    """The style of such a page, whose own files are `own`."""
    parts = asset("uPlot.min.css"), common_style(), *map(asset, ("replay.css", *own))
    return "\n".join(parts)

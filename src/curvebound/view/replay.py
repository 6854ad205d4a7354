"""Writes results as one HTML file that replays them in any present-day browser."""

from __future__ import annotations

import html
from collections.abc import Sequence
from pathlib import Path
from typing import Any

from numpy.typing import NDArray

from ..cosim.results import Result
from ..fmi.drawing import Drawing
from ..pages import common_style, document, embedded_json, filled, write_page
from .asset_files import asset
from .model import build_model

__all__ = ["write_replay"]

_SCRIPTS = (
    "data.js",
    "format.js",
    "formula.js",
    "ruler.js",
    "scene.js",
    "plots.js",
    "shared.js",
    "gestures.js",
    "player.js",
    "controls.js",
    "replay.js",
)


def write_replay(
    results: Sequence[tuple[str, Result | NDArray[Any]]],
    out: Path,
    title: str | None = None,
    notes: Sequence[str] = (),
    known: Sequence[Drawing] = (),
) -> Path:
    """Write `results`, pairs of a label and a Result or structured array, as a page to `out`.

    Columns are `time` in s and `component.variable` or plain `variable` in SI units; those of a
    structured array are recognised as a system's of the package or of the drawings `known`. Several
    results share one picture, each in a colour of its own, with their distance from the first.
    `notes` are shown above the picture. Raises CurveboundError where a result cannot be shown.
    """
    if title is None:
        title = " and ".join(label for label, _ in results)
    model, packer = build_model(results, title, notes, known)
    ours = "\n".join(asset(name) for name in _SCRIPTS)
    body = filled(
        asset("replay.html"),
        {
            "title": html.escape(title),
            "licence": asset("uPlot.LICENSE"),
            "model": embedded_json(model),
            "samples": packer.base64(),
        },
    )
    text = document(
        title,
        body,
        style=asset("uPlot.min.css") + "\n" + common_style() + asset("replay.css"),
        script=f'{asset("uPlot.iife.min.js")}\n(() => {{\n"use strict";\n{ours}}})();\n',
    )
    return write_page(out, text)

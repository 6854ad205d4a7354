"""Writes results as one HTML file that replays them in any present-day browser."""

from __future__ import annotations

import html
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any, NamedTuple
from urllib.parse import quote

from numpy.typing import NDArray

from ..cosim.differences import Difference
from ..cosim.results import Result
from ..files import inside
from ..fmi.drawing import Drawing
from ..pages import document, embedded_json, filled, write_page
from .asset_files import asset, scene_script, scene_style
from .model import build_model

__all__ = ["About", "pages_beside", "write_replay"]


class About(NamedTuple):
    """What a replay tells of its results.

    text: what they show, one line. differing: the settings in which they differ, a value for each.
    links: pages, relative to the replay's folder, by what they are called.
    """

    text: str = ""
    differing: Sequence[Difference] = ()
    links: Mapping[str, str] = {}


def pages_beside(folder: Path, scene: str) -> dict[str, str]:
    """Links of a replay in `folder` to the pages of its scene that are there, by what they are."""
    found = {}
    for words, part in (("Study", "study"), ("Stability", "stability")):
        page = inside(folder / part, scene) / "index.html"
        if page.is_file():
            found[words] = quote(page.relative_to(folder).as_posix())
    return found


def write_replay(
    results: Sequence[tuple[str, Result | NDArray[Any]]],
    out: Path,
    title: str | None = None,
    notes: Sequence[str] = (),
    known: Sequence[Drawing] = (),
    about: About | None = None,
) -> Path:
    """Write `results`, pairs of a label and a Result or structured array, as a page to `out`.

    Columns are `time` in s and `component.variable` or plain `variable` in SI units; those of a
    structured array are recognised as a system's of the package or of the drawings `known`. Several
    results share one picture, each in a colour of its own, with their distance from the first.
    `notes` are shown above the picture, as is what it is `about`. Raises CurveboundError where a
    result cannot be shown.
    """
    if title is None:
        title = " and ".join(label for label, _ in results)
    model, packer = build_model(results, title, notes, known)
    about = about or About()
    model["about"] = {
        "text": about.text,
        "differing": [one._asdict() for one in about.differing],
        "links": dict(about.links),
    }
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
        style=scene_style(),
        script=scene_script("player.js", "controls.js", "about.js", "replay.js"),
    )
    return write_page(out, text)

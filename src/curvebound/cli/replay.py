"""Replay results in the browser: one HTML file that opens from disk and loads nothing.

Several results of one scene share one picture, each in a colour of its own, with the distance
from the first over time. A result is named after its file, or as told: LABEL=FILE. What its columns
are of is recognised where it is a system of ours, of a folder `systems` beside the file or here, or
of --system.

examples:
  curvebound replay bead.csv --open
  curvebound replay exact=fine.csv "h = 1/60"=cheap.csv --out compare.html
  curvebound replay bead.csv --picture bead.png --gif bead.gif
  curvebound replay mine.csv --system MySystem.fmu
"""

from __future__ import annotations

import argparse
from pathlib import Path
from typing import TYPE_CHECKING

from ..arguments import file_of
from ..output import say
from . import movies

if TYPE_CHECKING:
    from ..fmi.drawing import Drawing

NAME = "replay"
HELP = "replay results in the browser, side by side"


def configure(parser: argparse.ArgumentParser) -> None:
    """Add the arguments."""
    parser.add_argument(
        "results",
        nargs="+",
        metavar="[LABEL=]FILE.csv",
        help="results, the first being the one that the others are compared with",
    )
    parser.add_argument(
        "--out",
        type=file_of(".html", ".htm"),
        metavar="FILE.html",
        help="default: beside the first result",
    )
    parser.add_argument("--title", help="heading of the page (default: the labels)")
    parser.add_argument(
        "--picture", type=file_of(".png"), metavar="FILE.png", help="also draw a still picture"
    )
    movies.configure(parser)
    parser.add_argument(
        "--system",
        action="append",
        default=[],
        metavar="SYSTEM",
        help="a system of the results: its folder, or its FMU; may be repeated",
    )
    parser.add_argument("--open", action="store_true", help="open the page in the browser")


def run(options: argparse.Namespace) -> int:
    """Read, write, say where."""
    from ..errors import CurveboundError
    from ..fmi.folder import BESIDE, systems_in
    from ..view import read_result, write_picture, write_replay

    paths = [_split(text) for text in options.results]
    labels = _labels(paths)
    results, notes = [], []
    for label, (_, path) in zip(labels, paths, strict=True):
        reading = read_result(path)
        results.append((label, reading.data))
        notes += [f"{label}: {note}" for note in reading.notes]
    known = [_drawing(given) for given in options.system]
    for place in dict.fromkeys([*(path.parent.resolve() for _, path in paths), Path.cwd()]):
        for system in systems_in(place / BESIDE):
            try:
                known.append(system.drawing())
            except CurveboundError as error:
                notes.append(str(error))
    out = options.out or paths[0][1].with_suffix(".html")
    if out.resolve() in [path.resolve() for _, path in paths]:
        raise CurveboundError(f"{out} is one of the results: give the page another name, --out.")
    write_replay(results, out, options.title, notes, known)
    written = [out]
    if options.picture:
        written.append(
            write_picture(results, options.picture, options.title, known, options.arrows)
        )
    written += movies.write(results, options, known)
    for note in notes:
        say(options, f"note: {note}")
    for path in written:
        size = "" if path.is_dir() else f" ({path.stat().st_size / 1e6:.2f} MB)"
        say(options, f"{path}{size}")
    if options.open:
        import webbrowser

        webbrowser.open(out.resolve().as_uri())
    return 0


def _drawing(given: str) -> Drawing:
    """The drawing of a system, from its folder or its FMU."""
    from ..cosim.fmu import read_fmu
    from ..errors import CurveboundError
    from ..fmi.folder import find

    if not given.lower().endswith(".fmu"):
        return find(given).drawing()
    drawing = read_fmu(Path(given)).drawing
    if drawing is None:
        raise CurveboundError(
            f"{given} carries no drawing: it was not built by curvebound; give another --system"
        )
    return drawing


def _split(text: str) -> tuple[str | None, Path]:
    """LABEL=FILE, unless a file of that very name exists."""
    label, sign, rest = text.rpartition("=")
    if sign and label and rest and not Path(text).exists():
        return label, Path(rest)
    return None, Path(text)


def _labels(paths: list[tuple[str | None, Path]]) -> list[str]:
    """Names that differ: the files' own, with as much of their folders as it takes."""
    depth = 1
    while True:
        labels = [label or "/".join((*path.parts[-depth:-1], path.stem)) for label, path in paths]
        if len(set(labels)) == len(labels):
            return labels
        if depth > max(len(path.parts) for _, path in paths):
            return [f"{label} ({number})" for number, label in enumerate(labels, 1)]
        depth += 1

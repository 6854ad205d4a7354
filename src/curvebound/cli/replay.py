"""Replay results in the browser: one HTML file that opens from disk and loads nothing.

Several results of one scene share one picture, each in a colour of its own, with the distance
from the first over time. A result is named after its file, or as told: LABEL=FILE.

examples:
  curvebound replay bead.csv --open
  curvebound replay exact=fine.csv "h = 1/60"=cheap.csv --out compare.html
  curvebound replay bead.csv --picture bead.png --gif bead.gif
"""

from __future__ import annotations

import argparse
from pathlib import Path

from ..arguments import file_of

NAME = "replay"
HELP = "replay results in the browser, side by side"


def configure(parser: argparse.ArgumentParser) -> None:
    """Add the arguments."""
    import shtab

    results = parser.add_argument(
        "results",
        nargs="+",
        metavar="[LABEL=]FILE.csv",
        help="results, the first being the one that the others are compared with",
    )
    results.complete = shtab.FILE  # type: ignore[attr-defined]
    parser.add_argument(
        "--out", type=Path, metavar="FILE.html", help="default: beside the first result"
    )
    parser.add_argument("--title", help="heading of the page (default: the labels)")
    parser.add_argument(
        "--picture", type=file_of(".png"), metavar="FILE.png", help="also draw a still picture"
    )
    parser.add_argument(
        "--gif", type=file_of(".gif"), metavar="FILE.gif", help="also draw an animated picture"
    )
    parser.add_argument("--open", action="store_true", help="open the page in the browser")


def run(options: argparse.Namespace) -> int:
    """Read, write, say where."""
    from ..view import read_result, write_gif, write_picture, write_replay

    paths = [_split(text) for text in options.results]
    labels = _labels(paths)
    results, notes = [], []
    for label, (_, path) in zip(labels, paths, strict=True):
        reading = read_result(path)
        results.append((label, reading.data))
        notes += [f"{label}: {note}" for note in reading.notes]
    out = options.out or paths[0][1].with_suffix(".html")
    write_replay(results, out, options.title, notes)
    written = [out]
    if options.picture:
        written.append(write_picture(results, options.picture, options.title))
    if options.gif:
        written.append(write_gif(results, options.gif))
    for note in notes:
        print(f"note: {note}")
    for path in written:
        print(f"{path} ({path.stat().st_size / 1e6:.2f} MB)")
    if options.open:
        import webbrowser

        webbrowser.open(out.resolve().as_uri())
    return 0


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

"""The options that ask for moving pictures, and what they write: for `run` and `replay`."""

from __future__ import annotations

import argparse
from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING

from ..arguments import file_of, positive, whole

if TYPE_CHECKING:
    from ..fmi.drawing import Drawing
    from ..view.reading import Results

__all__ = ["asked", "configure", "write"]


def configure(parser: argparse.ArgumentParser) -> None:
    """Add the options."""
    parser.add_argument(
        "--arrows", default="", metavar="NAMES",
        help="in pictures, still or moving: arrows such as velocity,gravity by their names; or all",
    )  # fmt: skip
    group = parser.add_argument_group("moving pictures")
    group.add_argument(
        "--gif", type=file_of(".gif"), metavar="FILE.gif", help="an animated picture"
    )
    group.add_argument(
        "--mp4", type=file_of(".mp4"), metavar="FILE.mp4", help="a film, where ffmpeg is installed"
    )
    group.add_argument(
        "--frames", type=Path, metavar="DIR", help="each frame as a PNG, for other programs"
    )
    group.add_argument("--seconds", type=positive, default=10.0, metavar="T", help="default: 10")
    group.add_argument("--fps", type=whole(1), default=25, metavar="N", help="default: 25")
    group.add_argument("--size", type=whole(64), default=420, metavar="PIXELS", help="default: 420")
    group.add_argument(
        "--transparent", action="store_true", help="no paper behind the drawing (not in MP4)"
    )


def asked(options: argparse.Namespace) -> bool:
    """Whether any of them is wanted."""
    return any(one is not None for one in (options.gif, options.mp4, options.frames))


def write(
    results: Results, options: argparse.Namespace, known: Sequence[Drawing] = ()
) -> list[Path]:
    """Write what was asked for; the files, of frames their folder."""
    if not asked(options):
        return []
    from ..view import Movie, write_frames, write_gif, write_mp4

    movie = Movie(options.seconds, options.fps, options.size, options.transparent, options.arrows)
    written = []
    if options.gif is not None:
        written.append(write_gif(results, options.gif, known, movie))
    if options.mp4 is not None:
        written.append(write_mp4(results, options.mp4, known, movie))
    if options.frames is not None:
        write_frames(results, options.frames, known, movie)
        written.append(options.frames)
    return written

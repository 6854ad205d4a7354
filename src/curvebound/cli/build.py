"""Build FMUs: those that come with curvebound, or those named.

examples:
  curvebound build BeadOnWire --out fmus/
  curvebound build path/to/my_system
  curvebound build --for inverted_balance --out fmus/
"""

from __future__ import annotations

import argparse
from pathlib import Path
from typing import TYPE_CHECKING

from ..errors import CurveboundError
from ..output import console_of, hand_out
from ..progress import Progress

if TYPE_CHECKING:
    from ..fmi.folder import Folder

NAME = "build"
HELP = "build the FMUs"
AS_JSON = True


def configure(parser: argparse.ArgumentParser) -> None:
    """Add the arguments."""
    parser.add_argument(
        "name",
        nargs="*",
        metavar="NAME",
        help="an FMU, or a system's folder (default: all of ours)",
    )
    parser.add_argument(
        "--out", type=Path, default=Path("build"), metavar="DIR", help="folder (default: build/)"
    )
    parser.add_argument(
        "--for",
        dest="scene",
        metavar="SCENE",
        help="the FMUs of this scene's components, with its start values as defaults and only the "
        "variables that it sets, drives, connects, records or bounds",
    )
    parser.add_argument(
        "--cross-check",
        type=Path,
        metavar="DIR",
        help="write the layout of the FMI Cross-Check to DIR/NAME instead",
    )
    parser.add_argument(
        "--no-compile",
        action="store_true",
        help="leave out the compiled kernel: smaller, runs interpreted everywhere",
    )
    parser.add_argument(
        "--with-python",
        action="store_true",
        help="put this Python into the FMU (Linux; about 4 MB), for machines without any",
    )


def run(options: argparse.Namespace) -> int:
    """Build and say in one line per FMU what was done."""
    from ..files import sole_writer
    from ..fmi.build import build
    from ..fmi.folder import find, names

    console = console_of(options)
    made = []
    systems: list[Folder]
    if options.scene is not None:
        if options.name or options.cross_check is not None:
            raise CurveboundError("--for SCENE builds that scene's FMUs: name no other ones.")
        from ..cosim import load_scene
        from ..cosim.scene_fmus import specialised

        systems = [*specialised(load_scene(options.scene))]
    else:
        systems = [find(name) for name in options.name or names()]
    for which in systems:
        name = which.name
        if options.cross_check is not None:
            from ..fmi.cross_check import write_cross_check

            place = options.cross_check / f"{name}.fmu"
            with sole_writer(place, wait=True), Progress(f"building {name}"):
                folder = write_cross_check(
                    str(which.path), options.cross_check, compiled=not options.no_compile
                )
            console.print(f"{folder}: FMU, reference result, bounds", soft_wrap=True, markup=False)
            made.append({"name": name, "path": str(folder)})
            continue
        with sole_writer(options.out / f"{name}.fmu", wait=True), Progress(f"building {name}"):
            built = build(
                which,
                options.out,
                compiled=not options.no_compile,
                with_python=options.with_python,
            )
        for line in (built.message, *built.notes):
            console.print(line, soft_wrap=True, markup=False)
        made.append({**built._asdict(), "path": str(built.path)})
    hand_out(options, made)
    return 0

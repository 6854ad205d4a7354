"""Build FMUs: those that come with curvebound, or those named.

examples:
  curvebound build BeadOnWire --out fmus/
  curvebound build path/to/my_system
"""

from __future__ import annotations

import argparse
from pathlib import Path

NAME = "build"
HELP = "build the FMUs"


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

    systems = [(name, find(name).name) for name in options.name or names()]
    for which, name in systems:
        if options.cross_check is not None:
            from ..fmi.cross_check import write_cross_check

            with sole_writer(options.cross_check / f"{name}.fmu", wait=True):
                folder = write_cross_check(
                    which, options.cross_check, compiled=not options.no_compile
                )
            print(f"{folder}: FMU, reference result, bounds", flush=True)
            continue
        with sole_writer(options.out / f"{name}.fmu", wait=True):
            built = build(
                which,
                options.out,
                compiled=not options.no_compile,
                with_python=options.with_python,
            )
        print(built.message, flush=True)
    return 0

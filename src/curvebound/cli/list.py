"""List scenes and FMUs with their variables.

examples:
  curvebound list
  curvebound list ParabolaDrive
  curvebound list others/Plant.fmu
"""

from __future__ import annotations

import argparse
from pathlib import Path

from ..errors import CurveboundError

NAME = "list"
HELP = "show scenes, FMUs and their variables"


def configure(parser: argparse.ArgumentParser) -> None:
    """Add the arguments."""
    parser.add_argument(
        "name",
        nargs="*",
        metavar="NAME",
        help="only these FMUs, by name, file or system's folder (default: all of ours)",
    )


def run(options: argparse.Namespace) -> int:
    """Print one table of scenes and one per FMU."""
    from rich.console import Console
    from rich.markup import escape
    from rich.table import Table

    from ..cosim import load_scene, scene_names
    from ..cosim.fmu import read_fmu
    from ..fmi.folder import find, names
    from .show import show_fmu

    console = Console(highlight=False)
    if not options.name:
        scenes = Table("scene", "what it shows", box=None, pad_edge=False)
        for scene in scene_names():
            try:
                shows = load_scene(scene).description
            except CurveboundError as error:  # the others are worth listing all the same
                shows = str(error)
            scenes.add_row(scene, escape(shows))
        console.print(scenes)
    for name in options.name or names():
        if Path(name).suffix.lower() == ".fmu":
            show_fmu(console, read_fmu(Path(name)))
            continue
        fmu = find(name).fmu()
        table = Table(
            "variable", "kind", "unit", "start", title=f"\n{fmu.name}: {fmu.description}",
            title_justify="left", box=None, pad_edge=False,
        )  # fmt: skip
        for variable in fmu.ordered():
            start = ""
            if variable.type:
                start = variable.type.items[int(variable.start) - 1][0]
            elif variable.kind not in ("output", "count"):
                start = f"{variable.start:g}"
            kind = variable.kind.replace("choice", "enumeration").replace("count", "integer")
            table.add_row(variable.name, kind, variable.unit, start)
        console.print(table)
    return 0

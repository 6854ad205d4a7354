"""List scenes and FMUs, or the variables of FMUs.

examples:
  curvebound list
  curvebound list ParabolaDrive
  curvebound list others/Plant.fmu --json
"""

from __future__ import annotations

import argparse
import textwrap
from pathlib import Path
from typing import TYPE_CHECKING, Any

from ..errors import CurveboundError
from ..output import console_of, hand_out

if TYPE_CHECKING:
    from ..fmi.declaration import Fmu, Variable

NAME = "list"
HELP = "show scenes, FMUs and their variables"
AS_JSON = True

_TYPES = {"choice": "Enumeration", "count parameter": "Integer"}
_CAUSALITIES = {"choice": "parameter", "count parameter": "parameter", "count": "output"}


def configure(parser: argparse.ArgumentParser) -> None:
    """Add the arguments."""
    parser.add_argument(
        "name",
        nargs="*",
        metavar="NAME",
        help="the variables of these FMUs, by name, file or system's folder",
    )


def run(options: argparse.Namespace) -> int:
    """Print what there is, or the variables of what was named."""
    if options.name:
        return _variables(options)
    scenes, fmus = _scenes(), _fmus()
    if options.json:
        hand_out(options, {"scenes": scenes, "fmus": fmus})
        return 0
    width = 2 + max(len(name) for name in (*scenes, *fmus))
    for title, entries in (("scenes", scenes), ("FMUs", fmus)):
        print(title)
        for name, told in entries.items():
            lines = textwrap.wrap(told, _columns() - width - 2) or [""]
            print(f"  {name:{width}}{lines[0]}".rstrip())
            for line in lines[1:]:
                print(f"  {'':{width}}{line}")
    print("\nMore of each, variables too: curvebound show NAME")
    return 0


def _columns() -> int:
    import shutil

    return max(60, shutil.get_terminal_size().columns)


def _scenes() -> dict[str, str]:
    """The description of each scene by name, or why it has none."""
    from ..cosim import load_scene, scene_names

    found = {}
    for name in scene_names():
        try:
            found[name] = load_scene(name).description
        except CurveboundError as error:  # the others are worth listing all the same
            found[name] = str(error)
    return found


def _fmus() -> dict[str, str]:
    from ..fmi.folder import find, names

    return {name: find(name).declaration().description for name in names()}


def _variables(options: argparse.Namespace) -> int:
    from ..fmi.folder import find
    from .show import show_fmu

    data = []
    for name in options.name:
        if Path(name).suffix.lower() == ".fmu":
            from ..cosim.fmu import read_fmu
            from .show import fmu_data

            data.append(fmu_data(read_fmu(Path(name))))
        else:
            data.append(_as_data(find(name).declaration()))
    hand_out(options, {"fmus": data})
    if not options.json:
        console = console_of(options)
        for one in data:
            show_fmu(console, one)
    return 0


def _as_data(fmu: Fmu) -> dict[str, Any]:
    """An FMU's declaration in the form of show.fmu_data, as far as it goes, without building it."""
    return {
        "name": fmu.name,
        "description": fmu.description,
        "variables": [
            {
                "name": variable.name,
                "description": variable.description,
                "type": _TYPES.get(variable.kind, "Real"),
                "causality": _CAUSALITIES.get(variable.kind, variable.kind),
                "variability": "tunable" if variable.tunable else None,
                "unit": variable.unit,
                "start": _start(variable),
            }
            for variable in fmu.ordered()
        ],
    }


def _start(variable: Variable) -> float | str | None:
    if variable.type:
        return variable.type.items[int(variable.start) - 1][0]
    return None if variable.kind in ("output", "count") else variable.start

"""Write the folder of a system of your own, which builds, runs and is tested at once.

It holds a body on a track (with --dof 2 also a ball that hangs from it): state your own masses,
positions and forces in mechanics.py, name their units and start values in fmu.py, what to draw in
drawing.py.

examples:
  curvebound new my_system
  curvebound new systems/my_system --dof 2
  curvebound run my_system/scene.py --replay
"""

from __future__ import annotations

import argparse
from importlib.resources import files
from pathlib import Path
from string import Template

from ..errors import CurveboundError
from ..output import say

NAME = "new"
HELP = "write a system of your own"


def configure(parser: argparse.ArgumentParser) -> None:
    """Add the arguments."""
    parser.add_argument(
        "folder", type=Path, metavar="NAME", help="its folder, in small letters: my_system"
    )
    parser.add_argument(
        "--dof",
        type=int,
        choices=(1, 2),
        default=1,
        help="degrees of freedom to begin with (default: 1)",
    )


def run(options: argparse.Namespace) -> int:
    """Write the files and say what to do next."""
    from ..fmi.folder import fmu_name

    folder: Path = options.folder
    name = folder.resolve().name
    own = fmu_name(name)
    if folder.exists():
        raise CurveboundError(f"{folder} exists already: choose another name")
    words = {"name": name, "Name": own}
    made = []
    templates = files(__package__) / "templates"
    for part in (f"dof{options.dof}", "both"):
        for source in (templates / part).iterdir():
            text = source.read_text(encoding="utf-8")
            target = folder / source.name.removesuffix(".template").replace("NAME", name)
            target.parent.mkdir(parents=True, exist_ok=True)
            target.write_text(Template(text).substitute(words), encoding="utf-8")
            made.append(target.name)
    say(options, f"{folder}: {', '.join(sorted(made))}")
    say(options, f"  curvebound build {folder}")
    say(options, f"  curvebound run {folder / 'scene.py'} --replay")
    say(options, f"  pytest {folder}")
    return 0

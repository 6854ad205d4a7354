"""Write a scene as an SSP 1.0 package, for other co-simulation tools.

Tools that follow the standard run it with the scene's parameters, which each component is bound to.
fmpy's simulate_ssp takes them from its argument parameter_set only and runs the FMUs with their
defaults otherwise: the command prints how to call it.

examples:
  curvebound ssp swaying_parabola --out sway.ssp
  curvebound ssp scenarios/active_damping.py --out damping.ssp --set plant.slider.u_start=1
"""

from __future__ import annotations

import argparse
from pathlib import Path

from ..arguments import file_of
from ..cosim.options import configure_changes as _configure_changes
from ..output import say

NAME = "ssp"
HELP = "write a scene as an SSP package"


def configure(parser: argparse.ArgumentParser) -> None:
    """Add the arguments."""
    parser.add_argument("scene", metavar="SCENE", help="a .py file or a scene's name")
    parser.add_argument(
        "--out", metavar="FILE.ssp", type=file_of(".ssp"), help="the package (default NAME.ssp)"
    )
    _configure_changes(parser)


def run(options: argparse.Namespace) -> int:
    """Write the package and print its path."""
    from ..cosim import load_scene
    from ..cosim.options import changed
    from ..cosim.ssp import in_fmpy, write_ssp
    from ..files import inside

    scene = changed(load_scene(options.scene), options)
    path = write_ssp(scene, options.out or inside(Path(), scene.name, ".ssp"))
    say(options, str(path))
    say(options, "\nfmpy gives the scene's parameters to its FMUs only if it is told to:\n")
    say(options, in_fmpy(scene, path))
    return 0

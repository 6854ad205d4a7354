"""Write a scene as an SSP 1.0 package, for other co-simulation tools.

examples:
  curvebound ssp swaying_parabola --out sway.ssp
  curvebound ssp scenarios/active_damping.py --out damping.ssp --set plant.slider.u_start=1
"""

from __future__ import annotations

import argparse
from pathlib import Path

from ..cosim.command import configure_changes as _configure_changes

NAME = "ssp"
HELP = "write a scene as an SSP package"


def configure(parser: argparse.ArgumentParser) -> None:
    """Add the arguments."""
    parser.add_argument("scene", metavar="SCENE", help="a .py file or a scene's name")
    parser.add_argument(
        "--out", metavar="FILE.ssp", type=Path, help="the package (default NAME.ssp)"
    )
    _configure_changes(parser)


def run(options: argparse.Namespace) -> int:
    """Write the package and print its path."""
    from ..cosim import load_scene
    from ..cosim.command import changed
    from ..cosim.ssp import write_ssp

    scene = changed(load_scene(options.scene), options)
    print(write_ssp(scene, options.out or Path(f"{scene.name}.ssp")))
    return 0

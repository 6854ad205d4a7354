"""Run a scene: a Python file, one of ours by name, or an SSP file of FMI 2.0 FMUs.

examples:
  curvebound run swaying_parabola --stop 60 --out sway.csv
  curvebound run scenarios/bead_on_wire.py --set bead.solver.method=adaptive --replay
  curvebound run sampled_feedback --variants --replay compare.html
  curvebound run system.ssp --step 0.001
"""

from __future__ import annotations

import argparse
from pathlib import Path
from typing import TYPE_CHECKING

from ..arguments import file_of
from ..cosim.options import configure as _configure
from ..output import say
from . import movies

if TYPE_CHECKING:
    from ..cosim import Result, Scene

NAME = "run"
HELP = "run a scene or an SSP file"
AS_JSON = True


def configure(parser: argparse.ArgumentParser) -> None:
    """Add the arguments."""
    parser.add_argument("scene", metavar="SCENE", help="a .py or .ssp file, or a scene's name")
    _configure(parser)
    parser.add_argument(
        "--replay",
        metavar="FILE.html",
        type=file_of(".html", ".htm"),
        nargs="?",
        const=Path(),
        help="write an HTML page that replays the motion (default build/NAME.html)",
    )
    parser.add_argument(
        "--picture", metavar="FILE.png", type=file_of(".png"), help="draw the motion"
    )
    movies.configure(parser)


def run(options: argparse.Namespace) -> int:
    """Run, print a table, and write what was asked for."""
    from ..cosim import load_scene
    from ..cosim.command import run_all

    scene = load_scene(options.scene)
    drawn = options.replay is not None or options.picture is not None or movies.asked(options)
    if drawn and not scene.recorded:  # more than what the scene needs, to see it move
        scene.record(*(f"{name}.*" for name in scene.components))
    results = run_all(scene, options)
    if options.replay is not None:
        say(options, str(_replay(scene, options, results)))
    if options.picture is not None:
        from ..view import write_picture

        say(options, str(write_picture(results, options.picture, arrows=options.arrows)))
    for path in movies.write(results, options):
        say(options, str(path))
    return 0


def _replay(scene: Scene, options: argparse.Namespace, results: list[tuple[str, Result]]) -> Path:
    """The page; of several runs the scene's own is named after its settings too."""
    from ..cosim.differences import differences, own_label
    from ..cosim.options import chosen
    from ..files import inside
    from ..view.replay import About, pages_beside, write_replay

    differing = differences([one for _, one in chosen(scene, options)])
    own = own_label(differing, 0)
    if own and own not in [label for label, _ in results]:
        results = [(own, results[0][1]), *results[1:]]
    out = options.replay if options.replay.name else inside(Path("build"), scene.name, ".html")
    about = About(scene.description, differing, pages_beside(out.parent, scene.name))
    return write_replay(results, out, title=scene.name, about=about)

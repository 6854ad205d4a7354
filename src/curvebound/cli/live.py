"""Touch a scene: a page in the browser that the FMUs move as one watches.

The page is served on this machine only, to whoever has the address with its token. Change inputs
and gains by sliders, drag bodies and frames, go back to an earlier state, set a variant beside, and
save what was done as a scene file that replays it bit for bit. A system by its name is a scene of
its own. Ctrl-C ends it.

examples:
  curvebound live inverted_balance --open
  curvebound live BeadOnWire
  curvebound live scene.py --set bead.wire.radius=2
"""

from __future__ import annotations

import argparse
from pathlib import Path
from typing import TYPE_CHECKING

from ..cosim.options import changed, configure_changes

if TYPE_CHECKING:
    from ..cosim import Scene

NAME = "live"
HELP = "touch a scene in the browser"


def configure(parser: argparse.ArgumentParser) -> None:
    """Add the arguments."""
    parser.add_argument(
        "scene", metavar="SCENE", help="a .py or .ssp file, a scene's name, or a system"
    )
    configure_changes(parser)
    parser.add_argument(
        "--out",
        type=Path,
        default=Path("build"),
        metavar="DIR",
        help="where recordings go (default: build/)",
    )
    parser.add_argument("--open", action="store_true", help="open the page in the browser")


def run(options: argparse.Namespace) -> int:
    """Serve until the keyboard ends it."""
    from ..study.extras import require

    require("live")
    import asyncio

    from ..view.live.plan import Plan
    from ..view.live.server import Live

    live = Live(Plan(changed(_scene(options.scene), options)), options.out)

    def ready() -> None:
        print(f"{live.address} (Ctrl-C ends it)", flush=True)
        if options.open:
            import webbrowser

            webbrowser.open(live.address)

    try:
        asyncio.run(live.serve(ready))
    except KeyboardInterrupt:
        print("ended")
    return 0


def _scene(which: str) -> Scene:
    """The scene, or one of a single system: a scene's name comes first."""
    from ..cosim import Scene, load_scene, scene_names
    from ..errors import CurveboundError
    from ..fmi.folder import find

    if which in scene_names() or Path(which).suffix in (".py", ".ssp"):
        return load_scene(which)
    try:
        system = find(which)
    except CurveboundError:
        return load_scene(which)  # says which scenes there are
    fmu = system.declaration()
    scene = Scene(fmu.name, fmu.description, stop_time=fmu.stop_time, step=fmu.step_size)
    scene.add(system.path.name, system.path)
    return scene

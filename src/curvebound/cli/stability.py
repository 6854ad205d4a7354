"""Map where the methods break: a parameter of a scene against the step.

A map says for each method and value of a parameter up to which step it is accurate, up to which
it is stable, and where it fails with a message. Made of it: a table (CSV), a picture (PNG), a page.

examples:
  curvebound stability bead_on_wire --vary bead.wire.radius=1e-3:1e3:13:log
  curvebound stability pendulum_large --vary plant.pendulum.mass=1e-8:1e8:17:log --method rk4
"""

from __future__ import annotations

import argparse
from pathlib import Path
from typing import Any

from ..arguments import positive, setting, whole
from ..output import console_of, hand_out
from ..progress import Progress

NAME = "stability"
HELP = "map where the methods break, over a parameter and the step"
AS_JSON = True


def configure(parser: argparse.ArgumentParser) -> None:
    """Add the arguments."""
    from ..kernel.methods import METHODS  # with all of them, which `--help` alone does without

    parser.add_argument("scene", metavar="SCENE", help="a .py file or a scene's name")
    parser.add_argument(
        "--vary",
        action="append",
        required=True,
        metavar="PATH=LOW:HIGH:N:log",
        help="the parameter of a map: component.variable=LOW:HIGH:N, with :log for equal "
        "steps in the logarithm, or =a,b,c; may be repeated, one map each",
    )
    parser.add_argument("--method", action="append", choices=METHODS, help="may be repeated")
    parser.add_argument(
        "--steps", metavar="LOW:HIGH:N", help="steps in s (default: 5e-6 to 0.1 of the run, 22)"
    )
    parser.add_argument("--stop", type=positive, metavar="T", help="stop time of the runs in s")
    parser.add_argument(
        "--accuracy",
        type=positive,
        default=1e-3,
        metavar="E",
        help="largest relative error called accurate (default: 1e-3)",
    )
    parser.add_argument("--set", type=setting, action="append", default=[], metavar="PATH=VALUE")
    parser.add_argument("--jobs", type=whole(1), default=1, help="processes (default: 1)")
    parser.add_argument("--out", type=Path, default=Path("build/stability"), metavar="DIR")
    parser.add_argument("--no-plots", action="store_true", help="tables and pages only")
    parser.set_defaults(wrong=parser.error)  # prints the usage, exit status 2


def run(options: argparse.Namespace) -> int:
    """Make the maps; status 1 where one is empty."""
    from ..files import inside, sole_writer
    from ..study.extras import require
    from ..study.stability.map_report import files_of

    requests = _requests(options)
    units = {}
    for request in requests:
        with request.probe() as probe:
            units[request] = probe.unit
    if not options.no_plots:
        require("plots")
    folder = inside(options.out, requests[0].made().name)
    files = [folder / "index.html", *(file for one in requests for file in files_of(one, folder))]
    try:
        with sole_writer(*dict.fromkeys(files)):  # known before hours of runs
            return 0 if _maps(options, requests, units, folder) else 1
    except KeyboardInterrupt:
        raise KeyboardInterrupt(
            "stopped by the keyboard; files named above are whole, nothing else is kept"
        ) from None


def _requests(options: argparse.Namespace) -> list[Any]:
    """The maps of --vary; ends with the usage where the words are wrong."""
    from ..errors import CurveboundError
    from ..study.stability.maps import Request, refuse_ignored, steps_from, values_of
    from ..study.stability.stability_map import MAPPED

    requests = []
    try:
        for text in options.vary:
            requests.append(
                Request(
                    options.scene,
                    text,
                    tuple(options.set),
                    tuple(options.method or MAPPED),
                    options.accuracy,
                    options.stop,
                    steps_from(options.steps),
                )
            )
            values_of(requests[-1])
            refuse_ignored(requests[-1])
    except CurveboundError as error:
        options.wrong(str(error))
    return requests


def _maps(
    options: argparse.Namespace, requests: list[Any], units: dict[Any, str], folder: Path
) -> bool:
    """Whether something is known in each map."""
    from ..study.stability.map_report import nothing_known, write_index, write_map
    from ..study.stability.maps import make_maps

    console = console_of(options)
    pages = []
    data = []
    good = True
    with Progress("map", unit="columns") as tell:
        for request, maps in make_maps(requests, jobs=options.jobs, progress=tell):
            page = write_map(
                request, maps, folder.name, units[request], folder, plots=not options.no_plots
            )
            pages.append((request.axis.path, page))
            console.print(f"{request.axis.path}: {page}", soft_wrap=True)
            why = nothing_known(maps)
            files = {"page": page, "file": page.with_suffix(".csv"),
                     "boundaries": page.with_name(f"{page.stem}_boundaries.csv")}  # fmt: skip
            data.append({"vary": request.axis.path, **files, "empty": why})
            if why:
                good = False
                console.print(f"nothing is known at any value: {why}", soft_wrap=True)
    write_index(pages, folder)
    hand_out(options, {"scene": folder.name, "maps": data})
    return good

"""Find where the methods break: maps of a parameter against the step, and random samples.

A map says for each method and value of a parameter up to which step it is accurate, up to which
it is stable, and where it fails with a message. Made of it: a table (CSV), a picture (PNG), a page.

examples:
  curvebound stability bead_on_wire --vary bead.wire.radius=1e-3:1e3:13:log
  curvebound stability pendulum_large --vary plant.pendulum.mass=1e-8:1e8:17:log --method rk4
  curvebound stability --all --jobs 2
  curvebound stability --sample 2000 --system MySystem --jobs 2
"""

from __future__ import annotations

import argparse
from pathlib import Path
from typing import Any

from ..arguments import positive, setting, whole
from ..study.stability.ranges import systems
from .bar import progress_bar
from .stability_usage import refuse, requests_of

NAME = "stability"
HELP = "find where the methods break: maps, random samples"

_METHODS = ("explicit_euler", "semi_implicit_euler", "rk4", "implicit", "adaptive", "exact")


def configure(parser: argparse.ArgumentParser) -> None:
    """Add the arguments."""
    parser.add_argument("scene", nargs="?", metavar="SCENE", help="a .py file or a scene's name")
    parser.add_argument(
        "--vary",
        action="append",
        default=[],
        metavar="PATH=LOW:HIGH:N:log",
        help="the parameter of a map: component.variable=LOW:HIGH:N, with :log for equal "
        "steps in the logarithm, or =a,b,c; may be repeated, one map each",
    )
    parser.add_argument(
        "--all", action="store_true", help="the maps of both systems that their FMUs document"
    )
    parser.add_argument("--method", action="append", choices=_METHODS, help="may be repeated")
    parser.add_argument(
        "--steps", metavar="LOW:HIGH:N", help="steps in s (default: 5e-6 to 0.1 of the run, 22)"
    )
    parser.add_argument("--stop", type=positive, metavar="T", help="stop time of a map's runs in s")
    parser.add_argument(
        "--accuracy",
        type=positive,
        metavar="E",
        help="largest relative error called accurate (default: 1e-3)",
    )
    parser.add_argument("--set", type=setting, action="append", default=[], metavar="PATH=VALUE")
    parser.add_argument(
        "--sample", type=whole(1), metavar="N", help="N random points of all declared ranges"
    )
    parser.add_argument(
        "--system",
        action="append",
        help="of the sample, by name or folder (default: the shipped ones); may be repeated",
    )
    parser.add_argument("--seed", type=int, help="of the sample (default: 1)")
    parser.add_argument("--tolerance", type=positive, help="of the sample (1e-8)")
    parser.add_argument("--times", type=positive, help="of the sample: characteristic times (10)")
    parser.add_argument("--jobs", type=whole(1), default=1, help="processes (default: 1)")
    parser.add_argument("--out", type=Path, default=Path("build/stability"), metavar="DIR")
    parser.add_argument("--no-plots", action="store_true", help="tables and pages only")
    parser.add_argument(
        "--documentation",
        type=Path,
        metavar="DIR",
        help="with --all: also write the small pictures that the FMUs carry here (fmus)",
    )
    parser.set_defaults(wrong=parser.error)  # prints the usage, exit status 2


def run(options: argparse.Namespace) -> int:
    """Do what was asked for; status 1 where a map is empty or a sample misses."""
    from ..files import require_writable, sole_writer
    from ..study.extras import require

    refuse(options)
    requests = requests_of(options)
    units = {}
    for request in requests:
        with request.probe() as probe:
            units[request] = probe.unit
    with_maps = bool(requests or options.all)
    if with_maps and not options.no_plots:
        require("plots")
    if options.documentation:
        require_writable(options.documentation, folder=True)
    good = True
    try:
        with sole_writer(*_files(options, requests)):  # known before hours of runs
            if with_maps:
                good = _maps(options, requests, units)
            if options.sample is not None:
                good = _sample(options) and good
    except KeyboardInterrupt:
        raise KeyboardInterrupt(
            "stopped by the keyboard; files named above are whole, nothing else is kept"
        ) from None
    return 0 if good else 1


def _files(options: argparse.Namespace, requests: list[Any]) -> list[Path]:
    """What will be written."""
    from ..files import inside
    from ..study.stability.catalogue import catalogue
    from ..study.stability.map_report import files_of

    files = [options.out / "index.html"] if options.all else []
    named = catalogue(tuple(options.method or ()), options.accuracy) if options.all else []
    for request in [*requests, *named]:
        files += files_of(request, inside(options.out, request.made().name))
    if options.sample is not None:
        files += [_sample_file(options, system) for system in _systems(options)]
    return list(dict.fromkeys(files))


def _systems(options: argparse.Namespace) -> list[str]:
    return list(dict.fromkeys(options.system or systems()))


def _sample_file(options: argparse.Namespace, system: str) -> Path:
    folder: Path = options.out
    return folder / f"sample_{Path(system).name}.csv"


def _maps(options: argparse.Namespace, requests: list[Any], units: dict[Any, str]) -> bool:
    """Whether something is known in each map."""
    from rich.console import Console

    from ..files import inside
    from ..study.stability.catalogue import catalogue
    from ..study.stability.compact import write_compact
    from ..study.stability.map_report import nothing_known, write_index, write_map
    from ..study.stability.maps import make_maps

    console = Console(highlight=False)
    if options.all:
        named = catalogue(tuple(options.method or ()), options.accuracy)
        requests = requests + named
        units = units | {one: one.unit for one in named}
    pages = []
    found = []
    good = True
    with progress_bar(console) as bar:
        task = bar.add_task("", total=None, note="")

        def tell(done: int, count: int, path: str) -> None:
            bar.update(task, completed=done, total=count, description=path)

        for request, maps in make_maps(requests, jobs=options.jobs, progress=tell):
            name = request.made().name
            folder = inside(options.out, name)
            page = write_map(
                request, maps, name, units[request], folder, plots=not options.no_plots
            )
            pages.append((f"{name}: {request.axis.path}", page))
            found.append((request, maps))
            console.print(f"{request.axis.path}: {page}", soft_wrap=True)
            why = nothing_known(maps)
            if why:
                good = False
                console.print(f"nothing is known at any value: {why}", soft_wrap=True)
    if options.all:
        console.print(str(write_index(pages, options.out)), soft_wrap=True)
        if set(options.method or ()) != {"adaptive"}:  # those pictures are of steps
            for path in write_compact(found, options.documentation or options.out):
                console.print(str(path), soft_wrap=True)
    return good


def _sample(options: argparse.Namespace) -> bool:
    from rich.console import Console

    from ..study.stability.sample import SampleSettings, run_sample
    from ..study.stability.sample_report import passes, print_sample, write_sample

    console = Console(highlight=False)
    good = True
    for system in _systems(options):
        method = (options.method or ["adaptive"])[0]
        settings = SampleSettings(system, method, options.tolerance, options.times)
        with progress_bar(console) as bar:
            task = bar.add_task(f"sample of the {system}", total=options.sample, note="")
            outcomes = run_sample(
                settings,
                options.sample,
                options.seed,
                jobs=options.jobs,
                progress=lambda n, bar=bar, task=task: bar.update(task, completed=n),  # type: ignore[misc]
            )
        print_sample(outcomes, settings, options.seed)
        console.print(str(write_sample(outcomes, _sample_file(options, system))))
        good = passes(outcomes) and good
    return good

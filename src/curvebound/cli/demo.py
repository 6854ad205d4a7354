"""Build the FMUs, run every scene, write their results and print one table.

example:
  curvebound demo --out build
"""

from __future__ import annotations

import argparse
import math
from pathlib import Path
from typing import TYPE_CHECKING

from ..errors import CurveboundError
from ..numbers import plain, quantity
from ..output import console_of, hand_out
from ..progress import Progress

if TYPE_CHECKING:
    from ..cosim import Result, Scene

NAME = "demo"
HELP = "build the FMUs, run every scene, show what comes out"
AS_JSON = True


_INTRODUCTION = (
    "Each card is a scene that curvebound demo has run: FMUs of bodies bound to curves, from one "
    "body alone over coupled ones to feedback. The replay shows it move; the documentation of each "
    "FMU has its equations, variables and reference result."
)


def configure(parser: argparse.ArgumentParser) -> None:
    """Add the arguments."""
    parser.add_argument(
        "--out", type=Path, default=Path("build"), metavar="DIR", help="folder (default: build/)"
    )
    parser.add_argument("--no-compile", action="store_true", help="run the kernel interpreted")


def run(options: argparse.Namespace) -> int:
    """Build, run, print; 1 when a scene failed or misses its needs, after all others have run."""
    from ..cosim import scene_names
    from ..files import sole_writer
    from ..fmi.folder import names

    out: Path = options.out
    files = [*(f"{name}.fmu" for name in names()), *(f"{name}.csv" for name in scene_names())]
    with sole_writer(*(out / file for file in files), out / "index.html"):
        return _run(options)


def _run(options: argparse.Namespace) -> int:
    from rich.table import Table
    from rich.text import Text

    from ..cosim import RunFailed, load_scene, scene_names
    from ..cosim.needs import errors_of, unmet
    from ..fmi.build import build
    from ..fmi.folder import names
    from ..study.extras import missing

    console = console_of(options)
    out: Path = options.out
    built: dict[str, Path] = {}
    with Progress("building the FMUs (compiling takes a minute the first time)") as tell:
        for name in names():
            tell(note=name)
            fmu = build(name, out, compiled=not options.no_compile)
            built[name] = fmu.path.resolve()
            console.print(fmu.message, soft_wrap=True, markup=False)
    table = Table(box=None, pad_edge=False, title="\nscenes", title_justify="left")
    table.add_column("scene")
    for heading in ("simulated", "wall", "steps", "|residual|", "|drift|"):
        table.add_column(heading, justify="right")
    failures: list[str] = []
    results: list[tuple[Scene, Result]] = []
    data: list[dict[str, object]] = []
    scenes = scene_names()
    with Progress("running", len(scenes), "scenes") as tell:
        for number, name in enumerate(scenes):
            tell(number, note=name)
            try:
                scene = load_scene(name)
                scene.record(*_measures(scene), *scene.needs.errors)
                for component in scene.components.values():
                    component.source = built.get(str(component.source), component.source)
                result = scene.run()
            except RunFailed as error:
                result = error.result
                failures.append(str(error))
            except CurveboundError as error:  # it cannot even begin here
                failures.append(f"{name}: {error}")
                continue
            else:
                missed = unmet(scene, result, errors_of(scene, result))
                failures += [f"{name}: {sentence}" for sentence in missed]
            result.write(out / f"{name}.csv")
            results.append((scene, result))
            table.add_row(
                name,
                f"{result.time[-1] - result.time[0]:g} s" if len(result.data) else "-",
                f"{result.wall:.2f} s",
                f"{_last(result, '.solver.steps'):d}",
                _largest(result, ".energy.residual", "J"),
                _largest(result, ".constraint.drift", "m"),
            )
            data.append(
                {
                    "scene": name,
                    "wall": result.wall,
                    "steps": _last(result, ".solver.steps"),
                    "residual": _most(result, ".energy.residual"),
                    "drift": _most(result, ".constraint.drift"),
                    "file": out / f"{name}.csv",
                }
            )
    console.print(table)
    console.print(f"results: {out}/*.csv")
    pictures = missing("plots")
    with Progress("drawing the gallery"):
        console.print(f"gallery: {_gallery(results, built, out, with_pictures=not pictures)}")
    if pictures:
        console.print(f"no pictures in it: {pictures}", soft_wrap=True, markup=False)
    for failure in failures:
        console.print(Text.assemble(("failed: ", "bold red"), failure))
    hand_out(options, {"fmus": built, "scenes": data, "failures": failures})
    return 1 if failures else 0


def _gallery(
    results: list[tuple[Scene, Result]], built: dict[str, Path], out: Path, *, with_pictures: bool
) -> Path:
    """A page with a card per scene, in the order of a course, and the documentation of each FMU."""
    from ..files import inside
    from ..fmi.documentation import unpack_documentation
    from ..view import About, Card, write_gallery, write_picture, write_replay
    from ..view.replay import pages_beside

    pages = {
        fmu: (
            f"{name}: documentation",
            unpack_documentation(fmu, inside(out / "documentation", name)),
        )
        for name, fmu in built.items()
    }
    cards = []
    for scene, result in sorted(results, key=_place):
        sources = [component.source for component in scene.components.values()]
        picture: Path | None = None
        if with_pictures:
            drawn = inside(out, scene.name, ".png")
            picture = write_picture(result, drawn, stacked=True, dark=True)
        replay = write_replay(
            [(scene.name, result)],
            inside(out, scene.name, ".html"),
            about=About(
                scene.description,
                links={"Gallery": "index.html", **pages_beside(out, scene.name)},
            ),
        )
        cards.append(
            Card(
                scene.name,
                scene.description,
                picture,
                settings=_settings(scene),
                error=f"energy residual {_largest(result, '.energy.residual', 'J')}",
                cost=f"{quantity(result.wall, 's', 2)} of wall time, set-up included",
                links={
                    "replay": replay,
                    "study": inside(out / "study", scene.name) / "index.html",
                    "stability": inside(out / "stability", scene.name) / "index.html",
                    **dict(pages[source] for source in sources if source in pages),
                },
            )
        )
    links = {"studies": out / "study" / "index.html", **dict(pages.values())}
    return write_gallery(cards, out / "index.html", introduction=_INTRODUCTION, links=links)


def _place(run: tuple[Scene, Result]) -> tuple[float, str]:
    """Lessons in their order, then the other scenes by name."""
    scene, _ = run
    return (math.inf if scene.lesson is None else scene.lesson, scene.name)


def _settings(scene: Scene) -> dict[str, str]:
    """What distinguishes the scene's numerics."""
    settings = {"communication step": quantity(scene.step, "s")}
    if len(scene.components) > 1:
        settings["algorithm"] = scene.algorithm
    for component in scene.components.values():
        for name, value in component.start.items():
            if name.startswith(("solver.", "model.", "constraint.stabilization")):
                settings[f"{component.name}.{name}"] = (
                    plain(value) if isinstance(value, float) else str(value)
                )
    return settings


def _measures(scene: Scene) -> list[str]:
    """What the table shows, by path, where a component has it."""
    from ..fmi.folder import find

    wanted = ("solver.steps", "energy.residual", "constraint.drift")
    return [
        f"{component.name}.{variable.name}"
        for component in scene.components.values()
        if isinstance(component.source, str)
        for variable in find(component.source).fmu().variables
        if variable.name in wanted
    ]


def _columns(result: Result, ending: str) -> list[str]:
    return [name for name in result.names if name.endswith(ending)]


def _last(result: Result, ending: str) -> int:
    """Internal steps of all plants together."""
    return sum(int(result[name][-1]) for name in _columns(result, ending) if len(result.data))


def _largest(result: Result, ending: str, unit: str) -> str:
    value = _most(result, ending)
    return "" if value is None else quantity(value, unit, 2)


def _most(result: Result, ending: str) -> float | None:
    """The largest absolute value of the columns that end so; None without one."""
    values = [abs(result[name]).max() for name in _columns(result, ending) if len(result.data)]
    return float(max(values)) if values else None

"""Running a scene from a command line: the same options for `curvebound run` and for a script."""

from __future__ import annotations

import argparse
import sys
import time as clock
from collections.abc import Callable, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

from ..arguments import seconds, setting
from ..errors import CurveboundError
from .scene import ALGORITHMS, Adaptive, Scene

if TYPE_CHECKING:
    from .results import Result

__all__ = [
    "Progress",
    "changed",
    "chosen",
    "configure",
    "configure_changes",
    "main",
    "run_all",
    "summarize",
]


def configure_changes(parser: argparse.ArgumentParser) -> None:
    """Add the options that change a scene."""
    parser.add_argument(
        "--set",
        metavar="COMPONENT.VARIABLE=VALUE",
        type=setting,
        action="append",
        default=[],
        help="a start value, also as pi/2 or 90deg; enumerations by item name or number; may be "
        "repeated",
    )
    parser.add_argument("--stop", metavar="T", type=seconds, help="stop time in s")
    parser.add_argument("--step", metavar="H", type=seconds, help="macro step in s")
    parser.add_argument("--algorithm", choices=ALGORITHMS, help="how coupled components advance")
    parser.add_argument(
        "--adaptive",
        metavar="TOL",
        type=float,
        help="choose the macro step: bound on the relative error per second",
    )
    parser.add_argument("--variant", metavar="NAME", help="take this variant of the scene")


def configure(parser: argparse.ArgumentParser) -> None:
    """Add the options that change and run a scene."""
    configure_changes(parser)
    parser.add_argument(
        "--variants", action="store_true", help="run the scene and all its variants"
    )
    parser.add_argument("--out", metavar="FILE.csv", type=Path, help="write the result here")


def chosen(scene: Scene, options: argparse.Namespace) -> list[tuple[str, Scene]]:
    """The scenes to run, each with a label: the scene or its variants, changed by the options."""
    if not options.variants:
        return [(options.variant or scene.name, changed(scene, options))]
    scenes = [(scene.name, scene)]
    scenes += [(name, scene.with_variant(name)) for name in scene.variants]
    return [(label, changed(one, options)) for label, one in scenes]


def changed(scene: Scene, options: argparse.Namespace) -> Scene:
    """A copy of the scene with the options applied; later ones prevail over a variant."""
    scene = scene.copy() if options.variant is None else scene.with_variant(options.variant)
    if options.stop is not None:
        scene.stop_time = options.stop
    if options.step is not None:
        scene.step = options.step
    if options.algorithm is not None:
        scene.algorithm = options.algorithm
    if options.adaptive is not None:
        scene.adaptive = Adaptive(tolerance=options.adaptive)
    for path, value in options.set:
        scene.set(path, value)
    return scene


class Progress:
    """A progress bar that appears once a run has taken a second, on a terminal only."""

    def __init__(self, label: str, start: float, stop: float) -> None:
        self._label = label
        self._start = start
        self._span = stop - start
        self._shown_from = clock.perf_counter() + 1.0
        self._bar: Any = None
        self._task: Any = None

    def __enter__(self) -> Progress:
        return self

    def __exit__(self, *exception: object) -> None:
        if self._bar is not None:
            self._bar.stop()

    def __call__(self, time: float) -> None:
        if self._bar is None:
            if clock.perf_counter() < self._shown_from or not sys.stderr.isatty():
                return
            from rich.console import Console
            from rich.progress import BarColumn, TextColumn, TimeRemainingColumn
            from rich.progress import Progress as Bar

            self._bar = Bar(
                TextColumn("{task.description}"),
                BarColumn(),
                TextColumn("{task.fields[time]:.4g} s"),
                TimeRemainingColumn(),
                console=Console(stderr=True),
                transient=True,
            )
            self._bar.start()
            self._task = self._bar.add_task(self._label, total=self._span, time=time)
        self._bar.update(self._task, completed=time - self._start, time=time)


def run_all(
    scene: Scene,
    options: argparse.Namespace,
    report: Callable[[str, Result], None],
) -> list[tuple[str, Result]]:
    """Run what the options ask for; each result is reported, and written, as soon as it is there.

    A run that fails or is interrupted writes what it has before the error goes on.
    """
    from .results import RunFailed, RunInterrupted

    results = []
    scenes = chosen(scene, options)
    for label, one in scenes:
        with Progress(label, one.start_time, one.stop_time) as progress:
            try:
                result = one.run(progress=progress)
            except (RunFailed, RunInterrupted) as error:
                if options.out is not None and len(error.result.data):
                    written = error.result.write(_file(options.out, label, len(scenes)))
                    raise CurveboundError(
                        f"{error} The result up to there is in {written}."
                    ) from error
                raise CurveboundError(str(error)) from error
        if options.out is not None:
            result.write(_file(options.out, label, len(scenes)))
        report(label, result)
        results.append((label, result))
    return results


def _file(out: Path, label: str, count: int) -> Path:
    if count == 1:
        return out
    word = "".join(c if c.isalnum() or c in "-_." else "_" for c in label)
    return out.with_name(f"{out.stem}_{word}{out.suffix}")


def summarize(label: str, result: Result) -> None:
    """Print one table of a result: what it cost, and where each recorded output went."""
    from rich.console import Console
    from rich.table import Table
    from rich.text import Text

    console = Console(highlight=False)
    steps = f"{result.steps} steps"
    if result.trials != result.steps:
        steps += f" ({result.trials} with trials)"
    cost = result.stepping / max(1, result.trials) * 1e6
    simulated = float(result.time[-1] - result.time[0])
    spent = (
        f"{simulated:.6g} s simulated in {result.stepping:.3g} s, {steps}, {cost:.3g} us each"
        f" (and {result.wall - result.stepping:.3g} s to load and initialize)"
    )
    console.print(Text.assemble((label, "bold"), ": ", spent), soft_wrap=True)
    for note in result.notes:
        console.print(note, style="dim", markup=False)
    table = Table(box=None, pad_edge=False)
    table.add_column("output", overflow="fold")
    table.add_column("unit")
    for heading in ("smallest", "largest", "at the end"):
        table.add_column(heading, justify="right")
    for name in result.names:
        column = result[name].astype(float)
        numbers = [f"{v:.6g}" for v in (column.min(), column.max(), column[-1])]
        table.add_row(name, result.units.get(name, ""), *numbers)
    console.print(table)


def main(scene: Scene, arguments: Sequence[str] | None = None) -> int:
    """Run `scene` as a script; returns the exit status: 0, 1 failed, 2 wrong usage."""
    parser = argparse.ArgumentParser(description=scene.description)
    configure(parser)
    options = parser.parse_args(arguments)
    file = getattr(sys.modules.get("__main__"), "__file__", None)
    if scene.folder is None and file is not None:
        scene.folder = Path(file).resolve().parent
    try:
        run_all(scene, options, summarize)
    except CurveboundError as error:
        print(f"error: {error}", file=sys.stderr)
        return 1
    return 0

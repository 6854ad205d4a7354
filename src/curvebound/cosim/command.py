"""Running a scene from a command line: the same for `curvebound run` and for a script."""

from __future__ import annotations

import argparse
import sys
import time as clock
from collections.abc import Callable, Sequence
from pathlib import Path
from typing import Any

from ..errors import CurveboundError, remedy_of, said
from ..files import inside, sole_writer
from .options import chosen, configure
from .prepared import Prepared
from .results import Result, RunFailed, RunInterrupted
from .scene_data import SceneData

__all__ = ["Progress", "main", "run_all", "summarize"]


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
    scene: SceneData,
    options: argparse.Namespace,
    report: Callable[[str, Result], None],
) -> list[tuple[str, Result]]:
    """Run what the options ask for; each result is reported, and written, as soon as it is there.

    A run that fails or is interrupted writes what it has before the error goes on.
    """
    scenes = chosen(scene, options)
    files = {label: _file(options.out, label, len(scenes)) for label, _ in scenes if options.out}
    results = []
    with sole_writer(*files.values()):
        for label, one in scenes:
            result = _run_one(label, one, files.get(label))
            report(label, result)
            results.append((label, result))
    return results


def _run_one(label: str, scene: SceneData, out: Path | None) -> Result:
    with Progress(label, scene.start_time, scene.stop_time) as progress:
        try:
            with Prepared(scene) as prepared:
                result = prepared.run(progress=progress)
        except (RunFailed, RunInterrupted) as error:
            if out is not None and len(error.result.data):
                written = error.result.write(out)
                raise CurveboundError(f"{error} The result up to there is in {written}.") from error
            raise CurveboundError(str(error)) from error
    if out is not None:
        result.write(out)
    return result


def _file(out: Path, label: str, count: int) -> Path:
    if count == 1:
        return out
    return out.with_name(f"{out.stem}_{inside(Path(), label, out.suffix)}")


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


def main(scene: SceneData, arguments: Sequence[str] | None = None) -> int:
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
        return error.status
    except (OSError, MemoryError) as error:
        print(f"error: {said(error)}. {remedy_of(error)}".strip(), file=sys.stderr)
        return 2
    return 0

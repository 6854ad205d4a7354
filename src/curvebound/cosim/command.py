"""Running a scene from a command line: the same for `curvebound run` and for a script."""

from __future__ import annotations

import argparse
import sys
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

from .. import output
from ..errors import CurveboundError, remedy_of, said
from ..files import inside, sole_writer
from ..output import aligned, hand_out, say
from ..progress import Progress
from .options import chosen, configure
from .prepared import Prepared
from .results import Result, RunFailed, RunInterrupted
from .scene_data import SceneData

__all__ = ["main", "run_all", "summarize", "summary"]


def run_all(
    scene: SceneData,
    options: argparse.Namespace,
) -> list[tuple[str, Result]]:
    """Run what the options ask for; each result is told, and written, as soon as it is there.

    A run that fails or is interrupted writes what it has before the error goes on.
    """
    scenes = chosen(scene, options)
    files = {label: _file(options.out, label, len(scenes)) for label, _ in scenes if options.out}
    results = []
    data = []
    with sole_writer(*files.values()):
        for label, one in scenes:
            result = _run_one(label, one, files.get(label), with_units=options.units)
            data.append({**summary(label, result), "file": files.get(label)})
            say(options, summarize(data[-1]))
            results.append((label, result))
    hand_out(options, data)
    return results


def _run_one(label: str, scene: SceneData, out: Path | None, *, with_units: bool) -> Result:
    try:
        # what builds FMUs first tells how far that is
        with (
            Prepared(scene) as prepared,
            Progress(label, scene.stop_time - scene.start_time, "s") as progress,
        ):
            result = prepared.run(progress=lambda time: progress(time - scene.start_time))
    except (RunFailed, RunInterrupted) as error:
        if out is not None and len(error.result.data):
            written = error.result.write(out, with_units=with_units)
            raise CurveboundError(f"{error} The result up to there is in {written}.") from error
        raise CurveboundError(str(error)) from error
    if out is not None:
        result.write(out, with_units=with_units)
    return result


def _file(out: Path, label: str, count: int) -> Path:
    if count == 1:
        return out
    return out.with_name(f"{out.stem}_{inside(Path(), label, out.suffix)}")


def summary(label: str, result: Result) -> dict[str, Any]:
    """What a run cost, and where each recorded output went, as data."""
    outputs = {}
    for name in result.names:
        column = result[name].astype(float)
        outputs[name] = {
            "unit": result.units.get(name, ""),
            "smallest": float(column.min()),
            "largest": float(column.max()),
            "end": float(column[-1]),
        }
    return {
        "label": label,
        "scene": result.scene,
        "simulated": float(result.time[-1] - result.time[0]),
        "stepping": result.stepping,
        "wall": result.wall,
        "steps": result.steps,
        "trials": result.trials,
        "rejected": result.rejected,
        "notes": result.notes,
        "outputs": outputs,
    }


def summarize(data: Mapping[str, Any]) -> str:
    """A summary as a table, with what was noted."""
    steps = f"{data['steps']} steps"
    if data["trials"] != data["steps"]:
        steps += f" ({data['trials']} with trials)"
    cost = data["stepping"] / max(1, data["trials"]) * 1e6
    spent = (
        f"{data['label']}: {data['simulated']:.6g} s simulated in {data['stepping']:.3g} s, "
        f"{steps}, {cost:.3g} us each (and {data['wall'] - data['stepping']:.3g} s to load and "
        "initialize)"
    )
    rows = [["output", "unit", "smallest", "largest", "at the end"]]
    for name, one in data["outputs"].items():
        numbers = (f"{one[which]:.6g}" for which in ("smallest", "largest", "end"))
        rows.append([name, one["unit"], *numbers])
    return "\n".join([spent, *data["notes"], aligned(rows, left=2)])


def main(scene: SceneData, arguments: Sequence[str] | None = None) -> int:
    """Run `scene` as a script; returns the exit status: 0, 1 failed, 2 wrong usage."""
    parser = argparse.ArgumentParser(description=scene.description)
    configure(parser)
    output.configure(parser, json=True)
    options = parser.parse_args(arguments)
    file = getattr(sys.modules.get("__main__"), "__file__", None)
    if scene.folder is None and file is not None:
        scene.folder = Path(file).resolve().parent
    try:
        with output.logging_to_stderr(options):
            run_all(scene, options)
    except CurveboundError as error:
        print(f"error: {error}", file=sys.stderr)
        return error.status
    except (OSError, MemoryError) as error:
        print(f"error: {said(error)}. {remedy_of(error)}".strip(), file=sys.stderr)
        return 2
    return 0

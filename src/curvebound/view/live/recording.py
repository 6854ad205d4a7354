"""Saves what was done as a scene that replays it bit for bit: Python file, inputs, result."""

from __future__ import annotations

import re
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from ...cosim import load_scene, write_csv
from ...cosim.fmu import Value
from ...cosim.points import communication_times
from ...cosim.prepared import Prepared
from ...cosim.scene_data import SceneData
from ...cosim.scene_text import scene_text
from ...cosim.system import System, port_of
from ...errors import CurveboundError
from ...files import inside, write_whole
from .driven import Driven
from .runs import Runs

__all__ = ["Recorded", "recording"]


class Recorded(NamedTuple):
    """The files that were written; exact: whether the scene led to the same bits again."""

    scene: Path
    result: Path
    exact: bool


def recording(runs: Runs, folder: Path) -> Callable[[], Recorded]:
    """What saves the first of the runs from the start to here into `folder`.

    It may be called later, in another thread: it does not touch the runs any more. Raises
    CurveboundError where nothing has been stepped, or the run has failed.
    """
    first = runs.first.stepped
    start = first.scene.start_time
    if not first.alive:
        raise CurveboundError("The run has failed: take the last change back before you save it.")
    if not first.time > start:
        raise CurveboundError("Nothing has moved yet: let it run before you save it.")
    scene = first.scene.copy(f"{first.scene.name}_live")
    scene.stop_time = first.time
    scene.variants = _variant(runs)
    done = _Done(
        scene=scene,
        system=first.system,
        driven={path: one.copy() for path, one in runs.first.driven.items()},
        last=first.row().copy(),
        columns=list(first.columns),
    )
    return lambda: done.save(folder)


def _variant(runs: Runs) -> dict[str, dict[str, Value]]:
    """The run beside, as a variant of the first: what only the first has set goes back."""
    beside = runs.beside
    if beside is None:
        return {}
    given = {path: runs.plan.given(path) for path in runs.first.settings}
    return {beside.label: {**given, **beside.settings}}


@dataclass
class _Done:
    """A run up to a communication point, and the values there."""

    scene: SceneData
    system: System
    driven: dict[str, Driven]
    last: NDArray[np.float64]
    columns: list[str]

    def save(self, folder: Path) -> Recorded:
        """Write the scene with its inputs as tables, run it, and write the result."""
        scene = self.scene
        out = _free(folder, scene.name)
        inputs = out.with_name(f"{out.stem}_inputs.csv")
        table = self._tables()
        if table is not None:
            write_csv(table, inputs)
            scene.inputs.update(dict.fromkeys((table.dtype.names or ())[1:], inputs.name))
        text = scene_text(scene)
        write_whole(out, lambda path: path.write_text(text, encoding="utf-8", newline="\n"))
        with Prepared(load_scene(out)) as prepared:
            result = prepared.run()
        row = [float(result["time"][-1]), *(float(result[name][-1]) for name in self.columns)]
        exact = np.array_equal(np.array(row), self.last, equal_nan=True)
        return Recorded(out, result.write(out.with_suffix(".csv")), exact)

    def _tables(self) -> NDArray[Any] | None:
        """A column for each input that changes; those that do not become start values."""
        scene = self.scene
        begin, end = scene.start_time, scene.stop_time
        times = communication_times(begin, end, scene.step, self.system.stops)
        every = [time for one in self.driven.values() for time in (*one.changes, *one.jumps)]
        jumps = {time for time in every if begin < time}
        columns: dict[str, list[float]] = {}
        for path, driven in self.driven.items():
            if driven.given is not None or driven.changes:
                columns[path] = _column(driven, times, jumps)
                continue
            del scene.inputs[path]
            component, name = port = port_of(path)
            real = self.system.variable(port).kind == "Real"
            value = driven(begin)
            scene.components[component].start[name] = value if real else int(value)
        if not columns:
            return None
        grid = [time for time in times for _ in range(1 + (time in jumps))]
        table = np.zeros(len(grid), dtype=[(name, np.float64) for name in ("time", *columns)])
        table["time"] = grid
        for path, values in columns.items():
            table[path] = values
        return table


def _column(driven: Driven, times: list[float], jumps: set[float]) -> list[float]:
    """The values at the communication points; where something jumps, that before it too."""
    values: list[float] = []
    for time in times:
        if time in jumps:
            values.append(values[-1])
        values.append(driven(time))
    return values


def _free(folder: Path, name: str) -> Path:
    """The first file NAME_1.py, NAME_2.py and so on that is not there."""
    word = re.sub(r"\W+", "_", name)
    number = 1
    while any(inside(folder, f"{word}_{number}", end).exists() for end in (".py", ".csv")):
        number += 1
    return inside(folder, f"{word}_{number}", ".py")

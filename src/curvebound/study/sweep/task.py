"""What a worker does: run points of a sweep on FMUs that it has loaded once."""

from __future__ import annotations

import tempfile
import threading
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from ...cosim import RunFailed, load_scene
from ...cosim.fmu import Value
from ...cosim.scene import Scene
from ...errors import CurveboundError
from .metrics import Metric

__all__ = ["Point", "Row", "Task", "run_points"]

Point = tuple[int, dict[str, Value]]  # number, values by path
Row = tuple[int, list[Any], str]  # number, one value per metric, message of a failed point


@dataclass(frozen=True)
class Task:
    """Everything that a worker must know, on whatever machine: small, and the same for all points.

    which: the scene's name or file; text: the file's content, for machines that do not have it.
    changes: settings by path on top of the scene's, as for Scene.set.
    """

    which: str
    text: bytes | None
    changes: tuple[tuple[str, Value], ...]
    metrics: tuple[str, ...]
    variant: str | None = None

    def scene(self) -> Scene:
        """The scene, changed, recording what the metrics use."""
        scene = load_scene(self._file())
        if self.variant is not None:
            scene = scene.with_variant(self.variant)
        for path, value in self.changes:
            scene.set(path, value)
        wanted = dict.fromkeys(p for text in self.metrics for p in Metric(text).paths)
        scene.recorded = list(wanted) or scene.recorded
        scene.needs.errors = {}
        return scene

    def _file(self) -> str:
        path = Path(self.which)
        if self.text is None or (path.is_file() and path.read_bytes() == self.text):
            return self.which
        folder = tempfile.mkdtemp(prefix="curvebound-sweep-")
        copy = Path(folder) / path.name
        copy.write_bytes(self.text)
        return str(copy)


class _State:
    """A worker's FMUs, ready for one task."""

    def __init__(self, task: Task) -> None:
        self.task = task
        self.metrics = [Metric(text) for text in task.metrics]
        self.prepared = task.scene().prepare()

    def row(self, number: int, point: dict[str, Value]) -> Row:
        """Run one point; a failure becomes the row's message."""
        try:
            result = self.prepared.run(point)
            return (number, [metric(result.data) for metric in self.metrics], "")
        except RunFailed as error:
            return (number, [None] * len(self.metrics), str(error))
        except CurveboundError as error:
            return (number, [None] * len(self.metrics), str(error))


# FMUs may not be stepped from two threads of a process at once
_lock = threading.Lock()
_states: dict[Task, _State] = {}


def run_points(task: Task, points: Sequence[Point]) -> list[Row]:
    """Run points, one row each; FMUs are loaded by the first call for a task and then kept."""
    with _lock:
        state = _states.get(task)
        if state is None:
            for old in _states.values():
                old.prepared.close()
            _states.clear()
            state = _states[task] = _State(task)
        return [state.row(number, point) for number, point in points]

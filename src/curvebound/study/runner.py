"""Running a scene at any setting, through its FMUs, and what the run is worth."""

from __future__ import annotations

import math
import time as clock
from collections.abc import Mapping, Sequence
from contextlib import suppress
from dataclasses import dataclass, field
from statistics import median
from types import TracebackType
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from ..cosim import RunFailed
from ..cosim.points import count_steps
from ..cosim.prepared import Prepared

if TYPE_CHECKING:
    from ..cosim.fmu import Value
    from ..cosim.scene import Scene
    from .settings import Setting, Space

__all__ = ["Outcome", "Runner"]

_KEPT = 2000  # communication points that a run is judged by, at most
_MEASURES = ("energy.residual", "constraint.drift", "model.acceleration_error", "energy.kinetic")
_COUNTS = ("solver.steps", "solver.evaluations")


@dataclass
class Outcome:
    """A run at a setting.

    times: s; outputs by path; measures: largest absolute value of each live measure over all
        components that have it; counts: sums over components at the end.
    failure: why the run ended early, or empty.
    """

    times: NDArray[Any]
    outputs: dict[str, NDArray[Any]]
    measures: dict[str, float] = field(default_factory=dict)
    counts: dict[str, int] = field(default_factory=dict)
    failure: str = ""
    cpu: float = 0.0


#: CPU seconds of a run below which two cannot be told apart
_SHORTEST = 2e-6


class Runner:
    """The FMUs of a scene, loaded once for any number of settings. Use as a context manager."""

    def __init__(self, scene: Scene, space: Space, paths: Sequence[str]) -> None:
        self.scene = scene.copy()
        self.scene.tolerance = None  # it would override solver.tolerance
        self.scene.adaptive = None
        self.scene.variants = {}
        self.space = space
        self.paths = list(paths)
        self.span = scene.stop_time - scene.start_time
        nodes = space.system.nodes
        self._extras = [
            f"{name}.{variable}"
            for variable in (*_MEASURES, *_COUNTS)
            for name, node in nodes.items()
            if variable in node.fmu.variables
        ]
        self._prepared: dict[tuple[str, str, bool], Prepared] = {}

    def __enter__(self) -> Runner:
        return self

    def __exit__(
        self,
        kind: type[BaseException] | None,
        value: BaseException | None,
        traceback: TracebackType | None,
    ) -> None:
        for prepared in self._prepared.values():
            with suppress(Exception):
                prepared.close()
        self._prepared.clear()

    def _ready(self, setting: Setting, measured: bool) -> Prepared:
        """measured: with the live measures recorded; without, as a user would run it."""
        key = (setting.algorithm, setting.hold, measured)
        if key not in self._prepared:
            scene = self.scene.copy()
            scene.algorithm, scene.hold = setting.algorithm, setting.hold
            scene.recorded = [*self.paths, *(self._extras if measured else [])]
            scene.needs.errors = {}
            self._prepared[key] = Prepared(scene)
        return self._prepared[key]

    def run(self, setting: Setting, start: Mapping[str, Value] | None = None) -> Outcome:
        """Run once, with all measures; `start` on top of the scene's start values."""
        return self._run(setting, start, measured=True)

    def glance(self, setting: Setting, start: Mapping[str, Value] | None = None) -> Outcome:
        """Run once, with the outputs only."""
        return self._run(setting, start, measured=False)

    def _run(
        self, setting: Setting, start: Mapping[str, Value] | None, *, measured: bool
    ) -> Outcome:
        prepared = self._ready(setting, measured)
        values = {**(start or {}), **self.space.start(setting)}
        points = count_steps(0.0, self.span, setting.step)[0]
        prepared.scene.record_every = max(1, math.ceil(points / _KEPT))
        began = clock.process_time()
        failure = ""
        try:
            result = prepared.run(values, step=setting.step)
        except RunFailed as error:
            result, failure = error.result, str(error)
        spent = clock.process_time() - began
        outcome = Outcome(
            result.time,
            {path: np.asarray(result[path], dtype=float) for path in self.paths},
            failure=failure,
            cpu=spent / self.span,
        )
        if measured and len(result.data):
            for name in _MEASURES:
                found = [np.abs(result[p]).max() for p in self._extras if p.endswith("." + name)]
                if found:
                    outcome.measures[name] = float(max(found))
            for name in _COUNTS:
                counted = [int(result[p][-1]) for p in self._extras if p.endswith("." + name)]
                outcome.counts[name] = sum(counted)
        return outcome

    def cost(self, setting: Setting, *, runs: int = 3, enough: float = 0.03) -> float:
        """CPU time per simulated second, set-up excluded: the median of some runs.

        runs: at least so many, but where one takes more than 0.3 s; enough: s of CPU time after
        which they are, and 15 at most.
        """
        prepared = self._ready(setting, False)
        values = self.space.start(setting)
        prepared.scene.record_every = 1
        tiny = 1e-9 * self.span
        begin, end = self.scene.start_time, self.scene.stop_time
        spent: list[float] = []
        set_up: list[float] = []
        speed = _meter.read()
        while len(spent) < runs or (sum(spent) < enough and len(spent) < 15):
            for stop, step, found in (
                (end, setting.step, spent),
                (begin + tiny, tiny, set_up),
            ):
                taken = self._timed(prepared, values, step, stop)
                before, speed = speed, _meter.read()
                found.append(taken / _meter.slowness(before, speed))
            if spent[0] > 0.3:
                break
        own = median(set_up)
        return max(median(spent) - own, _SHORTEST) / self.span

    @staticmethod
    def _timed(prepared: Prepared, values: dict[str, Value], step: float, stop: float) -> float:
        """CPU seconds of a run."""
        began = clock.process_time()
        try:
            prepared.run(values, step=step, stop_time=stop)
        except RunFailed:
            return math.inf
        return clock.process_time() - began


class _Meter:
    """The machine's present speed, by a fixed piece of work.

    CPU time is not the same at all times: a core is shared with its sibling, its clock changes. A
    piece of work of known length on either side of a run tells by how much.
    """

    def __init__(self) -> None:
        self.best = math.inf
        for _ in range(20):
            self.read()

    def read(self) -> float:
        """CPU seconds of the piece of work, now."""
        began = clock.process_time_ns()
        total = 0
        for i in range(15000):
            total += i & 7
        spent = (clock.process_time_ns() - began) * 1e-9
        self.best = min(self.best, spent)
        return spent

    def slowness(self, before: float, after: float) -> float:
        """How many times longer than at its best the machine takes."""
        return 0.5 * (before + after) / self.best


_meter = _Meter()

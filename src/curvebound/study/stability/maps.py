"""Maps as they are asked for, and their making on one or several processes."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator, Sequence
from concurrent.futures.process import BrokenProcessPool
from contextlib import ExitStack
from dataclasses import dataclass

from ...cosim import load_scene
from ...cosim.fmu import Value
from ...cosim.scene import Scene
from ...errors import CurveboundError
from ...units import number
from ..sweep.design import Axis, axis
from .probe import Probe
from .stability_map import MAPPED, Column, StabilityMap, map_column, sizes_of
from .workers import without_interrupts, workers

__all__ = ["Request", "make_maps", "refuse_ignored", "steps_from", "values_of"]

#: values of a map, and steps at each, at most: a run of one takes about a second
MOST = 10_000
#: settings of the plant that a map makes itself
_OWN = ("solver.method", "solver.step", "solver.tolerance", "solver.max_steps")


@dataclass(frozen=True)
class Request:
    """One map of each method: what `curvebound stability SCENE --vary ...` asks for.

    scene: name or file; vary: as on the command line; changes: settings of the scene by path.
    steps: least, most (s) and count, or None for parts of each run. durations: s of the runs at
    each value, or None for the scene's own.
    """

    scene: str
    vary: str
    changes: tuple[tuple[str, Value], ...] = ()
    methods: tuple[str, ...] = MAPPED
    accuracy: float = 1e-3
    stop: float | None = None
    steps: tuple[float, float, int] | None = None
    durations: tuple[float, ...] | None = None

    def made(self) -> Scene:
        """The scene, changed."""
        scene = load_scene(self.scene)
        for path, value in self.changes:
            scene.set(path, value)
        if self.stop is not None:
            if not self.stop > scene.start_time:
                raise CurveboundError(
                    f"--stop {self.stop:g}: give a time after the start, {scene.start_time:g} s."
                )
            scene.stop_time = self.stop
        return scene

    @property
    def axis(self) -> Axis:
        """What varies."""
        return axis(self.vary)

    def probe(self) -> Probe:
        """The scene made ready; CurveboundError where it cannot be mapped."""
        return Probe(self.made(), self.axis.path, accuracy=self.accuracy)


def values_of(request: Request) -> list[float]:
    """The values of a map, ascending; CurveboundError for what is no list of numbers."""
    varied = request.axis
    if not varied.items and not varied.count:
        raise CurveboundError(
            f"--vary {request.vary}: say in how many values: "
            f"{varied.path}={varied.low:g}:{varied.high:g}:N"
        )
    if varied.count > MOST:
        raise CurveboundError(
            f"--vary {request.vary}: {varied.count} values are more than a map may have, {MOST}."
        )
    try:
        values = [number(v) if isinstance(v, str) else float(v) for v in varied.values()]
    except ValueError as error:
        raise CurveboundError(
            f"--vary {request.vary}: {error}; a map varies numbers, set an enumeration with --set."
        ) from None
    if not all(math.isfinite(value) for value in values):
        raise CurveboundError(f"--vary {request.vary}: every value must be finite.")
    if len(set(values)) < len(values):
        raise CurveboundError(f"--vary {request.vary}: a value is given twice.")
    return values if request.durations else sorted(values)


def steps_from(text: str | None) -> tuple[float, float, int] | None:
    """The --steps of a command line; CurveboundError unless LOW:HIGH:N."""
    if text is None:
        return None
    try:
        first, second, third = text.split(":")
        low, high, count = float(first), float(second), int(third)
    except ValueError:
        raise CurveboundError(f"--steps {text!r} is not of the form LOW:HIGH:N.") from None
    if not (0.0 < low < high < math.inf and count > 1):
        raise CurveboundError(f"--steps {text!r}: give 0 < LOW < HIGH and N of 2 or more.")
    if count > MOST:
        raise CurveboundError(
            f"--steps {text!r}: {count} steps are more than a map may have, {MOST}."
        )
    return low, high, count


def refuse_ignored(request: Request) -> None:
    """CurveboundError for changes that the map itself would overwrite."""
    plant = request.axis.path.partition(".")[0]
    own = {request.axis.path: "--vary", **{f"{plant}.{name}": "the map" for name in _OWN}}
    for path, value in request.changes:
        if path in own:
            raise CurveboundError(
                f"--set {path}={value} would be ignored: {own[path]} sets {path}. Leave it out, or "
                "choose with --vary, --method, --steps and --accuracy."
            )


class _Columns:
    """The columns of requests, each at one value; holds the last request's probe."""

    def __init__(self) -> None:
        self._request: Request | None = None
        self._probe: Probe | None = None

    def make(self, request: Request, index: int, value: float) -> list[Column]:
        """One column of each method."""
        if self._request != request or self._probe is None:
            self.close()
            self._probe = request.probe()
            self._request = request
        probe = self._probe
        if request.durations is not None:
            probe.duration = request.durations[index]
        return [
            map_column(probe, method, value, sizes_of(method, probe.duration, request.steps))
            for method in request.methods
        ]

    def close(self) -> None:
        """Unload the FMUs."""
        if self._probe is not None:
            self._probe.close()
            self._probe = None


_columns = _Columns()


def _make(request: Request, index: int, value: float) -> list[Column]:
    return _columns.make(request, index, value)


def make_maps(
    requests: Sequence[Request],
    *,
    jobs: int = 1,
    progress: Callable[[int, int, str], None] | None = None,
) -> Iterator[tuple[Request, list[StabilityMap]]]:
    """The maps of each request as they are finished, in the order asked for.

    progress: called with the number of columns done, their number and the path that varies.
    jobs: processes; the maps are the same for any number.
    """
    tasks = [(r, i, v) for r in requests for i, v in enumerate(values_of(r))]
    done = 0
    with ExitStack() as stack:
        if jobs > 1:
            pool = stack.enter_context(workers(jobs))
            with without_interrupts():
                futures = [pool.submit(_make, *task) for task in tasks]
            results: Iterator[list[Column]] = (future.result() for future in futures)
        else:
            stack.callback(_columns.close)
            results = (_make(*task) for task in tasks)
        for request in requests:
            columns = []
            for _ in values_of(request):
                try:
                    columns.append(next(results))
                except BrokenProcessPool as error:
                    raise CurveboundError(
                        f"A process that made the map of {request.axis.path} ended: the system ran "
                        "out of memory, or an FMU crashed. Maps finished before are kept; make "
                        "this one with --jobs 1 to see where."
                    ) from error
                done += 1
                if progress is not None:
                    progress(done, len(tasks), request.axis.path)
            maps = []
            for i, method in enumerate(request.methods):
                own = sorted((one[i] for one in columns), key=lambda column: column.value)
                maps.append(StabilityMap(method, own))
            yield request, maps

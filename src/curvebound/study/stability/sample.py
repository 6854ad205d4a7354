"""Every point of a random sample run through its FMU and judged against the exact motion.

A point is accurate, or it failed (the FMU refused the step with a message), or it warned (it ran,
inaccurately, and the FMU logged a warning), or it is sensitive (so is its exact motion to a change
of its numbers: the error is no larger than that makes of a small one), or it is wrong: an error
above what is allowed, and no word about it.
"""

from __future__ import annotations

import math
import random
import time as clock
from collections.abc import Callable, Iterator, Sequence
from concurrent.futures.process import BrokenProcessPool
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import numpy as np

from ...cosim.prepared import Prepared
from ...cosim.results import RunFailed
from ...cosim.scene import Scene
from ...errors import CurveboundError
from ...mechanics.derived import Derived
from ..reference.equations import Array
from ..reference.motion import Motion
from .characteristic import Exact, exact
from .ranges import RandomPoint, draw, sampled
from .workers import without_interrupts, workers

__all__ = [
    "ALLOWED",
    "PARTS",
    "SampleSettings",
    "Sampled",
    "run_points",
    "run_sample",
    "sample_error",
]

#: largest relative error of an accurate point
ALLOWED = 1e-6
#: relative change of a point's numbers, by which its conditioning is found; that up to which no
#: more than ALLOWED is allowed
CHANGE = 1e-9
TAME = 10.0
#: communication steps of a run
PARTS = 20
#: a coordinate below this part of the system's length (a rate: of length per characteristic time)
#: counts as at rest, and is measured by that
REST = 1e-6
#: coordinates, then their rates, in the order of the reference's states
_ENERGY = ("energy.kinetic", "energy.potential", "energy.residual")
_WORK = ("solver.steps", "solver.evaluations")


@dataclass(frozen=True)
class SampleSettings:
    """What a sample is run with: `times` characteristic times, at most `max_steps` a step."""

    system: str | Path
    method: str = "adaptive"
    tolerance: float = 1e-8
    times: float = 10.0
    max_steps: int = 20000
    fmu: Path | None = None


@dataclass
class Sampled:
    """What became of a point.

    verdict: accurate, failed, warned (inaccurate, and the FMU said so), sensitive (inaccurate, as
    its conditioning lets expect), wrong, crashed, or unknown (no reference). error: the largest
    over all outputs and times, relative. energy: the largest residual over the energy at stake.
    """

    point: RandomPoint
    verdict: str
    error: float = float("nan")
    output: str = ""
    energy: float = float("nan")
    end: float = float("nan")
    steps: int = 0
    evaluations: int = 0
    seconds: float = 0.0
    message: str = ""


@dataclass
class _Worker:
    """A process's scene, kept from point to point."""

    settings: SampleSettings
    prepared: Prepared = field(init=False)
    derived: Derived = field(init=False)

    def __post_init__(self) -> None:
        settings = self.settings
        folder, self.derived = sampled(settings.system)
        scene = Scene(f"sample_{folder.path.name}", stop_time=1.0, step=1.0)
        scene.add(
            "plant",
            settings.fmu or folder.path,
            {
                "solver.method": settings.method,
                "solver.tolerance": settings.tolerance,
                "solver.max_steps": settings.max_steps,
            },
        )
        names = (*self.derived.coordinates, *self.derived.rates, *_ENERGY, *_WORK)
        scene.record(*(f"plant.{name}" for name in names))
        self.prepared = scene.prepare()

    def run(self, point: RandomPoint) -> Sampled:
        """Judge one point."""
        settings = self.settings
        try:
            reference = exact(self.derived, point.values, count=settings.times, parts=PARTS)
        except CurveboundError as error:
            return Sampled(point, "unknown", message=str(error))
        outcome = Sampled(point, "accurate", end=reference.end)
        start = {f"plant.{name}": value for name, value in point.values.items()}
        began = clock.perf_counter()
        try:
            result = self.prepared.run(start, stop_time=reference.end, step=reference.end / PARTS)
        except RunFailed as failure:
            outcome.seconds = clock.perf_counter() - began
            outcome.verdict, outcome.message = "failed", failure.cause
            return outcome
        outcome.seconds = clock.perf_counter() - began
        names = (*self.derived.coordinates, *self.derived.rates, *_ENERGY)
        columns = {name: result[f"plant.{name}"] for name in names}
        outcome.error, outcome.output = sample_error(self.derived, point, reference, columns)
        outcome.energy = _energy(columns)
        outcome.steps = int(result["plant.solver.steps"][-1])
        outcome.evaluations = int(result["plant.solver.evaluations"][-1])
        if not outcome.error <= ALLOWED:
            said = [note for note in result.notes if note.startswith("plant: ")]
            outcome.message = f"error {outcome.error:.1e}"
            if said:
                outcome.verdict = "warned"
                outcome.message += f"; {said[0]}"
                return outcome
            conditioning = _conditioning(self.derived, point, reference)
            tame = outcome.error > ALLOWED * conditioning / TAME
            outcome.verdict = "wrong" if tame else "sensitive"
            outcome.message += f" of {outcome.output}, conditioning {conditioning:.1e}"
        return outcome


def sample_error(
    derived: Derived, point: RandomPoint, reference: Exact, columns: dict[str, Array]
) -> tuple[float, str]:
    """The largest relative error over time, and the output that has it.

    Each coordinate and rate is measured by its own largest value in the run; angles by a radian, or
    by the angle turned through where that is more; what hardly moves by REST of the length.
    """
    names = (*derived.coordinates, *derived.rates)
    half = len(derived.coordinates)
    exact_values = reference.states[[*range(half), *range(2, 2 + half)]]
    time = reference.end / 10.0
    unit = float(np.ravel(Motion(derived, point.values).unit())[0])
    worst, name_of_worst = 0.0, ""
    for i, name in enumerate(names):
        values = exact_values[i]
        coordinate = exact_values[i % half]
        if derived.angles[i % half]:
            length = max(1.0, float(np.abs(coordinate - coordinate[0]).max()))
        else:
            length = max(unit, float(np.abs(coordinate).max()))
        if i >= half:
            scale = max(float(np.abs(values).max()), REST * length / time)
        elif derived.angles[i]:
            scale = length
        else:
            scale = max(float(np.abs(values).max()), REST * length)
        error = float(np.abs(columns[name] - values).max()) / scale
        if math.isnan(error):
            error = math.inf
        if error > worst:
            worst, name_of_worst = error, name
    return worst, name_of_worst


def _conditioning(derived: Derived, point: RandomPoint, reference: Exact) -> float:
    """How much the motion magnifies a relative change of the point's numbers; at least 1.

    The largest of three changes of all of them by CHANGE, up or down.
    """
    rng = random.Random(point.number)
    names = (*derived.coordinates, *derived.rates)
    half = len(derived.coordinates)
    found = 1.0
    for _ in range(3):
        values = {
            name: value if isinstance(value, str) else value * (1.0 + rng.choice((-1, 1)) * CHANGE)
            for name, value in point.values.items()
        }
        try:
            other = exact(derived, values, parts=PARTS, end=reference.end)
        except CurveboundError:
            continue  # a motion that another comes near to
        rows = other.states[[*range(half), *range(2, 2 + half)]]
        columns = dict(zip(names, rows, strict=True))
        found = max(found, sample_error(derived, point, reference, columns)[0] / CHANGE)
    return found


def _energy(columns: dict[str, Array]) -> float:
    """The largest residual over the energy at stake."""
    potential = columns["energy.potential"]
    at_stake = np.abs(columns["energy.kinetic"]).max() + np.abs(potential - potential[0]).max()
    residual = float(np.abs(columns["energy.residual"]).max())
    return residual / float(at_stake) if at_stake > 0.0 else residual


_worker: _Worker | None = None


def _begin(settings: SampleSettings) -> None:
    global _worker
    _worker = _Worker(settings)


def run_points(settings: SampleSettings, points: Sequence[RandomPoint]) -> list[Sampled]:
    """The outcomes of points, run one after the other in this process."""
    worker = _Worker(settings)
    try:
        return [worker.run(point) for point in points]
    finally:
        worker.prepared.close()


def _judged(points: Sequence[RandomPoint]) -> list[Sampled]:
    assert _worker is not None
    return [_worker.run(point) for point in points]


def run_sample(
    settings: SampleSettings,
    count: int,
    seed: int,
    *,
    jobs: int = 1,
    progress: Callable[[int], None] | None = None,
) -> list[Sampled]:
    """The outcomes of the first `count` points, in their order; the same for any number of jobs.

    progress: called with the number of points done. A point that ends its process is reported as
    crashed, and the others go on.
    """
    points = draw(settings.system, count, seed)
    outcomes: list[Sampled] = []
    for part in _parts(settings, points, jobs):
        outcomes += part
        if progress is not None:
            progress(len(outcomes))
    return sorted(outcomes, key=lambda one: one.point.number)


def _parts(
    settings: SampleSettings, points: Sequence[RandomPoint], jobs: int
) -> Iterator[list[Sampled]]:
    """Outcomes by chunks of points, each computed in another process."""
    size = max(1, min(20, len(points) // (4 * jobs)))
    chunks = [points[i : i + size] for i in range(0, len(points), size)]
    while chunks:
        lost: list[Sequence[RandomPoint]] = []
        with workers(jobs, _begin, (settings,)) as pool:
            with without_interrupts():
                futures: list[Any] = [pool.submit(_judged, chunk) for chunk in chunks]
            for chunk, future in zip(chunks, futures, strict=True):
                try:
                    yield future.result()
                except BrokenProcessPool:
                    lost.append(chunk)
        if not lost:
            return
        # one of the lost points ends its process: find it in the first chunk, alone
        for point in lost[0]:
            with workers(1, _begin, (settings,)) as pool:
                with without_interrupts():
                    future = pool.submit(_judged, [point])
                try:
                    yield future.result()
                except BrokenProcessPool:
                    yield [Sampled(point, "crashed", message="the FMU ended its process")]
        chunks = lost[1:]

"""Maps of a parameter against the step, for each method, with boundaries found by bisection."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass, field

from ...cosim.fmu import Value
from .probe import ACCURATE, FAILED, UNKNOWN, UNSTABLE, Probe, Probed

__all__ = ["MAPPED", "Column", "StabilityMap", "is_stable", "map_column", "sizes_of"]

#: methods that a map has by default
MAPPED = ("explicit_euler", "semi_implicit_euler", "rk4", "implicit", "adaptive")
#: a boundary is found to this ratio of the step
RESOLUTION = 1.02
#: so many accurate steps in a row, from the largest on: smaller ones are taken to be accurate
SURE = 3
#: steps tried, as parts of the run, and tolerances tried of adaptive
STEPS = (5e-6, 0.1, 22)
TOLERANCES = (1e-10, 1e-1, 10)


@dataclass
class Column:
    """One method at one value of the parameter.

    duration: of its runs, in s. verdicts: by step (s; the tolerance of adaptive), ascending;
    `assumed` ones were not run. accurate, stable: the largest up to which the method is so; NaN
    where the smallest tried is not, infinite where the largest is. at_rest, in_motion: the
    boundaries of linear theory (s).
    """

    value: float
    duration: float
    verdicts: dict[float, Probed] = field(default_factory=dict)
    assumed: set[float] = field(default_factory=set)
    accurate: float = math.nan
    stable: float = math.nan
    at_rest: float = math.nan
    in_motion: float = math.nan

    @property
    def sizes(self) -> list[float]:
        """What was tried, ascending."""
        return list(self.verdicts)


@dataclass
class StabilityMap:
    """A method's map: one column for each value, ascending."""

    method: str
    columns: list[Column]

    @property
    def size_is(self) -> str:
        """What the columns' sizes are."""
        return "tolerance" if self.method == "adaptive" else "step (s)"


def is_stable(verdict: Probed) -> bool:
    """Whether a run was right in kind, if not in number."""
    return verdict.kind not in (UNSTABLE, FAILED, UNKNOWN)


def is_accurate(verdict: Probed) -> bool:
    """Whether a run was right."""
    return verdict.kind == ACCURATE


def sizes_of(method: str, duration: float, steps: tuple[float, float, int] | None) -> list[float]:
    """The sizes to try: `steps` (least, most in s, count), or parts of the run; ascending."""
    if method == "adaptive":
        low, high, count = TOLERANCES
    elif steps is not None:
        low, high, count = steps
    else:
        low, high, count = duration * STEPS[0], duration * STEPS[1], STEPS[2]
    return [low * (high / low) ** (i / (count - 1)) for i in range(count)]


def map_column(probe: Probe, method: str, value: Value, sizes: Sequence[float]) -> Column:
    """Run every size, the largest first, then find the boundaries between them."""
    column = Column(float(value), probe.duration)
    row = 0
    for size in sorted(sizes, reverse=True):
        if row >= SURE:
            column.verdicts[size] = Probed(ACCURATE)
            column.assumed.add(size)
            continue
        verdict = column.verdicts[size] = probe.run(value, method, size)
        row = row + 1 if is_accurate(verdict) else 0
        if verdict.kind == UNKNOWN:
            column.verdicts.update(dict.fromkeys(sizes, verdict))
            break
    column.verdicts = dict(sorted(column.verdicts.items()))
    column.accurate = _boundary(probe, method, value, column, is_accurate)
    column.stable = _boundary(probe, method, value, column, is_stable)
    tried = column.sizes
    column.at_rest, column.in_motion = probe.linear_boundaries(
        value, method, 0.1 * tried[0], 10.0 * tried[-1]
    )
    return column


def _boundary(
    probe: Probe, method: str, value: Value, column: Column, holds: Callable[[Probed], bool]
) -> float:
    """The largest size up to which `holds` is true, by bisection between two of the grid."""
    low = math.nan
    for size, verdict in column.verdicts.items():
        if not holds(verdict):
            break
        low = size
    else:
        return math.inf
    if math.isnan(low):
        return low
    high = size
    while high > RESOLUTION * low:
        middle = math.sqrt(low * high)
        if holds(probe.run(value, method, middle)):
            low = middle
        else:
            high = middle
    return low

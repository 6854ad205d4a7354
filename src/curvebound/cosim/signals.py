"""Scene inputs: constants, functions of time and tables."""

from __future__ import annotations

from bisect import bisect_right
from collections.abc import Callable
from itertools import pairwise
from pathlib import Path
from typing import Any

import numpy as np

from ..errors import CurveboundError, OutsideError, reading, said
from .tables import read_csv

__all__ = ["Signal", "SignalLike", "jumps_of", "signal", "unusable", "value_of"]

Signal = Callable[[float], float]
SignalLike = float | int | bool | Signal | str | Path | tuple[Any, Any]


def value_of(function: Signal, path: str, time: float) -> float:
    """What drives the input `path` at a time in s; OutsideError where the function fails."""
    try:
        return float(function(time))
    except Exception as error:
        raise unusable(path, time, error) from error


def unusable(path: str, time: float, error: Exception) -> OutsideError:
    """What to raise where the function that drives `path` gives no number at a time in s."""
    return OutsideError(
        f"The function that drives {path} fails at t = {time:.6g} s: {said(error)}. It must "
        "give a number at every time of the run."
    )


def signal(given: SignalLike, path: str, unit: str | None = None) -> float | Signal:
    """A number, or a function of time in s, from what a scene gives for the input `path`.

    unit: that of the input; a file may state another one behind the name of the column.
    given: a number; a function t -> value; a pair (times, values) of equal length, times never
        decreasing; or the path of a CSV file with a column `time` and one named `path` or as its
        variable. Between its points a table is linear, before and after them constant; a time
        given twice is a jump, and the later value holds at that time.
    """
    if isinstance(given, str | Path):
        return _table(*_columns(Path(given), path, unit), what=f"{given}, input {path}")
    if callable(given):
        return given
    with reading(f"input {path}", "Give a number, a function of time, (times, values) or a CSV."):
        if isinstance(given, tuple):
            times, values = ([float(x) for x in part] for part in given)
            return _table(times, values, what=f"the table of input {path}")
        return float(given)


def _columns(file: Path, path: str, unit: str | None) -> tuple[list[float], list[float]]:
    able = (path, path.partition(".")[2])
    table = read_csv(file, dict.fromkeys(able, unit))
    names = table.dtype.names or ()
    for name in able:
        if name in names and "time" in names:
            return table["time"].tolist(), table[name].tolist()
    raise CurveboundError(
        f"{file} must have the columns time and {path} to be that input; it has {', '.join(names)}."
    )


def _table(times: list[float], values: list[float], what: str) -> Signal:
    if not times or len(times) != len(values):
        raise CurveboundError(
            f"{what}: {len(times)} times and {len(values)} values; give equally many, at least one."
        )
    if not (np.all(np.isfinite(times)) and np.all(np.isfinite(values))):
        raise CurveboundError(f"{what}: holds NaN or infinity; give finite numbers.")
    if any(b < a for a, b in pairwise(times)):
        raise CurveboundError(f"{what}: its times go back; sort them.")
    # a communication point n H may lie some ulp before the time of a jump that is meant
    near = [t - 4e-16 * abs(t) for t in times]
    last = len(times) - 1

    def interpolated(t: float) -> float:
        i = bisect_right(near, t) - 1
        if i < 0:
            return values[0]
        if i >= last:
            return values[last]
        share = max(0.0, (t - times[i]) / (times[i + 1] - times[i]))
        return values[i] + share * (values[i + 1] - values[i])

    pairs = pairwise(zip(times, values, strict=True))
    jumps = [a for (a, before), (b, after) in pairs if a == b and before != after]
    interpolated.jumps = jumps  # type: ignore[attr-defined]
    return interpolated


def jumps_of(function: Signal) -> list[float]:
    """Times at which a signal is known to jump: those that its table gives twice."""
    return list(getattr(function, "jumps", ()))

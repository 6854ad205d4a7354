"""The settings that may be the cheapest for some error, timed again, in turns.

One timing ranks nothing: the machine's speed changes from one to the next. Those that come near the
cheapest are timed in rounds, each once in every round, so that a slow moment meets all of them.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping
from statistics import median
from typing import Any

from ..runner import Runner
from ..settings import Setting
from .lessons import LEVELS, cheapest, usable

__all__ = ["contenders", "time_again"]

Row = dict[str, Any]
_NEAR = 1.5  # times the cost of the cheapest
_ROUNDS = 4


def contenders(rows: Iterable[Row]) -> list[Row]:
    """Rows whose first timing is near that of the cheapest for one of LEVELS."""
    good = usable(rows)
    found: dict[str, Row] = {}
    for level in LEVELS:
        best = cheapest(good, level)
        for row in good:
            if best is not None and row["error"] <= level and row["cpu"] <= _NEAR * best["cpu"]:
                found[row["key"]] = row
    return list(found.values())


def time_again(
    rows: Iterable[Row],
    settings: Mapping[str, Setting],
    runner: Runner,
    tell: Callable[[], None] = lambda: None,
) -> list[Row]:
    """Give every contender that has none yet cpu_low and cpu_high, the range of its timings, and
    their median as cpu; returns those rows.

    settings: by the rows' keys.
    """
    again = [row for row in contenders(rows) if "cpu_low" not in row and row["key"] in settings]
    times = {row["key"]: [float(row["cpu"])] for row in again}
    for _ in range(_ROUNDS):
        for row in again:
            tell()
            cost = runner.cost(settings[row["key"]], runs=1, enough=0.01)
            times[row["key"]].append(cost)
    for row in again:
        found = times[row["key"]]
        row |= {"cpu": median(found), "cpu_low": min(found), "cpu_high": max(found)}
    return again

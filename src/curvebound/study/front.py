"""Choosing among the rows of a study: the Pareto front and the cheapest for a given error."""

from __future__ import annotations

import math
from collections.abc import Iterable, Sequence
from typing import Any

__all__ = ["cheapest", "equals", "pareto", "usable"]

Row = dict[str, Any]


def usable(rows: Iterable[Row], purpose: str = "micro", error: str = "error") -> list[Row]:
    """Rows that ran to the end with a finite error."""
    return [
        row
        for row in rows
        if row["purpose"] == purpose and not row["failure"] and math.isfinite(row[error])
    ]


def pareto(rows: Sequence[Row], error: str = "error") -> list[Row]:
    """Rows that no other row beats in both cost and error, from cheap to dear.

    A row must be clearly better than a cheaper one, by 10 %: timings are not surer than that.
    """
    front: list[Row] = []
    best = math.inf
    for row in sorted(rows, key=lambda r: (r["cpu"], r[error])):
        if row[error] < 0.9 * best:
            front.append(row)
            best = row[error]
    return front


def cheapest(rows: Sequence[Row], bound: float, error: str = "error") -> Row | None:
    """The cheapest row with an error below the bound."""
    good = [row for row in rows if row[error] <= bound]
    return min(good, key=lambda row: row["cpu"], default=None)


def equals(rows: Sequence[Row], bound: float, error: str = "error") -> list[Row]:
    """Rows of other forms and methods that timing does not tell from the cheapest one.

    Those whose lowest cost is below the highest of the cheapest: the best one of each.
    """
    best = cheapest(rows, bound, error)
    if best is None:
        return []
    found: dict[tuple[str, str], Row] = {(best["form"], best["method"]): best}
    for row in sorted(rows, key=lambda r: float(r["cpu"])):
        if row[error] <= bound and row.get("cpu_low", row["cpu"]) <= best.get("cpu_high", 0.0):
            found.setdefault((row["form"], row["method"]), row)
    return [row for row in found.values() if row is not best]

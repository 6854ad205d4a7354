"""Loops over the stages of a Lobatto step.

Written out where they are called when compiled (runtime.WRITTEN_OUT).
"""

from __future__ import annotations

import math
from typing import Final

from .lobatto_tables import NODES, STAGES, WEIGHTS, A, R, Stages, Table

__all__ = ["LAST", "LATE", "apart", "copy", "fill", "follow", "weighted"]

#: number of the last stage, and of the first of the late half
LAST: Final = STAGES - 1
LATE: Final = 5


def fill(k: Stages, value: float) -> None:
    """Set all but the first."""
    for i in range(1, STAGES):
        k[i] = value


def copy(source: Stages, target: Stages) -> None:
    """Set the elements of target to those of source."""
    for i in range(STAGES):
        target[i] = source[i]


def follow(rates: bool, h: float, k: Stages, x: Stages, w: Stages, start: int, stop: int) -> None:
    """Set the stages start to stop - 1, x and w, of a coordinate with the accelerations k."""
    for i in range(start, stop):
        x[i] = x[0] + (NODES[i] * h * w[0] + h * h * weighted(R, STAGES * i, k, i % LAST - STAGES))
    if rates:
        for i in range(start, stop):
            w[i] = w[0] + h * weighted(A, STAGES * i, k, i - STAGES)


def weighted(table: Table, row: int, k: Stages, first: int) -> float:
    """The row that begins at `row` times k, added in pairs.

    It begins with the element that belongs to k[first]; counted from the end, k is a circle.
    """
    return (
        (table[row] * k[first] + table[row + 1] * k[first + 1])
        + (table[row + 2] * k[first + 2] + table[row + 3] * k[first + 3])
    ) + (
        (table[row + 4] * k[first + 4] + table[row + 5] * k[first + 5])
        + (table[row + 6] * k[first + 6] + table[row + 7] * k[first + 7])
    )


def apart(k: Stages, before: Stages) -> float:
    """The most by which the mean over the step can differ between k and before."""
    return (
        (WEIGHTS[1] * math.fabs(k[1] - before[1]) + WEIGHTS[2] * math.fabs(k[2] - before[2]))
        + (WEIGHTS[3] * math.fabs(k[3] - before[3]) + WEIGHTS[4] * math.fabs(k[4] - before[4]))
        + (WEIGHTS[5] * math.fabs(k[5] - before[5]) + WEIGHTS[6] * math.fabs(k[6] - before[6]))
    ) + WEIGHTS[7] * math.fabs(k[7] - before[7])

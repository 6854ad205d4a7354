"""How a communication step is cut into internal steps of a given size."""

from __future__ import annotations

import math

from .table import EPSILON

__all__ = ["substeps"]


def substeps(duration: float, step: float, time: float) -> float:
    """Fewest internal steps not larger than `step` in a communication step of `duration` at `time`.

    The caller's duration is a difference of times and so uncertain by a few ulp of the time; that
    uncertainty adds no step. Returned as a float because it may exceed every int of interest.
    """
    slack = 4.0 * EPSILON * (abs(time) + duration)
    ratio = (duration - slack) / step
    if ratio <= 1.0:
        return 1.0
    if ratio >= 1e18:
        return ratio
    return float(math.ceil(ratio))

"""What an error is, and how far a reference can judge it."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

__all__ = ["MARGIN", "Verdict", "judge"]

#: an uncertainty this many times below an error can judge it
MARGIN = 100.0
_SHORTEST = 0.1  # of the run: judged for less, a result counts as not judged


@dataclass(frozen=True)
class Verdict:
    """Error of one output over a run, in its unit.

    final: at the last time judged; worst: largest up to there; until: that time in s.
    judged: whether the reference is at least MARGIN times surer than `worst`; otherwise `worst`
        is known to be below `bound` only.
    """

    final: float
    worst: float
    until: float
    judged: bool
    bound: float


def judge(
    times: NDArray[Any], error: NDArray[Any], doubt: NDArray[Any], *, least: float = 0.0
) -> Verdict:
    """Judge an error, shape (k,), given the reference's uncertainty at the same times.

    least: error in the output's unit below which one need not know it: an uncertainty MARGIN times
        below that will do.
    """
    size = np.abs(np.asarray(error, dtype=float))
    size = np.where(np.isfinite(size), size, np.inf)
    running = np.maximum.accumulate(size)
    sure = doubt * MARGIN <= np.maximum(running, least)
    whole = times[-1] - times[0]
    last = int(np.flatnonzero(sure)[-1]) if sure.any() else 0
    until = float(times[last])
    bound = float(running[-1] + doubt[-1])
    if last < len(times) - 1 and until - times[0] < _SHORTEST * whole:
        return Verdict(float(size[-1]), float(running[-1]), float(times[-1]), False, bound)
    return Verdict(float(size[last]), float(running[last]), until, True, bound)

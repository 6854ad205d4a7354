"""Extrapolated midpoint rule in extended precision: the second opinion on a reference.

Gragg's method with the even harmonic sequence, extrapolated to as many columns as the step needs
(Hairer, Norsett and Wanner, "Solving Ordinary Differential Equations I", sec. II.9, without the
smoothing step).
"""

from __future__ import annotations

from typing import Any

import numpy as np

from ..errors import CurveboundError
from .collocation import NOISE, Rates
from .equations import Array

__all__ = ["extrapolate"]

Number = np.longdouble
_COLUMNS = 13
_TOLERANCE = 30 * NOISE
_ROUNDING = 1e6 * NOISE
_SHORTEST = 1e-13


def extrapolate(
    rates: Rates, begin: float, end: float, state: Array, *, size: float
) -> tuple[Array, float]:
    """The state at `end` from that at `begin`, shape (n, members), and the next step's size (s)."""
    time, stop = Number(begin), Number(end)
    single = state.shape[1] == 1
    state = state[:, 0] if single else state  # scalars are quicker than arrays of one
    span = stop - time
    h = min(Number(size), span)
    while stop - time > 0:
        rest = stop - time
        h = rest if h > 0.7 * rest else h
        with np.errstate(all="ignore"):
            after, columns = _step(rates, time, h, state)
        if after is None:
            h = h / 2
            if not h > _SHORTEST * span:
                raise CurveboundError(
                    f"The reference cannot be continued beyond t = {float(time):.6g} s: the motion "
                    "is singular there, or an input is not a function of bounded variation."
                )
            continue
        state = after
        whole = h >= rest
        time = stop if whole else time + h
        h = h * (1.5 if columns <= 8 else 1.0 if columns <= 10 else 0.8)
    return state[:, None] if single else state, float(h)


def _step(rates: Rates, time: Any, h: Any, state: Array) -> tuple[Array | None, int]:
    """One step, and the columns that it took; None if they do not suffice."""
    first = rates(time, state)
    scale = np.maximum(np.abs(state), np.abs(h * first)) + Number(1e-3)
    row: list[Array] = []
    best, found = np.inf, state
    for k in range(1, _COLUMNS + 1):
        new = [_midpoint(rates, time, h, state, first, 2 * k)]
        for j in range(1, k):
            factor = (Number(k) / Number(k - j)) ** 2 - 1
            new.append(new[j - 1] + (new[j - 1] - row[j - 1]) / factor)
        if k > 2:
            error = float((np.abs(new[-1] - row[-1]) / scale).max())
            if error < _TOLERANCE:
                return new[-1], k
            # rounding, amplified by the extrapolation: what was best is as good as it gets
            if best < _ROUNDING and error > best:
                return found, k
            if not error < 1e9:
                return None, k
            best, found = error, new[-1]
        row = new
    return None, _COLUMNS


def _midpoint(rates: Rates, time: Any, h: Any, state: Array, first: Array, count: int) -> Array:
    """`count` steps of the midpoint rule over h."""
    part = h / count
    before, now = state, state + part * first
    for i in range(1, count):
        before, now = now, before + 2 * part * rates(time + i * part, now)
    result: Array = now
    return result

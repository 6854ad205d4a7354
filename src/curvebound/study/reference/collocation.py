"""Gauss collocation in extended precision, with dense output: what references are computed with.

In each step the rate of the state is a polynomial of degree s - 1 that satisfies the equations at
the s Gauss points (Hairer, Norsett and Wanner, "Solving Ordinary Differential Equations I", sec.
II.7; order 2 s at the end of the step), found by Picard iteration over all points at once. Its
Legendre coefficients fall geometrically for smooth motion: the last ones say whether the step is
short enough.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from functools import lru_cache
from typing import Any

import numpy as np

from ...errors import CurveboundError
from .equations import Array

__all__ = ["NOISE", "Rates", "Trajectory", "collocate"]

Number = np.longdouble
#: times (k, 1) and states (n, k, members) to rates, shape (n, k, members)
Rates = Callable[[Array, Array], Array]

#: relative rounding of the arithmetic: 1.1e-19 where long double has 64 bits, otherwise a double's
NOISE = float(np.finfo(Number).eps)
_TOLERANCE = 30 * NOISE
_ROUNDING = 1e5 * NOISE
_SWEEPS = 60
_SHORTEST = 1e-13  # of a step, relative to the span


@lru_cache(maxsize=8)
def _tables(s: int) -> tuple[Array, Array, Array, Array]:
    """Gauss points in (0, 1), shape (s,); rates at them to Legendre coefficients, (s, s);
    coefficients to the integral up to each point, (s, s); product of the two."""
    import mpmath

    with mpmath.workdps(40):
        points = [mpmath.mpf(float(x)) for x in np.polynomial.legendre.leggauss(s)[0]]
        for _ in range(3):  # Newton's method, from 16 digits to 40 and more
            points = [x - _newton(mpmath, s, x) for x in points]
        weights = [2 * (1 - x * x) / ((s + 1) * mpmath.legendre(s + 1, x)) ** 2 for x in points]
        pairs = list(zip(points, weights, strict=True))
        to_legendre = [
            [(2 * j + 1) * w / 2 * mpmath.legendre(j, x) for x, w in pairs] for j in range(s)
        ]
        integral = [[_integral(mpmath, j, x) for j in range(s)] for x in points]
        nodes = [(x + 1) / 2 for x in points]
        text = np.vectorize(lambda v: mpmath.nstr(v, 30), otypes=[object])
        arrays = [np.array(text(np.array(a, dtype=object)), dtype=str).astype(Number)
                  for a in (nodes, to_legendre, integral)]  # fmt: skip
    return arrays[0], arrays[1], arrays[2], arrays[2] @ arrays[1]


def _newton(mp: Any, s: int, x: Any) -> Any:
    """The s-th Legendre polynomial at x over its derivative."""
    value = mp.legendre(s, x)
    return value * (1 - x * x) / (s * (mp.legendre(s - 1, x) - x * value))


def _integral(mp: Any, j: int, x: Any) -> Any:
    """Integral of the j-th Legendre polynomial from the start of the step to x, step = 1."""
    if j == 0:
        return (x + 1) / 2
    return (mp.legendre(j + 1, x) - mp.legendre(j - 1, x)) / (2 * (2 * j + 1))


def _integrals(s: int, share: Array) -> Array:
    """The same at many points, shape (k, s); share: of the step, shape (k,)."""
    x = 2 * share - 1
    legendre = [np.ones_like(x), x]
    for j in range(1, s):
        legendre.append(((2 * j + 1) * x * legendre[j] - j * legendre[j - 1]) / (j + 1))
    columns = [share]
    columns += [(legendre[j + 1] - legendre[j - 1]) / (2 * (2 * j + 1)) for j in range(1, s)]
    return np.stack(columns, axis=-1)


class Trajectory:
    """A solution as polynomials: states at any time, in extended precision."""

    def __init__(self, start_time: float, state: Array) -> None:
        self.begin = start_time
        self.end = start_time
        self.final = state
        self._times: list[float] = []
        self._sizes: list[Any] = []
        self._states: list[Array] = []
        self._coefficients: list[Array] = []

    def append(self, time: float, size: Any, state: Array, coefficients: Array, end: Array) -> None:
        """Add a step: its start, size (s), state (n, members), coefficients (n, s, members)."""
        self._times.append(time)
        self._sizes.append(size)
        self._states.append(state)
        self._coefficients.append(coefficients)
        self.final = end
        self.end = float(time + size)

    def arrays(self) -> dict[str, Array]:
        """All of it as arrays, for `of_arrays`."""
        return {
            "begin": np.array(self.begin),
            "end": np.array(self.end),
            "final": self.final,
            "times": np.array(self._times, dtype=float),
            "sizes": np.array(self._sizes, dtype=Number),
            "states": np.array(self._states, dtype=Number),
            "coefficients": np.array(self._coefficients, dtype=Number),
        }

    @classmethod
    def of_arrays(cls, arrays: Mapping[str, Array]) -> Trajectory:
        """The trajectory that `arrays` took apart."""
        made = cls(float(arrays["begin"]), arrays["final"])
        made.end = float(arrays["end"])
        made._times = [float(t) for t in arrays["times"]]
        made._sizes = list(arrays["sizes"])
        made._states = list(arrays["states"])
        made._coefficients = list(arrays["coefficients"])
        return made

    def extrapolated(self, share: Array) -> Array | None:
        """Integral of the last step's rate beyond its end, per its size: a first guess."""
        if not self._times:
            return None
        last = self._coefficients[-1]
        table = _integrals(last.shape[1], share + 1)
        return _apply(table, last) - last[:, :1]

    def states(self, times: Sequence[float] | Array) -> Array:
        """States at the times, shape (n, len(times), members); times within the solution."""
        wanted = np.asarray(times, dtype=Number)
        result = np.empty((self.final.shape[0], len(wanted), self.final.shape[1]), dtype=Number)
        if not self._times:
            result[:] = self.final[:, None]
            return result
        starts = np.array(self._times)
        index = np.clip(np.searchsorted(starts, np.asarray(times, float), "right") - 1, 0, None)
        order = np.argsort(index, kind="stable")
        cuts = np.flatnonzero(np.diff(index[order])) + 1
        for group in np.split(order, cuts):
            if not len(group):
                continue
            i = int(index[group[0]])
            share = (wanted[group] - Number(starts[i])) / self._sizes[i]
            table = _integrals(self._coefficients[i].shape[1], share)
            part = _apply(table, self._coefficients[i])
            result[:, group] = self._states[i][:, None] + self._sizes[i] * part
        at_end = np.flatnonzero(np.asarray(times, float) >= self.end)
        result[:, at_end] = self.final[:, None]
        return result


def collocate(
    rates: Rates,
    begin: float,
    end: float,
    trajectory: Trajectory,
    *,
    nodes: int,
    size: float,
    dense: float = _TOLERANCE,
) -> float:
    """Continue `trajectory` from `begin` to `end` (s) with steps near `size`; the next size.

    dense: relative error allowed between the ends of a step; at the ends it is of twice the order.
    The solution is smooth in between but for kinks, at which the steps become short. Raises
    CurveboundError where they become too short.
    """
    points, to_legendre, _, matrix = _tables(nodes)
    time, stop = Number(begin), Number(end)
    state = trajectory.final
    span = stop - time
    h = min(Number(size), span)
    while stop - time > 0:
        rest = stop - time
        # steps begin at doubles, in which the trajectory keeps its times
        h = rest if h > 0.7 * rest else Number(float(time + h)) - time
        done = _step(rates, time, h, state, trajectory, points, matrix)
        if done is None:
            h, rest = h / 4, h
            if not rest > _SHORTEST * span:
                raise CurveboundError(
                    f"The reference cannot be continued beyond t = {float(time):.6g} s: the motion "
                    "is singular there, or an input is not a function of bounded variation."
                )
            continue
        coefficients = _apply(to_legendre, done)
        scale = _scale(state, done, h)
        tail = np.abs(coefficients[:, -2:]).max(axis=1) * h / scale
        error = float(tail.max()) / dense
        if error > 10.0 and h > _SHORTEST * span:
            h = h * min(0.7, max(0.2, 0.9 * (10.0 / error) ** (1.0 / nodes)))
            continue
        after = state + h * coefficients[:, 0]
        trajectory.append(float(time), h, state, coefficients, after)
        state = after
        time = stop if h >= rest else time + h
        h = h * min(1.5, max(0.5, 0.9 * (1.0 / max(error, 1e-30)) ** (1.0 / nodes)))
    trajectory.end = end
    return float(h)


def _scale(state: Array, rate: Array, h: Any) -> Array:
    scale: Array = np.maximum(np.abs(state), np.abs(h * rate).max(axis=1)) + Number(1e-3)
    return scale


def _apply(matrix: Array, values: Array) -> Array:
    """The matrix (k, s) applied to the middle axis of values (n, s, members)."""
    result: Array = np.tensordot(matrix, values, (1, 1)).transpose(1, 0, 2)
    return result


def _step(
    rates: Rates, time: Any, h: Any, state: Array, trajectory: Trajectory, points: Array,
    matrix: Array,
) -> Array | None:  # fmt: skip
    """Rates at the points of one step, shape (n, s, members); None if they do not converge."""
    times = (time + h * points)[:, None]
    guess = trajectory.extrapolated(points * (h / trajectory._sizes[-1])) if (
        trajectory._times
    ) else None  # fmt: skip
    base = state[:, None]
    if guess is None:
        values = base + np.zeros_like(points)[:, None]
    else:
        values = base + trajectory._sizes[-1] * guess
    best = np.inf
    stalled = 0
    scale: Any = None
    for _ in range(_SWEEPS):
        with np.errstate(all="ignore"):
            rate = rates(times, values)
            improved = base + h * _apply(matrix, rate)
            if scale is None:
                scale = _scale(state, rate, h)
            change = np.abs(improved - values).max(axis=1) / scale
        values = improved
        size = float(change.max())
        if not size < 1e6:
            return None
        if size < 8 * NOISE:
            return rate
        # near the rounding the change no longer falls
        stalled = stalled + 1 if size > 0.7 * best else 0
        if stalled >= 3:
            return rate if size < _ROUNDING else None
        best = min(best, size)
    return None

"""References for stiff and violent motions: Radau IIA collocation in extended precision.

As in collocation.py, but with Newton's method in place of Picard iteration, so that
damping of any size costs no small steps, and with Radau points, whose method damps what is stiff
(Hairer, Wanner, "Solving Ordinary Differential Equations II", sec. IV.5). The Newton matrix is
solved in double precision: that costs iterations, not digits, which the residual alone determines.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from functools import lru_cache
from typing import Any, NamedTuple

import numpy as np

from ...errors import CurveboundError
from .collocation import NOISE, Trajectory
from .equations import Array
from .motion import Accelerations, Slopes

__all__ = ["Precise", "solve"]

Number = np.longdouble
#: relative size of the last Legendre coefficients of the rates; the error is some 1e-5 of it
TAIL = 1e-9
#: size of a coordinate below which it counts as resting beside the other
FLOOR = 1e-5
#: part of a coordinate per step below which its rate counts as rest
RESTING = 1e-12
ITERATIONS = 30
MOST_STEPS = 5000


class Precise(NamedTuple):
    """A reference: `trajectory` of (q0, q1, v0, v1), its end (s), and the steps that it took."""

    trajectory: Trajectory
    end: float
    steps: int


def solve(
    accelerations: Accelerations,
    slopes_of: Slopes,
    start: tuple[float, float, float, float],
    *,
    until: Callable[[Trajectory], float],
    longest: float,
    length: float,
    pace: Callable[[], float] = lambda: math.inf,
    stages: int = 10,
    tail: float = TAIL,
    resting: float = RESTING,
) -> Precise:
    """Integrate from `start` (q0, q1, v0, v1) to the end that `until` gives, at most `longest` s.

    slopes_of: derivatives of the accelerations. until: called after each step with the trajectory;
    gives the end of the motion (s) once it lies within it, else infinity. length: q0 in units of
    q1 (m), so that a coordinate at rest has a scale. pace: called after `until`; gives the longest
    step (s) that may follow, for between its ends long steps of stiff motion are all rounding.
    tail, resting: as TAIL and RESTING.
    Raises CurveboundError where the steps become too short or too many.
    """
    tables = tables_of(stages)
    state = np.array(start, dtype=Number)
    per = np.array([length, 1.0 / length, length, 1.0 / length])
    trajectory = Trajectory(0.0, state[:, None])
    time = 0.0
    h = min(_first(accelerations, state, longest), pace())
    last: tuple[Array, float] | None = None
    for tries in range(1, MOST_STEPS + 1):
        h = float(time + h) - time if time + h > time else 0.0
        if h == 0.0:  # less than the time can resolve
            raise CurveboundError(f"the reference's step vanishes at t = {time!r} s")
        done = _step(accelerations, slopes_of, tables, time, h, state, last)
        if done is None:
            h *= 0.25
            last = None
            continue
        rates, rounding = done
        coefficients = np.tensordot(tables.legendre, rates, (1, 1)).T
        size = np.maximum(np.abs(state), np.abs(h * rates).max(axis=1))
        size = np.maximum(size, FLOOR * size[[1, 0, 3, 2]] * per)
        size[2:] = np.maximum(size[2:], resting * size[:2] / h)
        size = np.where(size > 0, size, Number(1))
        # what rounding makes of the accelerations says nothing of the step
        last_terms = np.maximum(np.abs(coefficients[:, -2:]).max(axis=1) - rounding, 0)
        error = float((last_terms * h / size).max()) / tail
        if error > 1.0:
            h *= min(0.8, max(0.1, 0.8 * error ** (-1.0 / stages)))
            continue
        after = state + h * coefficients[:, 0]
        trajectory.append(time, Number(h), state[:, None], coefficients[:, :, None], after[:, None])
        state = after
        time = float(time + h)
        trajectory.end = time
        end = until(trajectory)
        if end <= time or time >= longest:
            return Precise(trajectory, min(end, longest), tries)
        last = (rates, h)
        h *= min(3.0, max(0.5, 0.8 * max(error, 1e-30) ** (-1.0 / stages)))
        h = min(h, pace(), 1.01 * (longest - time))
    raise CurveboundError(f"the reference takes more than {MOST_STEPS} steps, at t = {time!r} s")


def _first(accelerations: Accelerations, state: Array, longest: float) -> float:
    """A cautious first step (s)."""
    a = accelerations(np.zeros(1, Number), state[:2, None], state[2:, None])[:, 0]
    rate = 1.0 / longest
    for q, v, x in zip(state[:2], state[2:], a, strict=True):
        if v != 0 and q != 0:
            rate = max(rate, float(abs(v / q)))
        if v != 0:
            rate = max(rate, float(abs(x / v)))
        if q != 0:
            rate = max(rate, float(np.sqrt(abs(x / q))))
    return 0.1 / rate


def _step(
    accelerations: Accelerations,
    slopes_of: Slopes,
    tables: Tables,
    time: float,
    h: float,
    state: Array,
    last: tuple[Array, float] | None,
) -> tuple[Array, Array] | None:
    """Rates (4, s) of the state at the nodes, and the size of the rounding in them, (4,).

    None where Newton's method does not converge.
    """
    s = len(tables.nodes)
    times = Number(time) + h * tables.nodes
    q0 = state[:2, None] + h * tables.nodes * state[2:, None]
    k = accelerations(np.full(1, time, Number), state[:2, None], state[2:, None]) + np.zeros(
        (2, s), Number
    )
    if last is not None:
        share = 1 + tables.nodes * (h / last[1])
        k = _extrapolated(tables, last[0][2:], share)
    unit = np.repeat(_units(k, state, h), s)
    inverse: Array | None = None
    slopes = np.zeros((2, 2, 2, s))
    smallest = before = math.inf
    stalled = 0
    for _ in range(ITERATIONS):
        with np.errstate(all="ignore"):
            v = state[2:, None] + h * (k @ tables.integral.T)
            q = q0 + h * h * (k @ tables.twice.T)
            residual = (accelerations(times, q, v) - k).astype(float).ravel()
        if not np.all(np.isfinite(residual)):
            return None
        if inverse is None:
            found = _inverse(slopes_of, tables, times, q, v, h, unit)
            if found is None:
                return None
            inverse, slopes = found
        change = inverse @ (residual / unit)
        k = k + (change * unit).reshape(2, s)
        size = float(np.abs(change).max())
        if not size < 1e12:
            return None
        if size < 4 * NOISE:
            break
        if size > 0.1 * before and size > 1e-14:
            inverse = None
        before = size
        stalled = stalled + 1 if size > 0.5 * smallest else 0
        if stalled >= 3:
            # what is left is the rounding of coordinates and rates
            if smallest < 1e-12 or np.all(np.abs(residual) <= _rounding(slopes, q, v)):
                break
            return None
        smallest = min(smallest, size)
    else:
        return None
    v = state[2:, None] + h * (k @ tables.integral.T)
    q = q0 + h * h * (k @ tables.twice.T)
    noise = _rounding(slopes, q, v).reshape(2, s).max(axis=1)
    return np.concatenate([v, k]), np.concatenate([np.zeros(2), noise])


def _rounding(slopes: Array, q: Array, v: Array) -> Array:
    """What the rounding of the stages (q, v) makes of the accelerations there, shape (2 s,)."""
    sizes = np.abs(np.stack([q, v])).astype(float)
    found: Array = 16 * NOISE * np.einsum("kabs,kbs->as", slopes, sizes).ravel()
    return found


def _inverse(
    slopes_of: Slopes, tables: Tables, times: Array, q: Array, v: Array, h: float, unit: Array
) -> tuple[Array, Array] | None:
    """Inverse of the Newton matrix at the stages (q, v), in units of the coordinates.

    And sizes of the slopes of the accelerations there, shape (2, 2, 2, s).
    """
    s = len(times)
    # where one has none (a root at rest) the residual still decides
    slopes = np.nan_to_num(slopes_of(times, q, v), nan=0.0, posinf=0.0, neginf=0.0)
    # blocks of (s, s) by acceleration and coordinate
    of_q, of_v = h * h * slopes[0], h * slopes[1]
    twice, integral = tables.twice.astype(float), tables.integral.astype(float)
    blocks = of_q[..., None] * twice + of_v[..., None] * integral
    matrix = np.eye(2 * s) - blocks.transpose(0, 2, 1, 3).reshape(2 * s, 2 * s)
    try:
        inverse: Array = np.linalg.inv(matrix * (unit[None, :] / unit[:, None]))
    except np.linalg.LinAlgError:
        return None
    return (inverse, np.abs(slopes)) if np.all(np.isfinite(inverse)) else None


def _units(k: Array, state: Array, h: float) -> Array:
    """Sizes of the accelerations of both coordinates: what the step makes of them counts."""
    size = np.maximum(np.abs(k).max(axis=1), np.abs(state[2:]) / h).astype(float)
    size = np.maximum(size, np.abs(state[:2]).astype(float) / h / h * 1e-6)
    return np.where(size > 0.0, size, 1.0)


def _extrapolated(tables: Tables, k: Array, share: Array) -> Array:
    """The polynomial of the last step's accelerations (2, s) beyond its end."""
    coefficients = k @ tables.legendre.T
    x = 2 * share - 1
    legendre = [np.ones_like(x), x]
    for j in range(1, len(tables.nodes) - 1):
        legendre.append(((2 * j + 1) * x * legendre[j] - j * legendre[j - 1]) / (j + 1))
    # beyond twice the last step the highest terms run away
    keep = len(legendre) if float(share[-1]) < 3.0 else 4
    found: Array = coefficients[:, :keep] @ np.stack(legendre[:keep])
    return found


class Tables(NamedTuple):
    """Of the method with s stages on a step of size 1."""

    nodes: Array
    integral: Array  # rates at the nodes to their integrals up to each node
    twice: Array
    legendre: Array  # rates at the nodes to Legendre coefficients


@lru_cache(maxsize=4)
def tables_of(s: int) -> Tables:
    """Radau points of the right end, (s,), and the matrices (s, s) that belong to them."""
    import mpmath

    mp = mpmath
    with mp.workdps(50):
        # zeros of P_s - P_(s-1), one of them 1, by the Golub-Welsch eigenvalues as a start
        def radau(x: Any) -> Any:
            return mp.legendre(s, x) - mp.legendre(s - 1, x)

        off = [k / math.sqrt(4.0 * k * k - 1.0) for k in range(1, s)]
        jacobi = np.diag(off, 1) + np.diag(off, -1)
        jacobi[s - 1, s - 1] = s / (2.0 * s - 1.0)
        guesses = np.linalg.eigvalsh(jacobi)
        points = [mp.findroot(radau, mp.mpf(float(x))) for x in guesses[:-1]] + [mp.mpf(1)]
        values = mp.matrix(s, s)
        integrals = mp.matrix(s, s)
        for i, x in enumerate(points):
            for j in range(s):
                values[i, j] = mp.legendre(j, x)
                below = mp.legendre(j - 1, x) if j else mp.mpf(-1)
                integrals[i, j] = (mp.legendre(j + 1, x) - below) / (2 * (2 * j + 1))
        legendre = values**-1
        integral = integrals * legendre

        def extended(a: Any) -> Array:
            rows = [[mp.nstr(a[i, j], 25) for j in range(a.cols)] for i in range(a.rows)]
            return np.array(rows).astype(Number)

        nodes = extended(mp.matrix([(x + 1) / 2 for x in points]))[:, 0]
        return Tables(nodes, extended(integral), extended(integral * integral), extended(legendre))

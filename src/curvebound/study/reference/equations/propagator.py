"""The exact solution of a linear model with constant coefficients: the matrix exponential."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np

from .base import Array, Equations, Inputs, Number
from .mechanical import Mechanical

__all__ = ["propagator"]


def propagator(equations: Equations, inputs: Inputs, times: Sequence[float]) -> Array | None:
    """States at the times (30 digits) of a linear model whose shapes rest, None for any other.

    times: evenly spaced, the first one spacing after 0. Inputs are held from the start on.
    """
    import mpmath

    assert isinstance(equations, Mechanical)
    e = equations
    start = e.start()
    n = len(e.derived.coordinates)
    prescribed = start[2 * n :]
    rest = [s for x in e.derived.shapes for s in (start[_at(e, f"{x}_rate")],)]
    rest += [inputs[f"{x}_acceleration"] for x in e.derived.shapes]
    if not e.linear or any(np.any(x != 0) for x in rest):
        return None
    columns = [*start, *(x for x in e.parameters.values() if not isinstance(x, str))]
    columns += list(inputs.values())
    shape = np.broadcast_shapes(*(np.shape(x) for x in columns))
    members = shape[-1] if shape else 1
    states = np.zeros((len(start), len(times), members), dtype=Number)
    # the equations are linear: their matrix is what they say about the unit vectors
    size = 2 * n + 1
    basis = [np.zeros((size, members), dtype=Number) for _ in range(2 * n)]
    for i in range(2 * n):
        basis[i][i + 1] = 1
    probe = [*basis, *(np.broadcast_to(x, (members,)) for x in prescribed)]
    found = [np.broadcast_to(x, (size, members)) for x in e.accelerations(probe, inputs)]
    with mpmath.workdps(30):
        for j in range(members):
            matrix = mpmath.zeros(size)
            for i in range(n):
                matrix[i, n + i] = 1
                constant = _exact(mpmath, found[i][0, j])
                matrix[n + i, 2 * n] = constant
                for k in range(2 * n):
                    matrix[n + i, k] = _exact(mpmath, found[i][k + 1, j]) - constant
            z = [_exact(mpmath, np.broadcast_to(x, (members,))[j]) for x in start[: 2 * n]]
            now = mpmath.matrix([*z, 1])
            step = mpmath.mpf(times[-1]) / len(times)
            jump = mpmath.expm(matrix * step)
            for i, t in enumerate(times):
                now = jump * now
                # the times are even but for their rounding
                there = now + matrix * now * (mpmath.mpf(t) - (i + 1) * step)
                for row in range(2 * n):
                    states[row, i, j] = Number(mpmath.nstr(there[row], 25))
    at = np.array(times, dtype=Number)[:, None]
    if e.frame:
        push = [inputs[f"{e.derived.frame}.{n}"] for n in ("ax", "ay")]
        for i, a in enumerate(push):
            states[2 * n + i] = a * at * at / 2
            states[2 * n + 2 + i] = a * at
    for x in e.derived.shapes:
        states[_at(e, x)] = start[_at(e, x)]
    return states


def _at(e: Mechanical, name: str) -> int:
    """The place of a shape or its rate in the state."""
    return 2 * len(e.derived.coordinates) + len(e.frame) + e.moved.index(name)


def _exact(mp: Any, x: Any) -> Any:
    """An extended number as mpmath's, without loss."""
    high = float(x)
    return mp.mpf(high) + mp.mpf(float(x - Number(high)))

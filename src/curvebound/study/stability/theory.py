"""Where linear theory puts the end of stability of a method, for the system's own equations.

A step of h s of a method on z' = [[0, I], [Jq, Jv]] z multiplies z by a matrix S(h). The boundary
is the largest h up to which the energy of no mode grows, over the run, to more than FACTOR times
what it is in truth. Jq and Jv are taken at rest, or where the exact motion makes the boundary
smallest (frozen coefficients; moments at which the motion itself parts exponentially say nothing
and are left out): amplitude matters, and the two can be far apart.
"""

from __future__ import annotations

import math
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ..reference.motion import Motion

__all__ = ["FACTOR", "LIMITED", "boundary", "jacobians", "step_matrix", "swings"]

Matrix = NDArray[Any]
#: an oscillation's largest kinetic and potential energy together, what is at stake, are twice its
#: energy: where ten times that much too much is called unstable, it has grown to 21 times itself
FACTOR = 21.0
_BISECTIONS = 50
#: methods whose step has a limit that is known here
LIMITED = ("explicit_euler", "semi_implicit_euler", "rk4")


def step_matrix(method: str, a: Matrix, h: float) -> Matrix:
    """What one step of `method` multiplies z by, for z' = a z with z = (q, v); shape of a (n, n).

    KeyError for a method that is not in LIMITED.
    """
    n = len(a)
    half = n // 2
    one = np.eye(n)
    z = h * a
    if method == "explicit_euler":
        return one + z
    if method == "rk4":
        return one + z @ (one + z @ (one / 2 + z @ (one / 6 + z / 24)))
    if method == "semi_implicit_euler":
        moved = np.eye(n)
        moved[half:] += z[half:]
        moved[:half] += h * moved[half:]
        return moved
    raise KeyError(method)


def boundary(method: str, a: Matrix, duration: float, least: float, most: float) -> float:
    """The largest stable step (s) between `least` and `most`: infinite beyond, 0 below."""
    growth = math.log(FACTOR) + 2.0 * duration * max(0.0, float(np.linalg.eigvals(a).real.max()))

    def stable(h: float) -> bool:
        radius = float(np.abs(np.linalg.eigvals(step_matrix(method, a, h))).max())
        if not math.isfinite(radius):
            return False
        return radius <= 1.0 or 2.0 * duration / h * math.log(radius) <= growth

    if stable(most):
        return math.inf
    if not stable(least):
        return 0.0
    low, high = math.log(least), math.log(most)
    for _ in range(_BISECTIONS):
        middle = 0.5 * (low + high)
        low, high = (middle, high) if stable(math.exp(middle)) else (low, middle)
    return math.exp(low)


def swings(a: Matrix) -> bool:
    """Whether the fastest modes of z' = a z oscillate or decay."""
    modes = np.linalg.eigvals(a)
    return bool(modes.real.max() <= 0.1 * np.abs(modes).max())


def jacobians(motion: Motion, states: Matrix) -> list[Matrix]:
    """The matrices a, (4, 4), at states (q0, q1, v0, v1), shape (4, n), at the start."""
    count = states.shape[1]
    slopes = motion.slopes(np.zeros(count), states[:2], states[2:])
    found = []
    for i in range(count):
        a = np.zeros((4, 4))
        a[0, 2] = a[1, 3] = 1.0
        a[2:, :2], a[2:, 2:] = slopes[0, :, :, i], slopes[1, :, :, i]
        if np.all(np.isfinite(a)):
            found.append(a)
    return found

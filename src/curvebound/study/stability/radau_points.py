"""Radau IIA collocation of any number of stages, in extended precision."""

from __future__ import annotations

import math
from functools import lru_cache
from typing import Any, NamedTuple

import numpy as np

from ..equations import Array

__all__ = ["Tables", "tables_of"]

Number = np.longdouble


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

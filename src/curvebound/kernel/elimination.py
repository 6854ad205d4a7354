"""Gaussian elimination with row exchanges, in place, for the small systems of Newton's method."""

from __future__ import annotations

import math
from typing import Annotated, Final

__all__ = ["Exchanges", "Matrix", "Vector", "factorised", "substitute"]

#: room for 14 unknowns: a matrix by rows, a right side, the rows exchanged
Matrix = Annotated[list[float], 196]
Vector = Annotated[list[float], 14]
Exchanges = Annotated[list[int], 14]

LARGEST: Final = 1e300


def factorised(m: Matrix, rows: Exchanges, n: int) -> bool:
    """Replace the n x n matrix by its triangles, rows exchanged; False where it is singular."""
    for i in range(n):
        p = i
        most = math.fabs(m[n * i + i])
        for k in range(i + 1, n):
            x = math.fabs(m[n * k + i])
            if x > most:
                most = x
                p = k
        if not 0.0 < most <= LARGEST:
            return False
        rows[i] = p
        if p != i:
            for j in range(n):
                x = m[n * i + j]
                m[n * i + j] = m[n * p + j]
                m[n * p + j] = x
        inverse = 1.0 / m[n * i + i]
        for k in range(i + 1, n):
            f = m[n * k + i] * inverse
            if f != 0.0:
                for j in range(i + 1, n):
                    m[n * k + j] -= f * m[n * i + j]
            m[n * k + i] = f
    return True


def substitute(m: Matrix, rows: Exchanges, r: Vector, n: int) -> None:
    """Turn the right side r, n long, into the solution, with what factorised() left."""
    for i in range(n):
        p = rows[i]
        x = r[p]
        r[p] = r[i]
        row = n * i
        for j in range(i):
            x -= m[row + j] * r[j]
        r[i] = x
    for i in range(n - 1, -1, -1):
        x = r[i]
        row = n * i
        for j in range(i + 1, n):
            x -= m[row + j] * r[j]
        r[i] = x / m[row + i]

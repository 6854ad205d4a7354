"""Exact propagation of the linear model by its matrix exponential.

z' = A z with constant A over a communication step, so z(h) = (I + E) z(0), E = exp(A h) - I. E is
found by a Taylor series at a small argument and doubling, E(2h) = 2 E(h) + E(h)^2: without the
identity added in, slow modes beside fast ones keep their digits (scaling and squaring: Higham,
Functions of Matrices, 2008, sec. 10.3). The work integral of the quadratic form C,
S(h) = integral of exp(A s)' C exp(A s) over 0 <= s <= h, doubles with it (Van Loan 1978):
S(2h) = S(h) + (I + E)' S(h) (I + E).
"""

from __future__ import annotations

import math

from ..models.base import Model
from .base import DONE, NOT_FINITE, Method

__all__ = ["Exact", "propagator"]

Matrix = list[list[float]]

#: largest norm of A h at which the series is summed; 20 terms then reach rounding level
SMALL = 0.25
TERMS = 20


def product(a: Matrix, b: Matrix) -> Matrix:
    """The matrix product a b."""
    result: Matrix = []
    for row in a:
        sums = [0.0] * len(b[0])
        for k in range(len(b)):
            x = row[k]
            other = b[k]
            if x != 0.0:
                for j in range(len(sums)):
                    sums[j] += x * other[j]
        result.append(sums)
    return result


def transposed(a: Matrix) -> Matrix:
    """The transpose of a."""
    return [[row[j] for row in a] for j in range(len(a[0]))]


def balance(a: Matrix) -> list[float]:
    """Powers of two d such that diag(1/d) a diag(d) has rows and columns of like size.

    Parlett and Reinsch 1969, without permutation: removes the units from the norms.
    """
    n = len(a)
    d = [1.0] * n
    for _ in range(100):
        changed = False
        for i in range(n):
            column = 0.0
            row = 0.0
            for j in range(n):
                if j != i:
                    column += abs(a[j][i]) * d[i] / d[j]
                    row += abs(a[i][j]) * d[j] / d[i]
            if column > 0.0 and row > 0.0:
                exponent = round(0.5 * math.log2(row / column))
                if exponent != 0:
                    d[i] *= 2.0**exponent
                    changed = True
        if not changed:
            break
    return d


def propagator(a: Matrix, c: Matrix, h: float) -> tuple[Matrix, Matrix]:
    """E = exp(a h) - I and S = integral of exp(a s)' c exp(a s) ds from 0 to h, shapes as a.

    `c` is symmetric. Raises OverflowError where a h is not finite; the results may overflow.
    """
    n = len(a)
    size = range(n)
    d = balance(a)
    # the last coordinate is the constant 1: its column is the forcing and may have any size
    b = [[a[i][j] * (d[j] / d[i]) for j in size] for i in size]
    forcing = max(abs(b[i][n - 1]) for i in size)
    if forcing > 0.0:
        inner = max(max(abs(x) for x in row[: n - 1]) for row in b)
        if inner > 0.0:
            f = 2.0 ** round(math.log2(inner / forcing))
            d[n - 1] *= f
            b = [[a[i][j] * (d[j] / d[i]) for j in size] for i in size]
    norm = h * max(sum([abs(x) for x in row]) for row in b)
    if not math.isfinite(norm):
        raise OverflowError("the propagator of the linear model leaves the finite numbers")
    doublings = 0
    while norm > SMALL:
        norm *= 0.5
        doublings += 1
    s = math.ldexp(h, -doublings)
    b = [[x * s for x in row] for row in b]
    w = [[c[i][j] * (d[i] * d[j]) for j in size] for i in size]

    # Horner sums: E = b (I + b/2 (I + b/3 (...)))
    e = [[x / TERMS for x in row] for row in b]
    for k in range(TERMS - 1, 0, -1):
        e = [[x / k for x in row] for row in plus(b, product(b, e))]
    # the derivatives of exp(a s)' c exp(a s) at 0: P, a'P + P a, ...
    term = [[x * s for x in row] for row in w]
    total = term
    bt = transposed(b)
    for k in range(2, TERMS + 6):
        term = [[x / k for x in row] for row in plus(product(bt, term), product(term, b))]
        total = plus(total, term)

    for _ in range(doublings):
        half = product(total, e)
        total = plus(
            plus(total, total), plus(plus(half, transposed(half)), product(transposed(e), half))
        )
        e = plus(plus(e, e), product(e, e))
    e = [[e[i][j] * (d[i] / d[j]) for j in size] for i in size]
    total = [[total[i][j] / (d[i] * d[j]) for j in size] for i in size]
    return e, total


def plus(a: Matrix, b: Matrix) -> Matrix:
    """The sum a + b of matrices of one shape."""
    return [[a[i][j] + b[i][j] for j in range(len(a[i]))] for i in range(len(a))]


class Exact(Method):
    """One step per communication step, of any size, right to rounding; linear models only."""

    ORDER = 0
    CHOOSES_STEP = True

    def __init__(self) -> None:
        super().__init__()
        # The propagator last used and what it belongs to. It follows from them alone, so it is no
        # part of the state.
        self.h: float = 0.0
        self.a: Matrix = []
        self.c: Matrix = []
        #: to the coordinates of the propagator and back; empty where it is for the model's own
        self.ahead: Matrix = []
        self.back: Matrix = []
        self.e: Matrix = []
        self.s: Matrix = []

    def advance(
        self, model: Model, duration: float, count: int, tolerance: float, max_steps: int
    ) -> int:
        a = model.linear_system()
        c = model.power_form()
        if duration != self.h or a != self.a or c != self.c:
            self.h = 0.0
            separate, ahead, back = model.separation()
            if separate:
                e, s = propagator(separate, product(product(transposed(back), c), back), duration)
                self.ahead, self.back, self.e = ahead, back, e
                self.s = product(product(transposed(ahead), s), ahead)
            else:
                self.ahead, self.back = [], []
                self.e, self.s = propagator(a, c, duration)
            self.h, self.a, self.c = duration, a, c
        z = [model.q0, model.q1, model.v0, model.v1, 1.0]
        if model.works:
            work = 0.0
            for i in range(5):
                row = self.s[i]
                work += z[i] * (
                    row[0] * z[0] + row[1] * z[1] + row[2] * z[2] + row[3] * z[3] + row[4]
                )
            model.work += work
        if self.ahead:
            z = [moved(row, z) for row in self.ahead]
        change = [moved(row, z) for row in self.e]
        if self.ahead:
            change = [moved(row, change) for row in self.back]
        model.q0 += change[0]
        model.q1 += change[1]
        model.v0 += change[2]
        model.v1 += change[3]
        if not math.isfinite(model.q0 + model.q1 + model.v0 + model.v1):
            self.reached = duration
            return NOT_FINITE
        if model.settles:
            model.settle(duration)
        self.steps += 1
        self.evaluations += 1
        return DONE


def moved(row: list[float], z: list[float]) -> float:
    """One row of a matrix with five columns times z."""
    return row[0] * z[0] + row[1] * z[1] + row[2] * z[2] + row[3] * z[3] + row[4]

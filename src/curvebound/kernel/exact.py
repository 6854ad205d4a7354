"""Exact propagation of the linear model by its matrix exponential.

z' = A z with constant A over a communication step (time is one more coordinate where inputs are
linear in it), so z(h) = (I + E) z(0), E = exp(A h) - I. E is found by a Taylor series at a small
argument and doubling, E(2h) = 2 E(h) + E(h)^2: without the identity added in, slow modes beside
fast ones keep their digits (scaling and squaring: Higham, Functions of Matrices, 2008, sec. 10.3).
The work integral of the quadratic form C, S(h) = integral of exp(A s)' C exp(A s) over
0 <= s <= h, doubles with it (Van Loan 1978): S(2h) = S(h) + (I + E)' S(h) (I + E).
"""

from __future__ import annotations

import math
from typing import Annotated, Final

from .base import Model
from .method import DONE, NOT_FINITE, Method

__all__ = ["Exact", "propagator"]

#: coordinates, rates, the constant 1, and the time within the step, which forcing may depend on
N: Final = 6
MOVING: Final = 4
ONE: Final = 4
TIME: Final = 5
#: by rows
Matrix = Annotated[list[float], N * N]
Vector = Annotated[list[float], N]

#: largest norm of A h at which the series is summed; 20 terms then reach rounding level
SMALL: Final = 0.25
TERMS: Final = 20


def copied(rows: list[list[float]], m: Matrix) -> None:
    """Set m to a matrix given as a list of rows; those of the time may be missing."""
    size = len(rows)
    for i in range(N * N):
        m[i] = 0.0
    for i in range(size):
        row: list[float] = rows[i]
        for j in range(size):
            m[N * i + j] = row[j]


def differs(a: Matrix, b: Matrix) -> bool:
    """Whether two matrices are not the same."""
    found = False
    for i in range(N * N):
        found = found or a[i] != b[i]
    return found


def product(n: int, a: Matrix, b: Matrix, m: Matrix) -> None:
    """Set m, which is neither of the others, to a b."""
    for i in range(n):
        row = N * i
        for j in range(n):
            m[row + j] = 0.0
        for k in range(n):
            x = a[row + k]
            if x != 0.0:
                for j in range(n):
                    m[row + j] += x * b[N * k + j]


def transposed(n: int, a: Matrix, m: Matrix) -> None:
    """Set m, which is not a, to the transpose of a."""
    for i in range(n):
        for j in range(n):
            m[N * j + i] = a[N * i + j]


def add(n: int, a: Matrix, b: Matrix, m: Matrix) -> None:
    """Set m to a + b."""
    for i in range(N * n):
        m[i] = a[i] + b[i]


def divide(n: int, a: Matrix, x: float) -> None:
    """Divide a by x."""
    for i in range(N * n):
        a[i] /= x


def balance(a: Matrix, d: Vector) -> None:
    """Set d to powers of two such that diag(1/d) a diag(d) has rows and columns of like size.

    Parlett and Reinsch 1969, without permutation: removes the units from the norms. The time's are
    left as they are.
    """
    for i in range(N):
        d[i] = 1.0
    for _ in range(100):
        changed = False
        for i in range(TIME):
            column = 0.0
            row = 0.0
            for j in range(TIME):
                if j != i:
                    column += math.fabs(a[N * j + i]) * d[i] / d[j]
                    row += math.fabs(a[N * i + j]) * d[j] / d[i]
            if column > 0.0 and row > 0.0:
                factor = power_of_two(0.5 * math.log2(row / column))
                if factor != 1.0:
                    d[i] *= factor
                    changed = True
        if not changed:
            break


def power_of_two(exponent: float) -> float:
    """2 to the whole number nearest to `exponent`."""
    return math.ldexp(1.0, round(exponent))


def rescaled(a: Matrix, d: Vector, m: Matrix) -> None:
    """Set m to diag(1/d) a diag(d)."""
    for i in range(N):
        for j in range(N):
            m[N * i + j] = a[N * i + j] * (d[j] / d[i])


def propagator(n: int, a: Matrix, c: Matrix, h: float, e: Matrix, s: Matrix) -> None:
    """Set e to exp(a h) - I and s to the integral of exp(a t)' c exp(a t) over 0 <= t <= h.

    n: the coordinates that count, N or all but the time.
    `c` is symmetric; row ONE of `a` is zero, its column ONE the forcing, TIME the part of it that
    grows with time. Raises OverflowError where a h is not finite; the results may overflow.
    """
    d: Vector = [0.0] * N
    b: Matrix = [0.0] * (N * N)
    bt: Matrix = [0.0] * (N * N)
    term: Matrix = [0.0] * (N * N)
    x: Matrix = [0.0] * (N * N)
    y: Matrix = [0.0] * (N * N)
    balance(a, d)
    # the columns of time and of the constant 1 are the forcing and may have any size
    rescaled(a, d, b)
    inner = 0.0
    for i in range(MOVING):
        for j in range(MOVING):
            inner = max(inner, math.fabs(b[N * i + j]))
    for k in (TIME, ONE):
        forcing = 0.0
        for i in range(n):
            forcing = max(forcing, math.fabs(b[N * i + k]))
        if forcing > 0.0 and inner > 0.0:
            d[k] *= power_of_two(math.log2(inner / forcing))
            rescaled(a, d, b)
    norm = 0.0
    for i in range(n):
        row = 0.0
        for j in range(n):
            row += math.fabs(b[N * i + j])
        # NaN stays
        norm = row if not row <= norm else norm
    norm *= h
    if not math.isfinite(norm):
        raise OverflowError("the propagator of the linear model leaves the finite numbers")
    doublings = 0
    while norm > SMALL:
        norm *= 0.5
        doublings += 1
    step = math.ldexp(h, -doublings)
    for i in range(n):
        for j in range(n):
            b[N * i + j] *= step
            # the derivatives of exp(a t)' c exp(a t) at 0: P, a'P + P a, ...
            term[N * i + j] = c[N * i + j] * (d[i] * d[j]) * step
            e[N * i + j] = b[N * i + j]
            s[N * i + j] = term[N * i + j]
    # Horner sums: E = b (I + b/2 (I + b/3 (...)))
    divide(n, e, float(TERMS))
    for k in range(TERMS - 1, 0, -1):
        product(n, b, e, x)
        add(n, b, x, e)
        divide(n, e, float(k))
    transposed(n, b, bt)
    for k in range(2, TERMS + 6):
        product(n, bt, term, x)
        product(n, term, b, y)
        add(n, x, y, term)
        divide(n, term, float(k))
        add(n, s, term, s)

    for _ in range(doublings):
        product(n, s, e, x)
        transposed(n, x, y)
        transposed(n, e, bt)
        product(n, bt, x, term)
        add(n, x, y, x)
        add(n, x, term, x)
        add(n, s, s, s)
        add(n, s, x, s)
        product(n, e, e, x)
        add(n, e, e, e)
        add(n, e, x, e)
    for i in range(n):
        for j in range(n):
            e[N * i + j] *= d[i] / d[j]
            s[N * i + j] /= d[i] * d[j]


class Exact(Method):
    """One step per communication step, of any size, right to rounding; linear models only."""

    CHOOSES_STEP = True

    def __init__(self) -> None:
        super().__init__()
        # The propagator last used and what it belongs to. It follows from them alone, so it is no
        # part of the state.
        self.h: float = 0.0
        self.a: Matrix = [0.0] * (N * N)
        self.c: Matrix = [0.0] * (N * N)
        #: whether it is for other coordinates than the model's: to those and back
        self.separates: bool = False
        self.ahead: Matrix = [0.0] * (N * N)
        self.back: Matrix = [0.0] * (N * N)
        self.e: Matrix = [0.0] * (N * N)
        self.s: Matrix = [0.0] * (N * N)

    def advance(
        self, model: Model, duration: float, count: int, tolerance: float, max_steps: int
    ) -> int:
        z: Vector = [0.0] * N
        y: Vector = [0.0] * N
        self.prepare(model, duration)
        z[0] = model.q0
        z[1] = model.q1
        z[2] = model.v0
        z[3] = model.v1
        z[ONE] = 1.0
        if model.works:
            work = 0.0
            for i in range(TIME):
                work += z[i] * moved(self.s, i, z)
            model.work += work
        if self.separates:
            for i in range(TIME):
                y[i] = moved(self.ahead, i, z)
            for i in range(TIME):
                z[i] = moved(self.e, i, y)
            for i in range(TIME):
                y[i] = moved(self.back, i, z)
        else:
            for i in range(TIME):
                y[i] = moved(self.e, i, z)
        model.q0 += y[0]
        model.q1 += y[1]
        model.v0 += y[2]
        model.v1 += y[3]
        if not math.isfinite(model.q0 + model.q1 + model.v0 + model.v1):
            self.reached = duration
            return NOT_FINITE
        if model.settles:
            model.settle(duration)
        self.steps += 1
        self.evaluations += 1
        return DONE

    def prepare(self, model: Model, duration: float) -> None:
        """Find the propagator for the present model and duration, if they are new."""
        a: Matrix = [0.0] * (N * N)
        c: Matrix = [0.0] * (N * N)
        x: Matrix = [0.0] * (N * N)
        y: Matrix = [0.0] * (N * N)
        system = model.linear_system()
        n = len(system)
        copied(system, a)
        copied(model.power_form(), c)
        if duration == self.h and not differs(a, self.a) and not differs(c, self.c):
            return
        self.h = 0.0
        for i in range(N * N):
            self.a[i] = a[i]
            self.c[i] = c[i]
        separate, ahead, back = model.separation()
        self.separates = len(separate) > 0
        if self.separates:
            copied(separate, a)
            copied(ahead, self.ahead)
            copied(back, self.back)
            # the power form for the other coordinates, then its integral for the model's
            transposed(n, self.back, x)
            product(n, x, c, y)
            product(n, y, self.back, c)
            propagator(n, a, c, duration, self.e, y)
            transposed(n, self.ahead, c)
            product(n, c, y, x)
            product(n, x, self.ahead, self.s)
        else:
            propagator(n, a, c, duration, self.e, self.s)
        self.h = duration


def moved(m: Matrix, i: int, z: Vector) -> float:
    """Row i of a matrix times z, in which the time is zero: the start of a step."""
    row = N * i
    total = m[row] * z[0] + m[row + 1] * z[1] + m[row + 2] * z[2] + m[row + 3] * z[3]
    return total + m[row + ONE] * z[ONE]

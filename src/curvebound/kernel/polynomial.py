"""The polynomial through the accelerations at the eight Lobatto points of a step.

It guesses those of the next step. Where some of these are known, too, the polynomial through all
of them is the guess plus the nodal polynomial, which is zero at the points of the step before,
times the polynomial through what the guess has missed, divided by the nodal one (Newton's form;
Hildebrand 1974, sec. 2.5): a guess of a digit becomes one of several.
"""

from __future__ import annotations

import math
from typing import Final

from .lobatto_tables import NODES, POWERS, STAGES, Stages

__all__ = ["FARTHEST", "NEAR", "NEAREST", "extend", "extrapolated", "miss", "span", "tail"]

Seven = tuple[float, float, float, float, float, float, float]

#: longest step, in units of the last, that is extrapolated to: rounding grows as the seventh power
#: and passes for the scale of the motion, so that a wrong step is taken for a right one
FARTHEST: Final = 16.0

#: steps, in units of the last, whose guess is extended: of longer ones what it misses at one point
#: tells little of the next, shorter ones need it not (and at 1e-15 the nodal polynomial is zero)
NEAREST: Final = 0.01
NEAR: Final = 1.6

# squares of the points of a step from -1 to 1, but of its ends
SQUARE4: Final = (2.0 * NODES[4] - 1.0) ** 2
SQUARE5: Final = (2.0 * NODES[5] - 1.0) ** 2
SQUARE6: Final = (2.0 * NODES[6] - 1.0) ** 2

# coefficients of the Legendre polynomials of degree 7 (H) and 6 (F), by differences and sums of
# mirrored values
H0: Final = 0.125
H1: Final = -0.30361669811669434
H2: Final = 0.3863174574899938
H3: Final = -0.42479491835847444
F0: Final = 0.23214285714285715
F1: Final = -0.4915390359401665
F2: Final = 0.42451334656272205
F3: Final = -0.1651171677654127

#: weights of the squared Legendre coefficients of degree 7 and 6, chosen such that the estimate
#: exceeds the error of smooth motions at tolerances from 1e-4 to 1e-13
HIGHEST: Final = 1.0
NEXT: Final = 0.01


def extrapolated(k: Stages, start: float, r: float) -> Seven:
    """Values at the points 1 to 7 of the next step, r / 2 times as long, by those of this one.

    Shifted so that they continue `start`, which differs from k[7] where an input jumped.
    """
    p: Stages = [0.0] * STAGES
    x: Stages = [0.0] * STAGES
    y: Stages = [0.0] * STAGES
    find_coefficients(k, p)
    p[0] += start - k[7]
    evaluate_at(p, r, x, y)
    return y[1], y[2], y[3], y[4], y[5], y[6], y[7]


# fmt: off
def tail(
    noise: float,
    k0: float, k1: float, k2: float, k3: float, k4: float, k5: float, k6: float, k7: float,
) -> float:
    """An estimate of the error of the mean value over the step by quadrature at the points.

    The quadrature is exact to degree 13, not only to the polynomial's 7: where the coefficients
    fall off geometrically, its error relative to the spread of the values is of the order of the
    square of the polynomial's, which the highest coefficients measure. That of degree 6 stands in
    where the other passes through zero. Values that are not smooth have highest coefficients as
    large as their spread and thus an estimate as large as that. Coefficients up to `noise` are
    rounding.
    """
    high = math.fabs(H0 * (k7 - k0) + H1 * (k6 - k1) + H2 * (k5 - k2) + H3 * (k4 - k3)) - noise
    low = math.fabs(F0 * (k7 + k0) + F1 * (k6 + k1) + F2 * (k5 + k2) + F3 * (k4 + k3)) - noise
    if high < 0.0:
        high = 0.0
    if low < 0.0:
        low = 0.0
    spread = math.fabs(k7 - k0) + math.fabs(k5 - k2) + math.fabs((k7 + k0) - (k4 + k3))
    spread = max(spread, high + low)
    if spread == 0.0:
        return 0.0
    return (HIGHEST * (high * high) + NEXT * (low * low)) / spread
# fmt: on


# -- written out where they are called when compiled (runtime.WRITTEN_OUT) -------------------------
def find_coefficients(k: Stages, p: Stages) -> None:
    """Set p to the coefficients of the polynomial through k at the nodes."""
    for m in range(0, STAGES, 2):
        p[m] = (
            POWERS[4 * m] * (k[7] + k[0])
            + POWERS[4 * m + 1] * (k[6] + k[1])
            + POWERS[4 * m + 2] * (k[5] + k[2])
            + POWERS[4 * m + 3] * (k[4] + k[3])
        )
    for m in range(1, STAGES, 2):
        p[m] = (
            POWERS[4 * m] * (k[7] - k[0])
            + POWERS[4 * m + 1] * (k[6] - k[1])
            + POWERS[4 * m + 2] * (k[5] - k[2])
            + POWERS[4 * m + 3] * (k[4] - k[3])
        )


def evaluate_at(p: Stages, r: float, x: Stages, y: Stages) -> None:
    """Set y to the values of the polynomial p at the nodes of the next step; x is written over."""
    for i in range(1, STAGES):
        x[i] = 1.0 + NODES[i] * r
        y[i] = x[i] * x[i]
        # in pairs: the processor overlaps them
        y[i] = ((p[0] + p[1] * x[i]) + y[i] * (p[2] + p[3] * x[i])) + (y[i] * y[i]) * (
            (p[4] + p[5] * x[i]) + y[i] * (p[6] + p[7] * x[i])
        )


def span(r: float, nodal: Stages) -> None:
    """Set the nodal polynomial at the points of the next step, r / 2 times as long."""
    for i in range(1, STAGES):
        nodal[i] = (1.0 + NODES[i] * r) * (1.0 + NODES[i] * r)
        nodal[i] = ((nodal[i] - 1.0) * (nodal[i] - SQUARE6)) * (
            (nodal[i] - SQUARE5) * (nodal[i] - SQUARE4)
        )


def miss(guess: Stages, nodal: Stages, k: Stages, missed: Stages, start: int, stop: int) -> None:
    """Set what the guess has missed of k, divided, at the points start to stop - 1."""
    for i in range(start, stop):
        missed[i] = (k[i] - guess[i]) / nodal[i]


# fmt: off
def extend(
    guess: Stages, nodal: Stages, missed: Stages, weights: list[float], first: int, count: int,
    k: Stages, start: int, stop: int,
) -> None:
    """Set k at the points start to stop - 1 by what was missed at `count` points."""
    for i in range(start, stop):
        k[i] = weights[count * i] * missed[first]
        for j in range(1, count):
            k[i] += weights[count * i + j] * missed[first + j]
        k[i] = guess[i] + nodal[i] * k[i]
# fmt: on

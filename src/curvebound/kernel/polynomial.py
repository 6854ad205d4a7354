"""The polynomial through the accelerations at the eight Lobatto points of a step.

C1 ... C6 are the inner points (the others are 0 and 1); E and O give the even and odd coefficients
in powers of x = 2 c - 1 from sums and differences of mirrored values; H and F the coefficients of
the Legendre polynomials of degree 7 and 6.
"""

from __future__ import annotations

import math
from typing import Final

__all__ = ["C1", "C2", "C3", "C4", "C5", "C6", "extrapolated", "tail"]

Seven = tuple[float, float, float, float, float, float, float]

C1: Final = 0.06412992574519669
C2: Final = 0.20414990928342885
C3: Final = 0.3953503910487606
C4: Final = 0.6046496089512394
C5: Final = 0.7958500907165712
C6: Final = 0.9358700742548033
E00: Final = -0.0390625
E01: Final = 0.10884002339880919
E02: Final = -0.20402935346955609
E03: Final = 0.6342518300707469
O10: Final = -0.0390625
O11: Final = 0.12485374636569209
O12: Final = -0.3448188117424295
O13: Final = 3.030359293393399
E20: Final = 1.0546875
E21: Final = -2.9042970734844875
E22: Final = 5.13006254948732
E23: Final = -3.2804529760028327
O30: Final = 1.0546875
O31: Final = -3.33160871212585
O32: Final = 8.670037141212164
O33: Final = -15.673508046892612
E40: Final = -3.8671875
E41: Final = 9.892051881471833
E42: Final = -11.054944637017064
E43: Final = 5.030080255545231
O50: Final = -3.8671875
O51: Final = 11.347477684014024
O52: Final = -18.683355158420195
O53: Final = 24.032962501985807
E60: Final = 3.3515625
E61: Final = -7.096594831386154
E62: Final = 6.1289114409993
E63: Final = -2.3838791096131455
O70: Final = 3.3515625
O71: Final = -8.140722718253867
O72: Final = 10.358136828950459
O73: Final = -11.389813748486596
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


# fmt: off
def extrapolated(
    k0: float, k1: float, k2: float, k3: float, k4: float, k5: float, k6: float, k7: float,
    start: float, r: float,
) -> Seven:
    """Values at the points 1 to 7 of the next step, r / 2 times as long, by those of this one.

    Shifted so that they continue `start`, which differs from k7 where an input jumped.
    """
    e0 = k7 + k0
    o0 = k7 - k0
    e1 = k6 + k1
    o1 = k6 - k1
    e2 = k5 + k2
    o2 = k5 - k2
    e3 = k4 + k3
    o3 = k4 - k3
    p0 = E00 * e0 + E01 * e1 + E02 * e2 + E03 * e3 + (start - k7)
    p1 = O10 * o0 + O11 * o1 + O12 * o2 + O13 * o3
    p2 = E20 * e0 + E21 * e1 + E22 * e2 + E23 * e3
    p3 = O30 * o0 + O31 * o1 + O32 * o2 + O33 * o3
    p4 = E40 * e0 + E41 * e1 + E42 * e2 + E43 * e3
    p5 = O50 * o0 + O51 * o1 + O52 * o2 + O53 * o3
    p6 = E60 * e0 + E61 * e1 + E62 * e2 + E63 * e3
    p7 = O70 * o0 + O71 * o1 + O72 * o2 + O73 * o3
    x = 1.0 + C1 * r
    y1 = ((((((p7 * x + p6) * x + p5) * x + p4) * x + p3) * x + p2) * x + p1) * x + p0
    x = 1.0 + C2 * r
    y2 = ((((((p7 * x + p6) * x + p5) * x + p4) * x + p3) * x + p2) * x + p1) * x + p0
    x = 1.0 + C3 * r
    y3 = ((((((p7 * x + p6) * x + p5) * x + p4) * x + p3) * x + p2) * x + p1) * x + p0
    x = 1.0 + C4 * r
    y4 = ((((((p7 * x + p6) * x + p5) * x + p4) * x + p3) * x + p2) * x + p1) * x + p0
    x = 1.0 + C5 * r
    y5 = ((((((p7 * x + p6) * x + p5) * x + p4) * x + p3) * x + p2) * x + p1) * x + p0
    x = 1.0 + C6 * r
    y6 = ((((((p7 * x + p6) * x + p5) * x + p4) * x + p3) * x + p2) * x + p1) * x + p0
    x = 1.0 + r
    y7 = ((((((p7 * x + p6) * x + p5) * x + p4) * x + p3) * x + p2) * x + p1) * x + p0
    return y1, y2, y3, y4, y5, y6, y7


def tail(
    k0: float, k1: float, k2: float, k3: float, k4: float, k5: float, k6: float, k7: float,
    noise: float,
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

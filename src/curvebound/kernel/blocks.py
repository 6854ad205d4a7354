"""The linear system of Newton's method for two stages: 2 x 2 blocks, solved by hand."""

from __future__ import annotations

import math

from .base import Model

__all__ = ["block", "solved"]

#: a 2 x 2 matrix by rows
Block = tuple[float, float, float, float]
Pair = tuple[float, float]


def block(unit: float, of_q: float, of_v: float, model: Model) -> Block:
    """A 2 x 2 block of the Newton matrix: unit I - of_q dK/dq - of_v dK/dv, by rows.

    With the slopes that the model's jacobian() found last.
    """
    return (
        unit - of_q * model.a0_q0 - of_v * model.a0_v0,
        -of_q * model.a0_q1 - of_v * model.a0_v1,
        -of_q * model.a1_q0 - of_v * model.a1_v0,
        unit - of_q * model.a1_q1 - of_v * model.a1_v1,
    )


def solved(p: Block, q: Block, r: Block, s: Block, f: Pair, g: Pair) -> Block:
    """(x, y) with p x + q y = f and r x + s y = g, by elimination of x.

    The block of larger determinant in the first column is the pivot, whatever the units of the
    unknowns. Raises ZeroDivisionError where the matrix is singular.
    """
    det = p[0] * p[3] - p[1] * p[2]
    other = r[0] * r[3] - r[1] * r[2]
    if math.fabs(other) > math.fabs(det):
        p, q, r, s, f, g = r, s, p, q, g, f
        det = other
    inverse = 1.0 / det
    # w = r p^-1
    w0 = (r[0] * p[3] - r[1] * p[2]) * inverse
    w1 = (r[1] * p[0] - r[0] * p[1]) * inverse
    w2 = (r[2] * p[3] - r[3] * p[2]) * inverse
    w3 = (r[3] * p[0] - r[2] * p[1]) * inverse
    y0, y1 = solved_block(
        s[0] - (w0 * q[0] + w1 * q[2]),
        s[1] - (w0 * q[1] + w1 * q[3]),
        s[2] - (w2 * q[0] + w3 * q[2]),
        s[3] - (w2 * q[1] + w3 * q[3]),
        g[0] - (w0 * f[0] + w1 * f[1]),
        g[1] - (w2 * f[0] + w3 * f[1]),
    )
    x0, x1 = solved_block(
        p[0],
        p[1],
        p[2],
        p[3],
        f[0] - (q[0] * y0 + q[1] * y1),
        f[1] - (q[2] * y0 + q[3] * y1),
    )
    return x0, x1, y0, y1


def solved_block(a: float, b: float, c: float, d: float, f: float, g: float) -> Pair:
    """(x, y) with a x + b y = f and c x + d y = g."""
    inverse = 1.0 / (a * d - b * c)
    return (d * f - b * g) * inverse, (a * g - c * f) * inverse

"""Both systems as Newton wrote them, in extended precision, for any ratio of their parameters.

The equations of curvebound.study.equations solve the mass matrix, whose determinant cancels for a
light slider; here the rod's tension is eliminated instead, in which nothing cancels. With slope
q = 2 a u, rod direction d = (sin th, -cos th), e = (cos th, sin th), b the acceleration that the
slider would have at u'' = 0 (less gravity), F1 and F2 the forces on slider and bob,

    m1 (b + u'' (1, q)).(1, q) = F1.(1, q) + T d.(1, q)
    m2 (b.d + u'' d.(1, q) - r th'^2) = F2.d - T
    m2 (b.e + u'' e.(1, q) + r th'') = F2.e
"""

from __future__ import annotations

from collections.abc import Callable, Mapping

import numpy as np

from ..equations import Array

__all__ = ["Accelerations", "bead", "pendulum"]

Number = np.longdouble
#: t (n,), q (2, n), v (2, n) to q'' (2, n)
Accelerations = Callable[[Array, Array, Array], Array]
Values = Mapping[str, float | str]


def _numbers(values: Values) -> dict[str, Array]:
    return {k: Number(v) for k, v in values.items() if not isinstance(v, str)}


def bead(values: Values) -> Accelerations:
    """The bead in its angle; the second coordinate rests."""
    p = _numbers(values)
    m, r = p["bead.mass"], p["wire.radius"]
    ex = (p["gravity.x"] - p["wire.ax"] + p["bead.fx"] / m) / r
    ey = (p["gravity.y"] - p["wire.ay"] + p["bead.fy"] / m) / r
    k = p["bead.damping"] / m

    def accelerations(t: Array, q: Array, v: Array) -> Array:
        turning = ex * np.cos(q[0]) + ey * np.sin(q[0]) - k * v[0]
        return np.stack([turning, np.zeros_like(turning)])

    return accelerations


def pendulum(values: Values) -> Accelerations:
    """The pendulum on the parabola, in the fidelity that the values name."""
    p = _numbers(values)
    m1, m2, r = p["slider.mass"], p["pendulum.mass"], p["pendulum.length"]
    c1, c2 = p["slider.damping"], p["pendulum.damping"]
    sway = p["parabola.ax"] - p["gravity.x"]
    lift = p["parabola.ay"] - p["gravity.y"]
    f1x, f1y = p["slider.fx"], p["slider.fy"]
    f2x, f2y = p["pendulum.fx"], p["pendulum.fy"]
    start, rate = p["parabola.coefficient_start"], p["parabola.coefficient_rate_start"]
    dda = p["parabola.coefficient_acceleration"]

    def linear(t: Array, q: Array, v: Array) -> Array:
        slope = 2 * (start + t * (rate + t * dda / 2)) * q[0]
        couple = c2 * v[1] / r
        lean = q[1] - slope
        push = f1x + slope * f1y - c1 * v[0] + couple - f2y * lean
        ddu = (push + lift * (m2 * lean - m1 * slope)) / m1 - sway
        return np.stack([ddu, ((f2x + f2y * q[1] - couple) / m2 - lift * q[1] - sway - ddu) / r])

    def full(t: Array, q: Array, v: Array) -> Array:
        a, da = start + t * (rate + t * dda / 2), rate + t * dda
        u, th = q
        du, dth = v
        s, c = np.sin(th), np.cos(th)
        slope = 2 * a * u
        couple = c2 * dth / r
        bx, by = sway, lift + 2 * a * du * du + 4 * da * u * du + dda * u * u
        along_rod = s - slope * c
        steep = 1 + slope * slope
        # friction -c1 u' along (1, q); the couple on the rod as forces across it at its ends
        push = f1x + slope * f1y - c1 * du * steep + couple * (c + slope * s)
        tension = f2x * s - f2y * c + m2 * (r * dth * dth - (bx * s - by * c))
        ddu = (push - m1 * (bx + by * slope) + along_rod * tension) / (
            m1 * steep + m2 * along_rod * along_rod
        )
        across = (f2x * c + f2y * s - couple) / m2 - (bx * c + by * s)
        return np.stack([ddu, (across - ddu * (c + slope * s)) / r])

    return linear if values["model.fidelity"] == "linear" else full

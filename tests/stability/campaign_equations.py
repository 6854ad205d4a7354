"""The equations of motion of both plants for heyoka, written down apart from the kernel's."""

from __future__ import annotations

from typing import Any


def bead_equations(hy: Any) -> list[Any]:
    """theta'' = e.(cos, sin)/r - k theta'."""
    th, om = hy.make_vars("th", "om")
    gx, gy, r, m, d, ax, ay, fx, fy = (hy.par[i] for i in range(9))
    ex = gx - ax + fx / m
    ey = gy - ay + fy / m
    return [(th, om), (om, (ex * hy.cos(th) + ey * hy.sin(th)) / r - d / m * om)]


def pendulum_equations(hy: Any) -> list[Any]:
    """Newton's law with the rod's tension eliminated."""
    u, th, v, om = hy.make_vars("u", "th", "v", "om")
    gx, gy, a, m1, m2, r, c1, c2, ax, ay, _, f1x, f1y, f2x, f2y = (hy.par[i] for i in range(15))
    s, c = hy.sin(th), hy.cos(th)
    slope = 2.0 * a * u
    couple = c2 * om / r
    bx, by = ax - gx, ay - gy + 2.0 * a * v * v
    along = s - slope * c
    steep = 1.0 + slope * slope
    push = f1x + slope * f1y - c1 * v * steep + couple * (c + slope * s)
    tension = f2x * s - f2y * c + m2 * (r * om * om - (bx * s - by * c))
    ddu = (push - m1 * (bx + by * slope) + along * tension) / (m1 * steep + m2 * along * along)
    across = (f2x * c + f2y * s - couple) / m2 - (bx * c + by * s)
    return [(u, v), (th, om), (v, ddu), (om, (across - ddu * (c + slope * s)) / r)]

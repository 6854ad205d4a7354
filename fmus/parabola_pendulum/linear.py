"""The pendulum on the parabola, quadratic part of the Lagrangian about u = angle = 0.

With G = Y'' - gravity.y, X = X'' - gravity.x, q = 2 a(t) u, the generalised forces of the inputs
linearised too, and G2 = G - f2y/m2:

    u''    = q (f1y/m1 - G) + m2/m1 G2 (th - q) + f1x/m1 - X - c1/m1 u' + c2/(m1 r) th'
    r th'' = q (f2y/m2 - f1y/m1) - (m1+m2)/m1 G2 (th - q) + f2x/m2 - f1x/m1
             + c1/m1 u' - c2 (m1+m2)/(m1 m2 r) th'

Written in th - q, which no mass ratio makes cancel. Energy is relative to the frame: what the model
without drive conserves. Forces and positions are those of the exact geometry, moving with the
linear accelerations.
"""

from __future__ import annotations

import math
from typing import Final

from .nonlinear import ParabolaNonlinear

__all__ = ["ParabolaLinear"]

#: of the slider in the coordinate X, below which X and k are too alike
LEAST_SHARE: Final = 0.05


def doubled(m: list[list[float]]) -> list[list[float]]:
    """The matrix (2, 2) for coordinates and rates alike, and the constant 1: (5, 5)."""
    return [
        [m[0][0], m[0][1], 0.0, 0.0, 0.0],
        [m[1][0], m[1][1], 0.0, 0.0, 0.0],
        [0.0, 0.0, m[0][0], m[0][1], 0.0],
        [0.0, 0.0, m[1][0], m[1][1], 0.0],
        [0.0, 0.0, 0.0, 0.0, 1.0],
    ]


class ParabolaLinear(ParabolaNonlinear):
    """q0 = u, q1 = angle; linear with coefficients that a(t) alone can make vary."""

    def __init__(self) -> None:
        super().__init__()
        # u'' and th'' per q, per th - q, per u', per th', and constant
        self.u_q: float = 0.0
        self.u_k: float = 0.0
        self.u_p: float = 0.0
        self.u_o: float = 0.0
        self.u_1: float = 0.0
        self.th_q: float = 0.0
        self.th_k: float = 0.0
        self.th_p: float = 0.0
        self.th_o: float = 0.0
        self.th_1: float = 0.0
        self.damped: bool = False
        #: whether u and th alone count, with constant factors: u_u and th_u are those of u
        self.plain: bool = True
        self.u_u: float = 0.0
        self.th_u: float = 0.0
        self.is_linear = True

    def place(self) -> None:
        """The angle is no angle to this model: turns stay in it."""

    def refresh(self) -> None:
        self.damped = self.c1 != 0.0 or self.c2 != 0.0
        self.uses_rates = self.damped
        super().refresh()
        # a frame that moves steadily is none to this model
        self.works = self.forced or self.reshapes or self.ax != 0.0 or self.ay != 0.0

    def refresh_values(self) -> None:
        super().refresh_values()
        m1 = self.m1
        m2 = self.m2
        r = self.r
        hang = self.lift - self.f2y / m2
        self.u_q = self.f1y / m1 - self.lift
        self.u_k = m2 / m1 * hang
        self.u_p = -self.c1 / m1
        self.u_o = self.c2 / (m1 * r)
        self.u_1 = self.f1x / m1 - self.sway
        self.th_q = (self.f2y / m2 - self.f1y / m1) / r
        self.th_k = -self.mass / (m1 * r) * hang
        self.th_p = self.c1 / (m1 * r)
        self.th_o = -self.c2 / (m1 * r) * (self.mass_ratio / r)
        self.th_1 = (self.f2x / m2 - self.f1x / m1) / r
        self.u_u = 2.0 * self.a * (self.u_q - self.u_k)
        self.th_u = 2.0 * self.a * (self.th_q - self.th_k)
        self.plain = not (self.reshapes or self.damped or self.u_1 != 0.0 or self.th_1 != 0.0)

    def acceleration(self, t: float, q0: float, q1: float, v0: float, v1: float) -> None:
        if self.plain:
            a0 = self.u_u * q0 + self.u_k * q1
            a1 = self.th_u * q0 + self.th_k * q1
        else:
            a2 = 2.0 * self.a
            if self.reshapes:
                a2 += t * (2.0 * self.a_rate + t * self.a_acceleration)
            q = a2 * q0
            k = q1 - q
            a0 = self.u_q * q + self.u_k * k + self.u_1
            a1 = self.th_q * q + self.th_k * k + self.th_1
            if self.damped:
                a0 += self.u_p * v0 + self.u_o * v1
                a1 += self.th_p * v0 + self.th_o * v1
        self.a0 = a0
        self.a1 = a1

    def jacobian(self, t: float, q0: float, q1: float, v0: float, v1: float) -> None:
        a2 = 2.0 * self.a + t * (2.0 * self.a_rate + t * self.a_acceleration)
        self.acceleration(t, q0, q1, v0, v1)
        self.a0_q0 = a2 * (self.u_q - self.u_k)
        self.a0_q1 = self.u_k
        self.a1_q0 = a2 * (self.th_q - self.th_k)
        self.a1_q1 = self.th_k
        self.a0_v0 = self.u_p
        self.a0_v1 = self.u_o
        self.a1_v0 = self.th_p
        self.a1_v1 = self.th_o

    def linear_system(self) -> list[list[float]]:
        self.jacobian(0.0, 0.0, 0.0, 0.0, 0.0)
        return [
            [0.0, 0.0, 1.0, 0.0, 0.0],
            [0.0, 0.0, 0.0, 1.0, 0.0],
            [self.a0_q0, self.a0_q1, self.a0_v0, self.a0_v1, self.u_1],
            [self.a1_q0, self.a1_q1, self.a1_v0, self.a1_v1, self.th_1],
            [0.0, 0.0, 0.0, 0.0, 0.0],
        ]

    def separation(self) -> tuple[list[list[float]], list[list[float]], list[list[float]]]:
        # The centre of mass X = u + p th, p = m2 r / (m1 + m2), moves slowly, for inner forces do
        # not move it; k = th - q is what a light slider follows fast. u = (X - p k)/s.
        a2 = 2.0 * self.a
        p = self.m2 * self.r / self.mass
        s = 1.0 + a2 * p
        if math.fabs(s) < LEAST_SHARE:
            return [], [], []
        down = -p / s
        x_u = a2 * ((self.f1y + self.f2y) / self.mass - self.lift)
        x_p = -self.c1 / self.mass
        x_1 = (self.f1x + self.f2x) / self.mass - self.sway
        k_o = self.th_o - a2 * self.u_o
        k_u = a2 * (self.th_q - a2 * self.u_q)
        k_p = self.th_p - a2 * self.u_p + a2 * k_o
        k_k = self.th_k - a2 * self.u_k
        system = [
            [0.0, 0.0, 1.0, 0.0, 0.0],
            [0.0, 0.0, 0.0, 1.0, 0.0],
            [x_u / s, x_u * down, x_p / s, x_p * down, x_1],
            [k_u / s, k_k + k_u * down, k_p / s, k_o + k_p * down, self.th_1 - a2 * self.u_1],
            [0.0, 0.0, 0.0, 0.0, 0.0],
        ]
        # th = k + a2 u = (a2 X + k)/s
        ahead = [[1.0, p], [-a2, 1.0]]
        back = [[1.0 / s, down], [a2 / s, 1.0 / s]]
        return system, doubled(ahead), doubled(back)

    def power(
        self, t: float, q0: float, q1: float, v0: float, v1: float, a0: float, a1: float
    ) -> float:
        rate = self.a_rate + t * self.a_acceleration
        q = (2.0 * self.a + t * (self.a_rate + rate)) * q0
        m2 = self.m2
        return (
            v0
            * (
                (self.f1x + self.f2x - self.mass * self.ax)
                + q * (self.f1y + self.f2y - self.mass * self.ay)
                - self.c1 * v0
            )
            + v1
            * (self.r * ((self.f2x - m2 * self.ax) + q1 * (self.f2y - m2 * self.ay)) - self.c2 * v1)
            - self.mass * self.gy * rate * q0 * q0
        )

    def power_form(self) -> list[list[float]]:
        half_1u = 0.5 * (self.f1x + self.f2x - self.mass * self.ax)
        half_uu = self.a * (self.f1y + self.f2y - self.mass * self.ay)
        half_1th = 0.5 * self.r * (self.f2x - self.m2 * self.ax)
        half_thth = 0.5 * self.r * (self.f2y - self.m2 * self.ay)
        return [
            [0.0, 0.0, half_uu, 0.0, 0.0],
            [0.0, 0.0, 0.0, half_thth, 0.0],
            [half_uu, 0.0, -self.c1, 0.0, half_1u],
            [0.0, half_thth, 0.0, -self.c2, half_1th],
            [0.0, 0.0, half_1u, half_1th, 0.0],
        ]

    def balance(self, t: float) -> None:
        # linear equations have one solution, and not all of their energy is the nonlinear one's
        self.balance_energy = 0.0
        self.balance_size = 1.0

    def energies_at(self, t: float) -> None:
        a = self.a + t * (self.a_rate + 0.5 * t * self.a_acceleration)
        u = self.q0
        th = self.q1
        bob = self.v0 + self.r * self.v1
        self.kinetic = 0.5 * (self.m1 * self.v0 * self.v0 + self.m2 * bob * bob)
        hang = 0.5 * self.m2 * self.r * th * th
        rise = self.mass * a * u * u
        aside = self.gx * (self.mass * u + self.m2 * self.r * th)
        self.potential = -self.gy * (rise + hang) - aside
        self.potential_size = math.fabs(self.gy) * (math.fabs(rise) + hang) + math.fabs(aside)

    def reactions(self) -> tuple[float, float, float, float]:
        # Newton's law of both masses in exact geometry
        u = self.q0
        du = self.v0
        self.acceleration(0.0, u, self.q1, du, self.v1)
        a0 = self.a0
        a1 = self.a1
        s = math.sin(self.q1)
        c = math.cos(self.q1)
        m2 = self.m2
        q = 2.0 * self.a * u
        path = 2.0 * self.a * du * du + u * (self.a_acceleration * u + 4.0 * self.a_rate * du)
        # accelerations less gravity
        x = self.sway + a0
        y = self.lift + path + q * a0
        whirl = self.r * self.v1 * self.v1
        turn = self.r * a1
        bx = x + turn * c - whirl * s
        by = y + turn * s + whirl * c
        rx = self.m1 * x + m2 * bx - self.f1x - self.f2x
        ry = self.m1 * y + m2 * by - self.f1y - self.f2y
        normal = (ry - q * rx) / math.sqrt(1.0 + q * q)
        tension = m2 * (y * c - x * s + whirl) + (self.f2x * s - self.f2y * c)
        return normal, tension, -rx, -ry

    def compare(self) -> None:
        u, th, du, dth = self.q0, self.q1, self.v0, self.v1
        self.acceleration(0.0, u, th, du, dth)
        self.linear0 = self.a0
        self.linear1 = self.r * self.a1
        super().acceleration(0.0, u, th, du, dth)
        self.full0 = self.a0
        self.full1 = self.r * self.a1

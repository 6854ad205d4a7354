"""The bead in its minimal coordinate: p = r (sin, -cos), angle'' = e.(cos, sin)/r - k angle'."""

from __future__ import annotations

import math

from curvebound.kernel.angles import TURN, unwind

from .base import BeadBase

__all__ = ["BeadAngle"]


class BeadAngle(BeadBase):
    """q0 = angle from the downward vertical, whole turns counted apart."""

    def __init__(self) -> None:
        super().__init__()
        #: e / r, 1/s2
        self.ux: float = 0.0
        self.uy: float = 0.0

    def place(
        self, angle: float, rate: float, parameters: dict[str, float], choices: dict[str, int]
    ) -> None:
        self.q0 = angle
        self.v0 = rate
        self.q1 = self.v1 = 0.0
        # Settling each internal step is needed only by a bead that turns over and over: one that
        # has the energy for it from the start, or has done so before.
        height = self.r * (self.gx * math.sin(angle) - self.gy * math.cos(angle))
        most = self.r * math.sqrt(self.gx * self.gx + self.gy * self.gy)
        speed = self.r * rate
        self.settles = self.turns != 0.0 or 0.5 * speed * speed >= 0.999 * most + height

    def refresh(self) -> None:
        super().refresh()
        self.uses_rates = self.k != 0.0
        self.refresh_values()

    def refresh_values(self) -> None:
        self.ux = self.ex / self.r
        self.uy = self.ey / self.r

    def acceleration(self, t: float, q0: float, q1: float, v0: float, v1: float) -> None:
        a0 = self.uy * math.sin(q0)
        ux = self.ux
        if ux != 0.0:
            # + 0.0: of the same number C compilers make sine and cosine at once, needed or not
            a0 += ux * math.cos(q0 + 0.0)
        k = self.k
        if k != 0.0:
            a0 -= k * v0
        self.a0 = a0

    def power(
        self, t: float, q0: float, q1: float, v0: float, v1: float, a0: float, a1: float
    ) -> float:
        s = math.sin(q0)
        c = math.cos(q0)
        r = self.r
        along = r * a0
        inward = r * v0 * v0
        return self.work_rate(
            t, r * v0 * c, r * v0 * s, along * c - inward * s, along * s + inward * c
        )

    def jacobian(self, t: float, q0: float, q1: float, v0: float, v1: float) -> None:
        s = math.sin(q0)
        c = math.cos(q0)
        k = self.k
        self.a0 = self.uy * s + self.ux * c - k * v0
        self.a0_q0 = self.uy * c - self.ux * s
        self.a0_v0 = -k

    def settle(self, h: float) -> None:
        """Keep the angle within a turn."""
        if math.fabs(self.q0) > TURN:
            self.q0 = self.take_turns(self.q0)

    def advance_frame(self, duration: float) -> None:
        if math.fabs(self.q0) > TURN:
            self.q0 = self.take_turns(self.q0)
            self.settles = True
        if self.moving:
            self.move_frame(duration)
            self.refresh()

    def set_state(self, state: list[float]) -> None:
        super().set_state(state)
        self.refresh()

    def relative(self) -> tuple[float, float, float, float]:
        s = math.sin(self.q0)
        c = math.cos(self.q0)
        r = self.r
        speed = r * self.v0
        return r * s, -r * c, speed * c, speed * s

    def multiplier(self) -> float:
        normal = self.ex * math.sin(self.q0) - self.ey * math.cos(self.q0)
        return -self.m * (normal / self.r + self.v0 * self.v0)

    def rotation(self) -> tuple[float, float, float]:
        return unwind(self.q0, self.turns), self.v0, 0.0

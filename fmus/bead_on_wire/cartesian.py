"""The bead in Cartesian coordinates, held on the wire by a Lagrange multiplier.

With the names of bead_base, p'' = e - k v + (lambda/m) p and the constraint C = (p.p - r^2)/2 = 0.
Requiring C'' = -damping C' - stiffness C (Baumgarte 1972; both are zero without that
stabilisation) gives the multiplier

    lambda/m = -(p.(e - k v) + v.v + damping p.v + stiffness C) / (p.p)
"""

from __future__ import annotations

import math
from typing import Final

from curvebound.kernel.angles import TURN, nearest_whole, unwind

from .base import BeadBase

__all__ = ["BeadCartesian"]

NONE: Final = 1
BAUMGARTE: Final = 2
PROJECTION: Final = 3
#: item of solver.method
ADAPTIVE: Final = 4


class BeadCartesian(BeadBase):
    """q = position, v = velocity from the centre; the wire is held by a multiplier."""

    def __init__(self) -> None:
        super().__init__()
        self.projects: bool = False
        #: whether it keeps the moment of momentum p x v, not the speed
        self.keeps_moment: bool = False
        self.stiffness: float = 0.0
        self.feedback: float = 0.0
        #: factors of p.v and of p.p - r^2 in the multiplier, and whether both are zero
        self.along: float = 0.0
        self.off: float = 0.0
        self.plain: bool = True
        #: r^2
        self.rr: float = 1.0
        # position and p x v after the last internal step, and bounds, for counting turns
        self.last_x: float = 0.0
        self.last_y: float = 0.0
        self.last_spin: float = 0.0
        self.swing: float = 0.0
        self.reach: float = 0.0

    def place(
        self, angle: float, rate: float, parameters: dict[str, float], choices: dict[str, int]
    ) -> None:
        stabilization = choices["constraint.stabilization"]
        if stabilization not in (NONE, BAUMGARTE, PROJECTION):
            raise ValueError(
                f"constraint.stabilization is {stabilization}: choose 1 (none), 2 (baumgarte) "
                "or 3 (projection)"
            )
        self.projects = stabilization == PROJECTION
        # the multiplier's force has no moment: that of a step of high order is ten times closer than
        # its radius, whose error, systematic, would add up in the rate
        self.keeps_moment = choices.get("solver.method", 0) == ADAPTIVE
        self.along = -self.k
        self.off = 0.0
        if stabilization == BAUMGARTE:
            self.along += parameters["constraint.damping"]
            self.off = 0.5 * parameters["constraint.stiffness"]
        self.plain = self.k == 0.0 and self.along == 0.0 and self.off == 0.0
        r = self.r
        self.rr = r * r
        self.reach = 9.0 * self.rr * self.rr
        self.q0_scale = self.q1_scale = r
        sine = math.sin(angle)
        cosine = math.cos(angle)
        self.q0 = r * sine
        self.q1 = -r * cosine
        self.v0 = r * rate * cosine
        self.v1 = r * rate * sine
        # atan2 may round to the other side of the upward ray than the reduced angle
        self.turns += nearest_whole((angle - math.atan2(self.q0, -self.q1)) / TURN)
        self.settles = True

    def refresh(self) -> None:
        super().refresh()
        self.last_x = self.q0
        self.last_y = self.q1
        self.last_spin = self.q0 * self.v1 - self.q1 * self.v0
        self.refresh_values()

    def refresh_values(self) -> None:
        # In the constant field e the square of the rate grows by no more than this / r^4
        self.swing = 4.0 * math.sqrt(self.ex * self.ex + self.ey * self.ey) * self.r * self.rr

    def acceleration(self, t: float, q0: float, q1: float, v0: float, v1: float) -> None:
        ex = self.ex
        ey = self.ey
        pp = q0 * q0 + q1 * q1
        # the reciprocal does not wait for the velocity, which a Runge-Kutta stage knows last
        inverse = 1.0 / pp
        push = (q0 * ex + q1 * ey) + (v0 * v0 + v1 * v1)
        if not self.plain:
            push += self.along * (q0 * v0 + q1 * v1) + self.off * (pp - self.rr)
            ex -= self.k * v0
            ey -= self.k * v1
        factor = push * inverse
        self.a0 = ex - factor * q0
        self.a1 = ey - factor * q1

    def power(
        self, t: float, q0: float, q1: float, v0: float, v1: float, a0: float, a1: float
    ) -> float:
        if self.projects:
            # what the projection takes back of the motion has done no work
            normal = (q0 * v0 + q1 * v1) / (q0 * q0 + q1 * q1)
            v0 -= normal * q0
            v1 -= normal * q1
        return self.work_rate(t, v0, v1, a0, a1)

    def jacobian(self, t: float, q0: float, q1: float, v0: float, v1: float) -> None:
        ex = self.ex
        ey = self.ey
        along = self.along
        off = self.off
        pp = q0 * q0 + q1 * q1
        push = q0 * ex + q1 * ey + v0 * v0 + v1 * v1
        push += along * (q0 * v0 + q1 * v1) + off * (pp - self.rr)
        factor = -push / pp
        twice = 2.0 * (factor + off)
        # gradient of the factor
        fq0 = -(ex + along * v0 + twice * q0) / pp
        fq1 = -(ey + along * v1 + twice * q1) / pp
        fv0 = -(2.0 * v0 + along * q0) / pp
        fv1 = -(2.0 * v1 + along * q1) / pp
        k = self.k
        self.a0 = ex - k * v0 + factor * q0
        self.a1 = ey - k * v1 + factor * q1
        self.a0_q0 = factor + q0 * fq0
        self.a0_q1 = q0 * fq1
        self.a1_q0 = q1 * fq0
        self.a1_q1 = factor + q1 * fq1
        self.a0_v0 = q0 * fv0 - k
        self.a0_v1 = q0 * fv1
        self.a1_v0 = q1 * fv0
        self.a1_v1 = q1 * fv1 - k

    def settle(self, h: float) -> None:
        """Project onto the wire, if chosen, and count turns through the upward ray."""
        x = self.q0
        y = self.q1
        vx = self.v0
        vy = self.v1
        if self.projects:
            # both divisions at once: the velocity does not wait for the root
            pp = x * x + y * y
            normal = (x * vx + y * vy) / pp
            scale = self.r / math.sqrt(pp)
            vx -= normal * x
            vy -= normal * y
            if self.keeps_moment:
                vx /= scale
                vy /= scale
            x *= scale
            y *= scale
            self.q0 = x
            self.q1 = y
            self.v0 = vx
            self.v1 = vy
        spin = x * vy - y * vx
        old_x = self.last_x
        old_y = self.last_y
        old_spin = self.last_spin
        if h * h * (spin * spin + old_spin * old_spin + self.swing) < self.reach:
            # less than half a turn: the chord crosses the upward ray if the arc does
            if x < 0.0:
                if old_x >= 0.0 and old_y * x < y * old_x:
                    self.turns += 1.0
            elif old_x < 0.0 and old_y * x > y * old_x:
                self.turns -= 1.0
        else:
            self.count_turns(h, x, y, spin)
        self.last_x = x
        self.last_y = y
        self.last_spin = spin

    def count_turns(self, h: float, x: float, y: float, spin: float) -> None:
        """Count the turns of a large step: those nearest to the mean of its two rates."""
        old_x = self.last_x
        old_y = self.last_y
        rates = self.last_spin / (old_x * old_x + old_y * old_y) + spin / (x * x + y * y)
        old_angle = math.atan2(old_x + 0.0, -old_y)
        angle = math.atan2(x + 0.0, -y)
        self.turns += nearest_whole((old_angle + 0.5 * h * rates - angle) / TURN)

    def advance_frame(self, duration: float) -> None:
        if self.moving:
            self.move_frame(duration)
            self.refresh()

    def set_state(self, state: list[float]) -> None:
        super().set_state(state)
        self.refresh()

    def relative(self) -> tuple[float, float, float, float]:
        return self.q0, self.q1, self.v0, self.v1

    def multiplier(self) -> float:
        x = self.q0
        y = self.q1
        vx = self.v0
        vy = self.v1
        pp = x * x + y * y
        push = x * self.ex + y * self.ey + vx * vx + vy * vy
        push += self.along * (x * vx + y * vy) + self.off * (pp - self.rr)
        return -self.m * push / pp

    def rotation(self) -> tuple[float, float, float]:
        x = self.q0
        y = self.q1
        pp = x * x + y * y
        # x + 0.0 has no negative zero: the upward ray itself belongs to the angle +pi
        angle = unwind(math.atan2(x + 0.0, -y), self.turns)
        # |p| - r without the cancellation
        drift = (pp - self.rr) / (math.sqrt(pp) + self.r)
        return angle, (x * self.v1 - y * self.v0) / pp, drift

"""A bead on a circular wire whose centre is moved, in a vertical plane, with viscous damping.

With p the position from the centre, e = gravity + f/m - (acceleration of the centre) and k = d/m,

    p'' = e - k v + (lambda/m) p,    C = (p.p - r^2)/2 = 0

`BeadCartesian` integrates p and v; requiring C'' = -damping C' - stiffness C (Baumgarte 1972; both
zero without that stabilisation) gives the multiplier

    lambda/m = -(p.(e - k v) + v.v + damping p.v + stiffness C) / (p.p)

`BeadAngle` integrates the angle: p = r (sin, -cos), angle'' = e.(cos, sin)/r - k angle'.
"""

from __future__ import annotations

import math
from typing import ClassVar, Final

from .angles import TURN, unwind
from .base import Jacobian
from .frame import FramedModel

__all__ = ["BeadAngle", "BeadCartesian", "BeadOnWire", "bead_on_wire"]

LAGRANGE_MULTIPLIER: Final = 1
ANGLE: Final = 2

NONE: Final = 1
BAUMGARTE: Final = 2
PROJECTION: Final = 3

_OUTPUTS: Final[dict[str, int]] = {
    "bead.x": 0,
    "bead.y": 0,
    "bead.vx": 0,
    "bead.vy": 0,
    "bead.angle": 0,
    "bead.angular_velocity": 0,
    "wire.x": 0,
    "wire.y": 0,
    "wire.vx": 0,
    "wire.vy": 0,
    "constraint.drift": 0,
    "energy.kinetic": 1,
    "energy.potential": 1,
    "energy.total": 1,
    "energy.residual": 1,
    "wire.fx": 2,
    "wire.fy": 2,
    "constraint.multiplier": 2,
    "constraint.force": 2,
}


class BeadOnWire(FramedModel):
    """What both formulations share: parameters, inputs, work, outputs."""

    PARAMETERS: ClassVar[tuple[str, ...]] = (
        "gravity.x",
        "gravity.y",
        "wire.radius",
        "bead.mass",
        "bead.damping",
        "bead.angle_start",
        "bead.angular_velocity_start",
        "constraint.stiffness",
        "constraint.damping",
    )
    CHOICES: ClassVar[tuple[str, ...]] = ("model.formulation", "constraint.stabilization")
    INPUTS: ClassVar[tuple[str, ...]] = ("wire.ax", "wire.ay", "bead.fx", "bead.fy")
    OUTPUTS: ClassVar[dict[str, int]] = _OUTPUTS
    FEEDTHROUGH: ClassVar[tuple[int, ...]] = (2,)

    def __init__(self) -> None:
        super().__init__()
        self.m: float = 1.0
        self.r: float = 1.0
        self.d: float = 0.0
        #: k = d/m, 1/s
        self.k: float = 0.0
        self.fx: float = 0.0
        self.fy: float = 0.0
        #: e, what acts on the free bead in the wire's frame, drag excepted, m/s2
        self.ex: float = 0.0
        self.ey: float = 0.0

    def start(self, parameters: dict[str, float], choices: dict[str, int]) -> None:
        self.rest_frame(parameters)
        self.m = parameters["bead.mass"]
        self.r = parameters["wire.radius"]
        self.d = parameters["bead.damping"]
        self.k = self.d / self.m
        self.fx = self.fy = 0.0
        self.ex = self.gx
        self.ey = self.gy
        angle = self.set_angle(parameters["bead.angle_start"])
        self.place(angle, parameters["bead.angular_velocity_start"], parameters, choices)
        self.note_initial_energy()
        self.refresh()

    def place(
        self, angle: float, rate: float, parameters: dict[str, float], choices: dict[str, int]
    ) -> None:
        """Set the state to an angle within a turn (rad) and its rate (rad/s)."""
        raise NotImplementedError

    def set_inputs(self, values: list[float], first: int) -> None:
        self.ax = values[first]
        self.ay = values[first + 1]
        self.fx = values[first + 2]
        self.fy = values[first + 3]
        self.ex = self.gx + self.fx / self.m - self.ax
        self.ey = self.gy + self.fy / self.m - self.ay
        self.refresh()

    def refresh(self) -> None:
        self.moving = self.ax != 0.0 or self.ay != 0.0 or self.vx != 0.0 or self.vy != 0.0
        self.works = self.moving or self.d != 0.0 or self.fx != 0.0 or self.fy != 0.0

    def work_rate(self, t: float, vx: float, vy: float, ax: float, ay: float) -> float:
        """Power (W) on the bead with velocity and acceleration relative to the centre."""
        drift = self.d * (vx * vx + vy * vy)
        if not self.moving:
            return self.fx * vx + self.fy * vy - drift
        # the wire's force on the bead is m (a - e), and works along the motion of the centre
        wx = self.vx + t * self.ax
        wy = self.vy + t * self.ay
        return (
            self.fx * (vx + wx)
            + self.fy * (vy + wy)
            + self.m * ((ax - self.ex) * wx + (ay - self.ey) * wy)
            - drift
        )

    def relative(self) -> tuple[float, float, float, float]:
        """Position (m) and velocity (m/s) relative to the centre."""
        raise NotImplementedError

    def multiplier(self) -> float:
        """lambda (N/m) of the present state and inputs."""
        raise NotImplementedError

    def rotation(self) -> tuple[float, float, float]:
        """Continuous angle (rad), angular velocity (rad/s), drift |p| - r (m)."""
        raise NotImplementedError

    def energies(self) -> tuple[float, float]:
        px, py, vx, vy = self.relative()
        vx += self.vx
        vy += self.vy
        kinetic = 0.5 * self.m * (vx * vx + vy * vy)
        return kinetic, -self.m * (self.gx * (px + self.x) + self.gy * (py + self.y))

    def observe(self, group: int, values: list[float], first: int) -> None:
        if group == 0:
            px, py, vx, vy = self.relative()
            values[first] = self.x + px
            values[first + 1] = self.y + py
            values[first + 2] = self.vx + vx
            values[first + 3] = self.vy + vy
            values[first + 4], values[first + 5], values[first + 10] = self.rotation()
            values[first + 6] = self.x
            values[first + 7] = self.y
            values[first + 8] = self.vx
            values[first + 9] = self.vy
        elif group == 1:
            self.write_energies(values, first + 11)
        else:
            px, py, vx, vy = self.relative()
            factor = self.multiplier()
            values[first + 15] = self.d * vx - factor * px
            values[first + 16] = self.d * vy - factor * py
            values[first + 17] = factor
            values[first + 18] = factor * self.r


class BeadCartesian(BeadOnWire):
    """q = position, v = velocity from the centre; the wire is held by a multiplier."""

    def __init__(self) -> None:
        super().__init__()
        self.projects: bool = False
        self.stiffness: float = 0.0
        self.feedback: float = 0.0
        #: factors of p.v and of p.p - r^2 in the multiplier, and whether both are zero
        self.along: float = 0.0
        self.off: float = 0.0
        self.plain: bool = True
        #: r^2 and its reciprocal
        self.rr: float = 1.0
        self.per_rr: float = 1.0
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
        self.along = -self.k
        self.off = 0.0
        if stabilization == BAUMGARTE:
            self.along += parameters["constraint.damping"]
            self.off = 0.5 * parameters["constraint.stiffness"]
        self.plain = self.k == 0.0 and self.along == 0.0 and self.off == 0.0
        r = self.r
        self.rr = r * r
        self.per_rr = 1.0 / self.rr
        self.reach = 9.0 * self.rr * self.rr
        self.q0_scale = self.q1_scale = r
        sine = math.sin(angle)
        cosine = math.cos(angle)
        self.q0 = r * sine
        self.q1 = -r * cosine
        self.v0 = r * rate * cosine
        self.v1 = r * rate * sine
        # atan2 may round to the other side of the upward ray than the reduced angle
        self.turns += float(math.floor((angle - math.atan2(self.q0, -self.q1)) / TURN + 0.5))
        self.settles = True

    def refresh(self) -> None:
        super().refresh()
        self.last_x = self.q0
        self.last_y = self.q1
        self.last_spin = self.q0 * self.v1 - self.q1 * self.v0
        # In the constant field e the square of the rate grows by no more than this / r^4
        self.swing = 4.0 * math.sqrt(self.ex * self.ex + self.ey * self.ey) * self.r * self.rr

    def acceleration(
        self, t: float, q0: float, q1: float, v0: float, v1: float
    ) -> tuple[float, float]:
        ex = self.ex
        ey = self.ey
        pp = q0 * q0 + q1 * q1
        push = q0 * ex + q1 * ey + v0 * v0 + v1 * v1
        if self.plain:
            factor = -push / pp
            return ex + factor * q0, ey + factor * q1
        push += self.along * (q0 * v0 + q1 * v1) + self.off * (pp - self.rr)
        factor = -push / pp
        k = self.k
        return ex - k * v0 + factor * q0, ey - k * v1 + factor * q1

    def power(
        self, t: float, q0: float, q1: float, v0: float, v1: float, a0: float, a1: float
    ) -> float:
        return self.work_rate(t, v0, v1, a0, a1)

    def jacobian(self, t: float, q0: float, q1: float, v0: float, v1: float) -> Jacobian:
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
        return (
            factor + q0 * fq0,
            q0 * fq1,
            q1 * fq0,
            factor + q1 * fq1,
            q0 * fv0 - k,
            q0 * fv1,
            q1 * fv0,
            q1 * fv1 - k,
        )

    def settle(self, h: float) -> None:
        """Project onto the wire, if chosen, and count turns through the upward ray."""
        x = self.q0
        y = self.q1
        vx = self.v0
        vy = self.v1
        if self.projects:
            scale = self.r / math.sqrt(x * x + y * y)
            x *= scale
            y *= scale
            normal = (x * vx + y * vy) * self.per_rr
            vx -= normal * x
            vy -= normal * y
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
        """Turns of a large step: those nearest to the corrected trapezoidal rule for the rate."""
        old_x = self.last_x
        old_y = self.last_y
        old_pp = old_x * old_x + old_y * old_y
        pp = x * x + y * y
        old_rate = self.last_spin / old_pp
        rate = spin / pp
        old_change = (self.ey * old_x - self.ex * old_y) / old_pp - self.k * old_rate
        change = (self.ey * x - self.ex * y) / pp - self.k * rate
        advance = h * (0.5 * (old_rate + rate) + h * (old_change - change) / 12.0)
        old_angle = math.atan2(old_x + 0.0, -old_y)
        angle = math.atan2(x + 0.0, -y)
        self.turns += float(math.floor((old_angle + advance - angle) / TURN + 0.5))

    def advance_frame(self, duration: float) -> None:
        if self.moving:
            super().advance_frame(duration)
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


class BeadAngle(BeadOnWire):
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
        self.ux = self.ex / self.r
        self.uy = self.ey / self.r

    def acceleration(
        self, t: float, q0: float, q1: float, v0: float, v1: float
    ) -> tuple[float, float]:
        a0 = self.uy * math.sin(q0)
        ux = self.ux
        if ux != 0.0:
            a0 += ux * math.cos(q0)
        k = self.k
        if k != 0.0:
            a0 -= k * v0
        return a0, 0.0

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

    def jacobian(self, t: float, q0: float, q1: float, v0: float, v1: float) -> Jacobian:
        slope = self.uy * math.cos(q0) - self.ux * math.sin(q0)
        return slope, 0.0, 0.0, 0.0, -self.k, 0.0, 0.0, 0.0

    def settle(self, h: float) -> None:
        """Keep the angle within a turn."""
        if math.fabs(self.q0) > TURN:
            self.q0 = self.take_turns(self.q0)

    def advance_frame(self, duration: float) -> None:
        if math.fabs(self.q0) > TURN:
            self.q0 = self.take_turns(self.q0)
            self.settles = True
        if self.moving:
            super().advance_frame(duration)
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


def bead_on_wire(choices: dict[str, int]) -> BeadOnWire:
    """The bead in the formulation that model.formulation names; raises ValueError for no such."""
    formulation = choices["model.formulation"]
    if formulation == LAGRANGE_MULTIPLIER:
        return BeadCartesian()
    if formulation == ANGLE:
        return BeadAngle()
    raise ValueError(
        f"model.formulation is {formulation}: choose 1 (lagrange_multiplier) or 2 (angle)"
    )

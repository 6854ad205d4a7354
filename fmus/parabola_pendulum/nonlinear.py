"""The pendulum on the parabola with nothing dropped.

The equations of motion M (u'', th'') = b are solved by hand: with the symbols of parabola_base and
F = f1x + q f1y - c1 u' (1 + q^2), e = f2x sin th - f2y cos th, f = f2x cos th + f2y sin th,
tau = c2 th'/r, D = m1 (1 + q^2) + m2 k^2, all terms in which the determinant of M would cancel for
m1 << m2 combine, by 1 + q^2 = w^2 + k^2 and (1, q).f2 = w f + k e, to

    D u''    = k (m2 (G cos th - X sin th + r th'^2) + e) - m1 (X + q G) + F + w tau
    r D th'' = -k ((m1+m2)(G - q X) + w (m2 r th'^2 + e)) - w F - (m1+m2)/m2 (1 + q^2) tau + D f/m2

and so do tension and normal force, from Newton's law of the bob along the rod and of the slider
across the parabola:

    D tension = (1 + q^2) m1 (m2 r th'^2 + e) + m2 (m1 w (G - q X) - k (F + w tau))
    normal sqrt(1 + q^2) = m1 (G - q X) - f1y + q f1x + w tension - k tau
"""

from __future__ import annotations

import math
from typing import Final

from curvebound.kernel.angles import TURN

from .base import ParabolaBase

__all__ = ["ParabolaNonlinear"]

#: of the pull that brings a slider back, relative: it leaves for slopes of a thousand without
LEAST_PULL: Final = 1e-6


class ParabolaNonlinear(ParabolaBase):
    """q0 = u, q1 = angle, whole turns counted apart."""

    def place(self) -> None:
        self.q1 = self.set_angle(self.q1)
        # Settling each internal step is needed only by a pendulum that turns over and over: one
        # that starts with the speed for it, or has done so before.
        gravity = math.sqrt(self.gx * self.gx + self.gy * self.gy)
        self.settles = self.turns != 0.0 or self.v1 * self.v1 * self.r > 4.0 * gravity
        self.first_magnification = self.magnifies()

    def refresh(self) -> None:
        super().refresh()
        self.refresh_values()

    def refresh_values(self) -> None:
        self.magnification = self.first_magnification
        if self.reshapes and not self.is_linear:
            # how steep it becomes is not known yet
            self.magnification = max(self.first_magnification, 30.0 * self.magnifies())

    def magnifies(self) -> float:
        # By how much an error made now can count later. A light slider is thrown when the rod
        # passes across the parabola, one that comes from high up when it passes the vertex: an
        # error of the time at which that happens counts then. The height is that to which its
        # present speed carries it, too.
        slope = 2.0 * math.fabs(self.a * self.q0)
        speed = math.fabs(self.v0) * math.sqrt(1.0 + slope * slope)
        pull = math.fabs(self.lift) + math.fabs(self.sway)
        rise = 2.0 * math.fabs(self.a) * speed * speed
        slope += math.sqrt(rise / max(pull, rise * LEAST_PULL)) if rise > 0.0 else 0.0
        return max(1.0, self.m2 / self.m1) * max(1.0, slope)

    def acceleration(self, t: float, q0: float, q1: float, v0: float, v1: float) -> None:
        # first: what is known before has to be kept over the calls
        s = math.sin(q1)
        c = math.cos(q1)
        a2 = 2.0 * self.a
        g = self.lift
        if self.reshapes:
            acceleration = self.a_acceleration
            rate = self.a_rate + t * acceleration
            a2 += t * (self.a_rate + rate)
            g += q0 * (acceleration * q0 + 4.0 * rate * v0)
        m1 = self.m1
        m2 = self.m2
        q = a2 * q0
        g += a2 * v0 * v0
        w = c + q * s
        k = s - q * c
        lean = 1.0 + q * q
        whirl = m2 * self.r * v1 * v1
        inverse = 1.0 / (m1 * lean + m2 * k * k)
        x = self.sway
        if not self.forced:
            if x == 0.0:
                self.a0 = (k * (m2 * g * c + whirl) - m1 * q * g) * inverse
                self.a1 = -k * (self.mass * g + w * whirl) * inverse * self.per_r
                return
            self.a0 = (k * (m2 * (g * c - x * s) + whirl) - m1 * (x + q * g)) * inverse
            self.a1 = -k * (self.mass * (g - q * x) + w * whirl) * inverse * self.per_r
            return
        whirl += self.f2x * s - self.f2y * c
        push = self.f1x + q * self.f1y - self.c1 * v0 * lean
        twist = self.c2 * v1 * self.per_r
        pull = k * (m2 * (g * c - x * s) + whirl) - m1 * (x + q * g)
        turn = k * (self.mass * (g - q * x) + w * whirl)
        turn += w * push
        turn += self.mass_ratio * lean * twist
        self.a0 = (pull + push + w * twist) * inverse
        self.a1 = ((self.f2x * c + self.f2y * s) / m2 - turn * inverse) * self.per_r

    def push_and_pull(
        self, t: float, q0: float, q1: float, v0: float, v1: float
    ) -> tuple[float, float, float]:
        """Force of the parabola on the slider (x, y) and tension of the rod, all N."""
        acceleration = self.a_acceleration
        rate = self.a_rate + t * acceleration
        a2 = 2.0 * self.a + t * (self.a_rate + rate)
        s = math.sin(q1)
        c = math.cos(q1)
        m1 = self.m1
        m2 = self.m2
        x = self.sway
        g = self.lift + a2 * v0 * v0 + q0 * (acceleration * q0 + 4.0 * rate * v0)
        q = a2 * q0
        w = c + q * s
        k = s - q * c
        lean = 1.0 + q * q
        d = m1 * lean + m2 * k * k
        whirl = m2 * self.r * v1 * v1
        press = m1 * (g - q * x)
        if not self.forced:
            tension = (m1 * lean * whirl + m2 * w * press) / d
            up = (press + w * tension) / lean
            return -q * up, up, tension
        whirl += self.f2x * s - self.f2y * c
        drag = self.c1 * v0
        push = self.f1x + q * self.f1y - drag * lean
        twist = self.c2 * v1 * self.per_r
        tension = (m1 * lean * whirl + m2 * (w * press - k * (push + w * twist))) / d
        up = (press - self.f1y + q * self.f1x + w * tension - k * twist) / lean
        return -q * up - drag, up - q * drag, tension

    def power(
        self, t: float, q0: float, q1: float, v0: float, v1: float, a0: float, a1: float
    ) -> float:
        # the parabola's force works along its own motion, the others along those of the masses
        rate = self.a_rate + t * self.a_acceleration
        wx = self.vx + t * self.ax
        wy = self.vy + t * self.ay + rate * q0 * q0
        power = 0.0
        if self.moving or self.reshapes:
            rx, ry, _ = self.push_and_pull(t, q0, q1, v0, v1)
            power = rx * wx + ry * wy
        if self.forced:
            q = (2.0 * self.a + t * (self.a_rate + rate)) * q0
            vx = wx + v0
            vy = wy + q * v0
            power += self.f1x * vx + self.f1y * vy - self.c1 * v0 * v0 * (1.0 + q * q)
            power -= self.c2 * v1 * v1
            if self.f2x != 0.0 or self.f2y != 0.0:
                speed = self.r * v1
                power += self.f2x * (vx + speed * math.cos(q1))
                power += self.f2y * (vy + speed * math.sin(q1))
        return power

    def jacobian(self, t: float, q0: float, q1: float, v0: float, v1: float) -> None:
        # Names as in acceleration(); x_u is the derivative of x with respect to u, _o to th'.
        acceleration = self.a_acceleration
        rate = self.a_rate + t * acceleration
        a2 = 2.0 * self.a + t * (self.a_rate + rate)
        s = math.sin(q1)
        c = math.cos(q1)
        m1 = self.m1
        m2 = self.m2
        mass = self.mass
        r = self.r
        x = self.sway
        g = self.lift + a2 * v0 * v0 + q0 * (acceleration * q0 + 4.0 * rate * v0)
        g_u = 2.0 * acceleration * q0 + 4.0 * rate * v0
        g_p = 2.0 * a2 * v0 + 4.0 * rate * q0
        q = a2 * q0
        w = c + q * s
        w_u = a2 * s
        k = s - q * c
        k_u = -a2 * c
        lean = 1.0 + q * q
        lean_u = 2.0 * q * a2
        d = m1 * lean + m2 * k * k
        d_u = m1 * lean_u + 2.0 * m2 * k * k_u
        d_th = 2.0 * m2 * k * w
        along = self.f2x * c + self.f2y * s
        out = self.f2x * s - self.f2y * c
        whirl = m2 * r * v1 * v1 + out
        whirl_o = 2.0 * m2 * r * v1
        pull = m2 * (g * c - x * s) + whirl
        pull_th = along - m2 * (g * s + x * c)
        push = self.f1x + q * self.f1y - self.c1 * v0 * lean
        push_u = a2 * self.f1y - self.c1 * v0 * lean_u
        push_p = -self.c1 * lean
        twist_o = self.c2 * self.per_r
        twist = twist_o * v1
        drop = mass * (g - q * x) + w * whirl
        drop_u = mass * (g_u - a2 * x) + w_u * whirl
        drop_th = w * along - k * whirl
        ratio = self.mass_ratio

        a0 = (k * pull - m1 * (x + q * g) + push + w * twist) / d
        n_u = (
            k_u * pull
            + k * m2 * c * g_u
            - m1 * (a2 * g + q * g_u)
            + push_u
            + w_u * twist
            - a0 * d_u
        )
        n_th = w * pull + k * pull_th - k * twist - a0 * d_th
        n_p = (k * m2 * c - m1 * q) * g_p + push_p
        n_o = k * whirl_o + w * twist_o

        b = -(k * drop + w * push + ratio * lean * twist) / d
        m_u = -(
            k_u * drop + k * drop_u + w_u * push + w * push_u + ratio * lean_u * twist + b * d_u
        )
        m_th = -(w * drop + k * drop_th - k * push + b * d_th) - d * out / m2
        m_p = -(k * mass * g_p + w * push_p)
        m_o = -(k * w * whirl_o + ratio * lean * twist_o)
        rd = r * d
        self.a0 = a0
        self.a1 = (b + along / m2) / r
        self.a0_q0 = n_u / d
        self.a0_q1 = n_th / d
        self.a1_q0 = m_u / rd
        self.a1_q1 = m_th / rd
        self.a0_v0 = n_p / d
        self.a0_v1 = n_o / d
        self.a1_v0 = m_p / rd
        self.a1_v1 = m_o / rd

    def settle(self, h: float) -> None:
        """Keep the angle within a turn."""
        if math.fabs(self.q1) > TURN:
            self.q1 = self.take_turns(self.q1)

    def advance_frame(self, duration: float) -> None:
        if math.fabs(self.q1) > TURN and not self.is_linear:
            self.q1 = self.take_turns(self.q1)
            self.settles = True
        super().advance_frame(duration)

    def energies_at(self, t: float) -> None:
        u = self.q0
        s = math.sin(self.q1)
        c = math.cos(self.q1)
        rate = self.a_rate + t * self.a_acceleration
        au = (self.a + 0.5 * t * (self.a_rate + rate)) * u
        vx = self.vx + t * self.ax + self.v0
        vy = self.vy + t * self.ay + (2.0 * au * self.v0 + rate * u * u)
        x = self.x + t * (self.vx + 0.5 * t * self.ax) + u
        y = self.y + t * (self.vy + 0.5 * t * self.ay) + au * u
        speed = self.r * self.v1
        bx = vx + speed * c
        by = vy + speed * s
        hang = self.m2 * self.r
        potential = -self.mass * (self.gx * x + self.gy * y)
        size = self.mass * (math.fabs(self.gx * x) + math.fabs(self.gy * y))
        self.kinetic = 0.5 * (self.m1 * (vx * vx + vy * vy) + self.m2 * (bx * bx + by * by))
        self.potential = potential - hang * (self.gx * s - self.gy * c)
        self.potential_size = size + hang * (math.fabs(self.gx) + math.fabs(self.gy))

    def reactions(self) -> tuple[float, float, float, float]:
        rx, ry, tension = self.push_and_pull(0.0, self.q0, self.q1, self.v0, self.v1)
        # friction is along the parabola: what is across is the normal force
        q = 2.0 * self.a * self.q0
        return (ry - q * rx) / math.sqrt(1.0 + q * q), tension, -rx, -ry

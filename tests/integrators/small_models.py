"""Small models with known solutions, for tests of the integrators alone."""

from __future__ import annotations

import math

from curvebound.kernel.base import Model, acceleration_of
from curvebound.kernel.method import DONE, Method


def set_jacobian(model: Model, values: tuple[float, ...]) -> None:
    """Set the result of jacobian(): by (q0, q1) of a0, of a1, then likewise by (v0, v1)."""
    model.a0_q0, model.a0_q1, model.a1_q0, model.a1_q1 = values[:4]
    model.a0_v0, model.a0_v1, model.a1_v0, model.a1_v1 = values[4:]


class Oscillator(Model):
    """Two oscillators, damped and pushed: q'' = -w^2 q - d v + f, unit masses.

    A spring of stiffness `outer` is part of w^2 but not of the energy: its force does work.
    """

    def __init__(
        self,
        w0: float = 2.0,
        w1: float = 3.0,
        damping: float = 0.0,
        push: float = 0.0,
        outer: float = 0.0,
    ) -> None:
        super().__init__()
        self.k0, self.k1, self.d, self.f = w0 * w0, w1 * w1, damping, push
        self.outer = outer
        self.q0, self.q1, self.v0, self.v1 = 1.0, -0.5, 0.5, 0.0
        self.works = damping != 0.0 or push != 0.0 or outer != 0.0
        self.is_linear = True
        self.start_energy = self.energy()

    def acceleration(self, t: float, q0: float, q1: float, v0: float, v1: float) -> None:
        self.a0, self.a1 = (
            -self.k0 * q0 - self.d * v0 + self.f,
            -self.k1 * q1 - self.d * v1 + self.f,
        )

    def power(
        self, t: float, q0: float, q1: float, v0: float, v1: float, a0: float, a1: float
    ) -> float:
        force0 = self.f - self.d * v0 - self.outer * q0
        force1 = self.f - self.d * v1 - self.outer * q1
        return force0 * v0 + force1 * v1

    def jacobian(self, t: float, q0: float, q1: float, v0: float, v1: float) -> None:
        Oscillator.acceleration(self, t, q0, q1, v0, v1)
        set_jacobian(self, (-self.k0, 0.0, 0.0, -self.k1, -self.d, 0.0, 0.0, -self.d))

    def linear_system(self) -> list[list[float]]:
        return [
            [0.0, 0.0, 1.0, 0.0, 0.0],
            [0.0, 0.0, 0.0, 1.0, 0.0],
            [-self.k0, 0.0, -self.d, 0.0, self.f],
            [0.0, -self.k1, 0.0, -self.d, self.f],
            [0.0] * 5,
        ]

    def power_form(self) -> list[list[float]]:
        c = [[0.0] * 5 for _ in range(5)]
        c[2][2] = c[3][3] = -self.d
        c[0][2] = c[2][0] = c[1][3] = c[3][1] = -0.5 * self.outer
        c[2][4] = c[4][2] = c[3][4] = c[4][3] = 0.5 * self.f
        return c

    def energy(self) -> float:
        """Kinetic and elastic."""
        kinetic = 0.5 * (self.v0 * self.v0 + self.v1 * self.v1)
        k0, k1 = self.k0 - self.outer, self.k1 - self.outer
        return kinetic + 0.5 * (k0 * self.q0 * self.q0 + k1 * self.q1 * self.q1)

    def residual(self) -> float:
        """Energy minus its initial value and the work: zero for the exact solution."""
        return self.energy() - self.start_energy - self.work

    def exact(self, t: float) -> tuple[float, float, float, float]:
        """q0, q1, v0, v1 at time t from the initial state, by formula (underdamped)."""
        (q0, v0), (q1, v1) = (
            self._one(k, q, v, t) for k, q, v in ((self.k0, 1.0, 0.5), (self.k1, -0.5, 0.0))
        )
        return q0, q1, v0, v1

    def _one(self, k: float, q: float, v: float, t: float) -> tuple[float, float]:
        rest = self.f / k
        s = -0.5 * self.d
        w = math.sqrt(k - s * s)
        a, b = q - rest, (v - s * (q - rest)) / w
        c, n, e = math.cos(w * t), math.sin(w * t), math.exp(s * t)
        x = e * (a * c + b * n)
        return rest + x, s * x + e * w * (b * c - a * n)

    def error(self, t: float) -> float:
        """Largest error of a component at time t."""
        now = (self.q0, self.q1, self.v0, self.v1)
        return max(abs(x - y) for x, y in zip(now, self.exact(t), strict=True))


class Pendulum(Model):
    """A plane pendulum of unit length from the horizontal, at rest: one degree of freedom."""

    #: sin, -cos of the angle and their rates at 10 s (Jacobi elliptic functions)
    AT_10 = (0.275087462576117, -0.961419205099125, -4.17559810095173, -1.19474905456048)

    def __init__(self) -> None:
        super().__init__()
        self.q0 = math.pi / 2

    def acceleration(self, t: float, q0: float, q1: float, v0: float, v1: float) -> None:
        self.a0, self.a1 = -9.81 * math.sin(q0), 0.0

    def jacobian(self, t: float, q0: float, q1: float, v0: float, v1: float) -> None:
        self.acceleration(t, q0, q1, v0, v1)
        set_jacobian(self, (-9.81 * math.cos(q0), 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0))

    def energy(self) -> float:
        return 0.5 * self.v0 * self.v0 - 9.81 * math.cos(self.q0)

    def error(self, t: float) -> float:
        """Largest error of position and velocity at 10 s."""
        assert t == 10.0
        s, c = math.sin(self.q0), math.cos(self.q0)
        now = (s, -c, self.v0 * c, self.v0 * s)
        return max(abs(x - y) for x, y in zip(now, self.AT_10, strict=True))


class Sliding(Model):
    """A pendulum hung from an equal mass that slides on y = x^2 / 2: two degrees of freedom."""

    #: u, angle, rates at 10 s (Taylor series of 45 digits)
    AT_10 = (-0.112074121556804, -0.295201431642521, 1.11389439174177, 1.11460636851215)

    def __init__(self) -> None:
        super().__init__()
        self.q0 = self.q1 = 0.5

    def acceleration(self, t: float, q0: float, q1: float, v0: float, v1: float) -> None:
        s = math.sin(q1)
        c = math.cos(q1)
        w = c + q0 * s
        k = s - q0 * c
        g = 9.81 + v0 * v0
        d = 1.0 + q0 * q0 + k * k
        self.a0, self.a1 = (-q0 * g + k * (g * c + v1 * v1)) / d, -k * (2.0 * g + w * v1 * v1) / d

    def jacobian(self, t: float, q0: float, q1: float, v0: float, v1: float) -> None:
        """Central differences: good to 1e-9, enough for fast convergence."""
        self.acceleration(t, q0, q1, v0, v1)
        x = (q0, q1, v0, v1)
        columns = []
        for i in range(4):
            e = [1e-5 if j == i else 0.0 for j in range(4)]
            up = acceleration_of(self, t, *(y + z for y, z in zip(x, e, strict=True)))
            down = acceleration_of(self, t, *(y - z for y, z in zip(x, e, strict=True)))
            columns.append([(y - z) / 2e-5 for y, z in zip(up, down, strict=True)])
        (a, c), (b, d), (e0, g), (f, h) = columns
        set_jacobian(self, (a, b, c, d, e0, f, g, h))

    def energy(self) -> float:
        u, th, du, dth = self.q0, self.q1, self.v0, self.v1
        kinetic = (1 + u * u) * du * du + 0.5 * dth * dth
        kinetic += du * dth * (math.cos(th) + u * math.sin(th))
        return kinetic + 9.81 * (u * u - math.cos(th))

    def error(self, t: float) -> float:
        """Largest error of a component at 10 s."""
        assert t == 10.0
        now = (self.q0, self.q1, self.v0, self.v1)
        return max(abs(x - y) for x, y in zip(now, self.AT_10, strict=True))


def march(
    method: Method,
    model: Model,
    until: float = 10.0,
    *,
    pieces: int = 1,
    count: int = 1,
    tolerance: float = 1e-6,
) -> None:
    """Advance by equal communication steps, each of which must succeed."""
    for _ in range(pieces):
        outcome = method.advance(model, until / pieces, count, tolerance, 1_000_000)
        assert outcome == DONE

"""The pendulum on the parabola: Lagrange's equations, and Newton's with two multipliers.

Generalised coordinates (u, th). With q = 2 a u and M = m1 + m2, the energies are
T = M/2 (1 + q^2) u'^2 + m2/2 r^2 th'^2 + m2 r u' th' (cos th + q sin th) and
V = M g a u^2 - m2 g r cos th; the moving, changing parabola adds the terms in its accelerations.
The linear fidelity keeps the quadratic part of T - V.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any, ClassVar

import numpy as np

from .base import Array, Equations, Inputs, Number, System, Witness

__all__ = ["SYSTEM"]


class Lagrange(Equations):
    """u, th and rates; the vertex's position and velocity; the coefficient and its rate."""

    STATE: ClassVar[tuple[str, ...]] = (
        "u", "th", "du", "dth", "X", "Y", "VX", "VY", "a", "da",
    )  # fmt: skip

    def __init__(self, parameters: Mapping[str, Any]) -> None:
        super().__init__(parameters)
        self.gx, self.gy = parameters["gravity.x"], parameters["gravity.y"]
        self.m1, self.m2 = parameters["slider.mass"], parameters["pendulum.mass"]
        self.r = parameters["pendulum.length"]
        self.c1, self.c2 = parameters["slider.damping"], parameters["pendulum.damping"]
        self.linear = parameters["model.fidelity"] == "linear"

    def start(self) -> list[Array]:
        p = self.parameters
        zero = np.zeros(1, dtype=Number)
        moving = ["slider.u", "pendulum.angle", "slider.u_rate", "pendulum.angular_velocity"]
        frame = [zero, zero, zero, zero]
        shape = ["parabola.coefficient", "parabola.coefficient_rate"]
        return [
            *(p[name + "_start"] for name in moving),
            *frame,
            *(p[name + "_start"] for name in shape),
        ]

    def accelerations(self, state: Sequence[Array], inputs: Inputs) -> tuple[Array, Array]:
        """u'' and th''."""
        return self._linear(state, inputs) if self.linear else self._full(state, inputs)

    def _linear(self, state: Sequence[Array], inputs: Inputs) -> tuple[Array, Array]:
        u, th, du, dth, *_, a, _ = state
        m1, m2, r = self.m1, self.m2, self.r
        f1x, f1y = inputs["slider.fx"], inputs["slider.fy"]
        f2x, f2y = inputs["pendulum.fx"], inputs["pendulum.fy"]
        sway = inputs["parabola.ax"] - self.gx
        lift = inputs["parabola.ay"] - self.gy
        # M [1, m2 r/M; 1, r] (u'', th'') = forces, each equation divided by its own mass
        b1 = (f1x + f2x + 2 * a * u * (f1y + f2y) - self.c1 * du) / (m1 + m2)
        b1 = b1 - sway - 2 * a * lift * u
        b2 = (r * (f2x + th * f2y) - self.c2 * dth) / (m2 * r) - sway - lift * th
        turning = (b2 - b1) / r * (m1 + m2) / m1
        return b2 - r * turning, turning

    def _full(self, state: Sequence[Array], inputs: Inputs) -> tuple[Array, Array]:
        u, th, du, dth, *_, a, da = state
        m1, m2, r = self.m1, self.m2, self.r
        mass = m1 + m2
        sway = inputs["parabola.ax"] - self.gx
        lift = inputs["parabola.ay"] - self.gy
        dda = inputs["parabola.coefficient_acceleration"]
        s, c = np.sin(th), np.cos(th)
        q = 2 * a * u
        w = c + q * s
        f2x, f2y = inputs["pendulum.fx"], inputs["pendulum.fy"]
        fx, fy = inputs["slider.fx"] + f2x, inputs["slider.fy"] + f2y
        q_u = fx + q * fy - self.c1 * du * (1 + q * q)
        q_th = r * (f2x * c + f2y * s) - self.c2 * dth
        # vertical acceleration of the slider, u'' excepted
        path = lift + 2 * a * du * du + 4 * da * u * du + dda * u * u
        b1 = q_u - mass * (sway + q * path) - m2 * r * dth * dth * (q * c - s)
        b2 = q_th - m2 * r * (sway * c + path * s)
        m11, m12, m22 = mass * (1 + q * q), m2 * r * w, m2 * r * r
        det = m11 * m22 - m12 * m12
        return (m22 * b1 - m12 * b2) / det, (m11 * b2 - m12 * b1) / det

    def rates(self, time: Array, state: Sequence[Array], inputs: Inputs) -> list[Array]:
        _, _, du, dth, _, _, vx, vy, _, da = state
        ddu, ddth = self.accelerations(state, inputs)
        ax, ay = inputs["parabola.ax"], inputs["parabola.ay"]
        return [
            du, dth, ddu, ddth, vx, vy, ax, ay, da, inputs["parabola.coefficient_acceleration"],
        ]  # fmt: skip

    def outputs(
        self, names: Sequence[str], time: Array, state: Sequence[Array], inputs: Inputs
    ) -> dict[str, Array]:
        u, th, du, dth, x, y, vx, vy, a, da = state
        out = {
            "slider.u": u, "pendulum.angle": th,
            "slider.u_rate": du, "pendulum.angular_velocity": dth,
            "parabola.x": x, "parabola.y": y, "parabola.vx": vx, "parabola.vy": vy,
            "parabola.coefficient": a, "parabola.coefficient_rate": da,
        }  # fmt: skip
        if all(name in out for name in names):
            return {name: out[name] for name in names}
        s, c, r = np.sin(th), np.cos(th), self.r
        sx, sy = x + u, y + a * u * u
        svx, svy = vx + du, vy + 2 * a * u * du + da * u * u
        bvx, bvy = svx + r * dth * c, svy + r * dth * s
        zero = np.zeros_like(sx)
        out |= {
            "slider.x": sx, "slider.y": sy, "slider.vx": svx, "slider.vy": svy,
            "pendulum.x": sx + r * s, "pendulum.y": sy - r * c,
            "pendulum.vx": bvx, "pendulum.vy": bvy,
            "energy.residual": zero, "model.acceleration_error": zero,
        }  # fmt: skip
        if not all(name in out for name in names):
            out |= self._energies(state, svx, svy, bvx, bvy, sx, sy)
            out |= self._forces(state, inputs)
        return {name: out[name] for name in names}

    def _energies(
        self, state: Sequence[Array], svx: Array, svy: Array, bvx: Array, bvy: Array,
        sx: Array, sy: Array,
    ) -> dict[str, Array]:  # fmt: skip
        u, th, du, dth, *_, a, _ = state
        m1, m2, r = self.m1, self.m2, self.r
        if self.linear:  # relative to the frame, quadratic
            kinetic = m1 / 2 * du**2 + m2 / 2 * (du + r * dth) ** 2
            potential = -self.gy * ((m1 + m2) * a * u * u + m2 * r * th * th / 2)
            potential = potential - self.gx * ((m1 + m2) * u + m2 * r * th)
        else:
            kinetic = m1 / 2 * (svx**2 + svy**2) + m2 / 2 * (bvx**2 + bvy**2)
            bx, by = sx + r * np.sin(th), sy - r * np.cos(th)
            potential = -self.gx * (m1 * sx + m2 * bx) - self.gy * (m1 * sy + m2 * by)
        return {
            "energy.kinetic": kinetic, "energy.potential": potential,
            "energy.total": kinetic + potential,
        }  # fmt: skip

    def _forces(self, state: Sequence[Array], inputs: Inputs) -> dict[str, Array]:
        """Newton's law for slider and bob, in exact geometry."""
        u, th, du, dth, *_, a, da = state
        ddu, ddth = self.accelerations(state, inputs)
        s, c, r = np.sin(th), np.cos(th), self.r
        q = 2 * a * u
        dda = inputs["parabola.coefficient_acceleration"]
        # accelerations less gravity, of slider and bob
        ax = inputs["parabola.ax"] - self.gx + ddu
        ay = inputs["parabola.ay"] - self.gy + q * ddu
        ay = ay + 2 * a * du * du + 4 * da * u * du + dda * u * u
        bx, by = ax + r * (ddth * c - dth**2 * s), ay + r * (ddth * s + dth**2 * c)
        rod_x = self.m2 * bx - inputs["pendulum.fx"]
        rod_y = self.m2 * by - inputs["pendulum.fy"]
        fx = self.m1 * ax - inputs["slider.fx"] + rod_x
        fy = self.m1 * ay - inputs["slider.fy"] + rod_y
        return {
            "constraint.normal_force": (fy - q * fx) / np.sqrt(1 + q * q),
            "pendulum.tension": rod_y * c - rod_x * s,
            "parabola.fx": -fx, "parabola.fy": -fy,
        }  # fmt: skip


class Newton(Witness):
    """Slider and bob as free points from the vertex, held by parabola and rod.

    p1 = (x1, y1), d = p2 - p1: y1 - a x1^2 = 0 and (d.d - r^2)/2 = 0, each with a multiplier. The
    linear model has no such form: it is integrated in its own coordinates by the other method.
    """

    equations: Lagrange

    def start(self) -> list[Array]:
        state = self.equations.start()
        if self.equations.linear:
            return state
        u, th, du, dth, *frame, a, da = state
        r, s, c = self.equations.r, np.sin(th), np.cos(th)
        y, dy = a * u * u, 2 * a * u * du + da * u * u
        return [
            u, y, u + r * s, y - r * c,
            du, dy, du + r * dth * c, dy + r * dth * s,
            th, *frame, a, da,
        ]  # fmt: skip

    def rates(self, time: Array, state: Sequence[Array], inputs: Inputs) -> list[Array]:
        e = self.equations
        if e.linear:
            return e.rates(time, state, inputs)
        x1, y1, x2, y2, vx1, vy1, vx2, vy2, _, _, _, fvx, fvy, a, da = state
        dda = inputs["parabola.coefficient_acceleration"]
        gx, gy = e.gx - inputs["parabola.ax"], e.gy - inputs["parabola.ay"]
        dx, dy, wx, wy = x2 - x1, y2 - y1, vx2 - vx1, vy2 - vy1
        rr = dx * dx + dy * dy
        turning = (dx * wy - dy * wx) / rr
        # the couple on the rod, as forces across it at its ends
        couple = -e.c2 * turning / rr
        f2x, f2y = inputs["pendulum.fx"] - couple * dy, inputs["pendulum.fy"] + couple * dx
        q = 2 * a * x1
        f1x = inputs["slider.fx"] + couple * dy - e.c1 * vx1
        f1y = inputs["slider.fy"] - couple * dx - e.c1 * vx1 * q
        ax1, ay1 = gx + f1x / e.m1, gy + f1y / e.m1
        ax2, ay2 = gx + f2x / e.m2, gy + f2y / e.m2
        # second derivatives of both constraints: -n + a11 l1 + a12 l2 = 0 for the multipliers l
        n1 = q * ax1 - ay1 + 2 * a * vx1 * vx1 + 4 * da * x1 * vx1 + dda * x1 * x1
        n2 = -(dx * (ax2 - ax1) + dy * (ay2 - ay1)) - (wx * wx + wy * wy)
        a11 = (1 + q * q) / e.m1
        a12 = (q * dx - dy) / e.m1
        a22 = rr * (1 / e.m1 + 1 / e.m2)
        det = a11 * a22 - a12 * a12
        l1, l2 = (a22 * n1 - a12 * n2) / det, (a11 * n2 - a12 * n1) / det
        return [
            vx1, vy1, vx2, vy2,
            ax1 + (-q * l1 - dx * l2) / e.m1, ay1 + (l1 - dy * l2) / e.m1,
            ax2 + dx * l2 / e.m2, ay2 + dy * l2 / e.m2,
            turning,
            fvx, fvy, inputs["parabola.ax"], inputs["parabola.ay"], da, dda,
        ]  # fmt: skip

    def common(self, state: Sequence[Array]) -> list[Array]:
        if self.equations.linear:
            return list(state)
        x1, y1, x2, y2, vx1, vy1, vx2, vy2, th, *frame, a, da = state
        dx, dy, wx, wy = x2 - x1, y2 - y1, vx2 - vx1, vy2 - vy1
        within = np.arctan2(dx, -dy)
        turn = 2 * np.arctan2(Number(0), Number(-1))
        exact = within + turn * np.round((th - within) / turn)
        return [x1, exact, vx1, (dx * wy - dy * wx) / (dx * dx + dy * dy), *frame, a, da]


def propagator(equations: Equations, inputs: Inputs, times: Sequence[float]) -> Array | None:
    """Matrix exponential (30 digits) of the linear model with a constant coefficient.

    times: evenly spaced, the first one spacing after 0.
    """
    import mpmath

    assert isinstance(equations, Lagrange)
    start = equations.start()
    dda = inputs["parabola.coefficient_acceleration"]
    if not equations.linear or np.any(start[9] != 0) or np.any(dda != 0):
        return None
    columns = [start[0], equations.gx, equations.m1, equations.m2, equations.r, *inputs.values()]
    members = np.broadcast_shapes(*(np.shape(x) for x in [*start, *columns]))[-1]
    states = np.zeros((10, len(times), members), dtype=Number)
    # the equations are linear: their matrix is what they say about the unit vectors
    basis = [np.zeros((5, members), dtype=Number) for _ in range(4)]
    for i in range(4):
        basis[i][i + 1] = 1
    a = np.broadcast_to(start[8], (members,))
    probe = [*basis, *(np.zeros(1, dtype=Number) for _ in range(4)), a, np.zeros(1, dtype=Number)]
    ddu, ddth = (np.broadcast_to(x, (5, members)) for x in equations.accelerations(probe, inputs))
    with mpmath.workdps(30):
        for j in range(members):
            matrix = mpmath.zeros(5)
            matrix[0, 2] = matrix[1, 3] = 1
            for row, of in ((2, ddu), (3, ddth)):
                constant = _mpf(mpmath, of[0, j])
                matrix[row, 4] = constant
                for i in range(4):
                    matrix[row, i] = _mpf(mpmath, of[i + 1, j]) - constant
            z = [_mpf(mpmath, np.broadcast_to(x, (members,))[j]) for x in start[:4]]
            now = mpmath.matrix([*z, 1])
            step = mpmath.mpf(times[-1]) / len(times)
            jump = mpmath.expm(matrix * step)
            for i, t in enumerate(times):
                now = jump * now
                # the times are even but for their rounding
                there = now + matrix * now * (mpmath.mpf(t) - (i + 1) * step)
                for row in range(4):
                    states[row, i, j] = Number(mpmath.nstr(there[row], 25))
    at = np.array(times, dtype=Number)[:, None]
    ax, ay = inputs["parabola.ax"], inputs["parabola.ay"]
    states[4], states[5] = ax * at * at / 2, ay * at * at / 2
    states[6], states[7] = ax * at, ay * at
    states[8] = a
    return states


def _mpf(mp: Any, x: Any) -> Any:
    high = float(x)
    return mp.mpf(high) + mp.mpf(float(x - Number(high)))


SYSTEM = System(
    model_name="ParabolaPendulum",
    equations=Lagrange,
    witness=Newton,
    structures=({"model.fidelity": "nonlinear"}, {"model.fidelity": "linear"}),
    approximate=(("model.fidelity", "linear"),),
    main=("slider.u", "pendulum.angle"),
    closed_form=propagator,
    closed_form_name="matrix exponential, 30 digits",
    exact_with={"model.fidelity": "linear"},
)

"""The bead on a circular wire: the angle, and Cartesian coordinates with a multiplier.

With phi the angle from the downward vertical, e = gravity + force/m - acceleration of the centre,
t = (cos phi, sin phi) the tangent and k = d/m: phi'' = e.t / r - k phi'.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any, ClassVar

import numpy as np

from .base import Array, Equations, Inputs, Number, System, Witness

__all__ = ["SYSTEM"]


class Angle(Equations):
    """phi, its rate, and the centre's position and velocity."""

    STATE: ClassVar[tuple[str, ...]] = ("angle", "rate", "X", "Y", "VX", "VY")

    def __init__(self, parameters: Mapping[str, Any]) -> None:
        super().__init__(parameters)
        self.gx, self.gy = parameters["gravity.x"], parameters["gravity.y"]
        self.r, self.m = parameters["wire.radius"], parameters["bead.mass"]
        self.d = parameters["bead.damping"]

    def start(self) -> list[Array]:
        zero = np.zeros(1, dtype=Number)
        p = self.parameters
        angle, rate = p["bead.angle_start"], p["bead.angular_velocity_start"]
        return [angle, rate, zero, zero, zero, zero]

    def applied(self, inputs: Inputs) -> tuple[Array, Array]:
        """e, the acceleration of the bead off the wire, drag excepted."""
        ex = self.gx + inputs["bead.fx"] / self.m - inputs["wire.ax"]
        ey = self.gy + inputs["bead.fy"] / self.m - inputs["wire.ay"]
        return ex, ey

    def rates(self, time: Array, state: Sequence[Array], inputs: Inputs) -> list[Array]:
        angle, rate, _, _, vx, vy = state
        ex, ey = self.applied(inputs)
        turning = (ex * np.cos(angle) + ey * np.sin(angle)) / self.r - self.d / self.m * rate
        return [rate, turning, vx, vy, inputs["wire.ax"], inputs["wire.ay"]]

    def outputs(
        self, names: Sequence[str], time: Array, state: Sequence[Array], inputs: Inputs
    ) -> dict[str, Array]:
        angle, rate, x, y, vx, vy = state
        s, c = np.sin(angle), np.cos(angle)
        px, py = self.r * s, -self.r * c
        bx, by = self.r * rate * c, self.r * rate * s
        zero = np.zeros_like(px)
        out = {
            "bead.x": x + px, "bead.y": y + py, "bead.vx": vx + bx, "bead.vy": vy + by,
            "bead.angle": angle, "bead.angular_velocity": rate,
            "wire.x": x + zero, "wire.y": y + zero, "wire.vx": vx + zero, "wire.vy": vy + zero,
            "constraint.drift": zero, "energy.residual": zero,
        }  # fmt: skip
        if all(name in out for name in names):
            return {name: out[name] for name in names}
        ex, ey = self.applied(inputs)
        # drag is tangential: it does not enter the multiplier
        factor = -self.m * (px * ex + py * ey + bx * bx + by * by) / (self.r * self.r)
        kinetic = 0.5 * self.m * ((vx + bx) ** 2 + (vy + by) ** 2)
        potential = -self.m * (self.gx * (x + px) + self.gy * (y + py))
        out |= {
            "constraint.multiplier": factor, "constraint.force": factor * self.r,
            "wire.fx": self.d * bx - factor * px, "wire.fy": self.d * by - factor * py,
            "energy.kinetic": kinetic, "energy.potential": potential,
            "energy.total": kinetic + potential,
        }  # fmt: skip
        return {name: out[name] for name in names}


class Cartesian(Witness):
    """p and v from the centre, held by a multiplier; the angle follows from p x v."""

    equations: Angle

    def start(self) -> list[Array]:
        angle, rate, *frame = self.equations.start()
        s, c, r = np.sin(angle), np.cos(angle), self.equations.r
        return [r * s, -r * c, r * rate * c, r * rate * s, angle, *frame]

    def rates(self, time: Array, state: Sequence[Array], inputs: Inputs) -> list[Array]:
        px, py, vx, vy, _, _, _, fx, fy = state
        ex, ey = self.equations.applied(inputs)
        k = self.equations.d / self.equations.m
        ex, ey = ex - k * vx, ey - k * vy
        pp = px * px + py * py
        factor = -(px * ex + py * ey + vx * vx + vy * vy) / pp
        turning = (px * vy - py * vx) / pp
        ax, ay = inputs["wire.ax"], inputs["wire.ay"]
        return [vx, vy, ex + factor * px, ey + factor * py, turning, fx, fy, ax, ay]

    def common(self, state: Sequence[Array]) -> list[Array]:
        px, py, vx, vy, angle, *frame = state
        # the position knows the angle within a turn, the integral knows which turn
        within = np.arctan2(px, -py)
        turn = 2 * np.arctan2(Number(0), Number(-1))
        exact = within + turn * np.round((angle - within) / turn)
        return [exact, (px * vy - py * vx) / (px * px + py * py), *frame]


def elliptic(equations: Equations, inputs: Inputs, times: Sequence[float]) -> Array | None:
    """Jacobi elliptic functions (30 digits): no damping, nothing but a constant force field.

    With psi the angle from the direction of e, w^2 = |e|/r and the energy k^2 = sin^2(psi/2) +
    (psi'/(2 w))^2: sin(psi/2) = k sn(w t + c, k) for k < 1 (swinging) and psi/2 = am(k w t + c,
    1/k) for k > 1 (turning). Source: Whittaker, Analytical Dynamics (1904), section 44.
    """
    import mpmath

    assert isinstance(equations, Angle)
    if np.any(equations.d != 0):
        return None
    ex, ey = equations.applied(inputs)
    start = equations.start()
    shape = np.broadcast_shapes(*(np.shape(x) for x in (ex, ey, equations.r, *start)))
    members = shape[-1] if shape else 1
    states = np.zeros((6, len(times), members), dtype=Number)
    fields = [np.broadcast_to(x, (members,)) for x in (ex, ey, equations.r, start[0], start[1])]
    with mpmath.workdps(30):
        for j in range(members):
            x, y, r, angle, rate = (_exact(f[j]) for f in fields)
            solution = _one_bead(mpmath, x, y, r, angle, rate, times)
            if solution is None:
                return None
            for i, (a, b) in enumerate(solution):
                states[0, i, j] = Number(mpmath.nstr(a, 25))
                states[1, i, j] = Number(mpmath.nstr(b, 25))
    t = np.array(times, dtype=Number)[:, None]
    ax, ay = inputs["wire.ax"], inputs["wire.ay"]
    states[2], states[3] = ax * t * t / 2, ay * t * t / 2
    states[4], states[5] = ax * t, ay * t
    return states


def _exact(x: Any) -> Any:
    """An extended number as mpmath's, without loss."""
    import mpmath

    high = float(x)
    return mpmath.mpf(high) + mpmath.mpf(float(x - Number(high)))


def _one_bead(
    mp: Any, x: Any, y: Any, r: Any, angle: Any, rate: Any, times: Sequence[float]
) -> list[tuple[Any, Any]] | None:
    """(angle, rate) at the times for a bead in the constant field (x, y)."""
    size = mp.hypot(x, y)
    if size == 0:
        return [(angle + rate * t, rate) for t in times]
    down = mp.atan2(x, -y)  # the direction of the field, as an angle of the bead
    turns = mp.nint((angle - down) / (2 * mp.pi))
    offset = down + 2 * mp.pi * turns
    psi = angle - offset
    w = mp.sqrt(size / r)
    m = mp.sin(psi / 2) ** 2 + (rate / (2 * w)) ** 2  # k^2
    if abs(m - 1) < mp.mpf(10) ** -12:
        return None  # next to the separatrix the functions lose their digits
    found = []
    if m < 1:
        k = mp.sqrt(m)
        if m == 0:
            return [(offset, mp.mpf(0)) for _ in times]
        shift = mp.ellipf(mp.asin(max(-1, min(1, mp.sin(psi / 2) / k))), m)
        if rate < 0:
            shift = 2 * mp.ellipk(m) - shift
        for t in times:
            sn = mp.ellipfun("sn", w * t + shift, m=m)
            cn = mp.ellipfun("cn", w * t + shift, m=m)
            found.append((offset + 2 * mp.asin(k * sn), 2 * w * k * cn))
        return found
    k, n = mp.sqrt(m), 1 / m
    sign = 1 if rate > 0 else -1
    quarter = mp.ellipk(n)
    shift = mp.ellipf(psi / 2, n)
    for t in times:
        u = sign * k * w * t + shift
        half = mp.nint(u / (2 * quarter))  # the amplitude grows by pi in each 2 K
        sn = mp.ellipfun("sn", u - 2 * half * quarter, m=n)
        dn = mp.ellipfun("dn", u, m=n)
        amplitude = mp.asin(sn) + half * mp.pi
        found.append((offset + 2 * amplitude, sign * 2 * w * k * dn))
    return found


SYSTEM = System(
    model_name="BeadOnWire",
    equations=Angle,
    witness=Cartesian,
    structures=(
        {"model.formulation": "angle"},
        *(
            {"model.formulation": "lagrange_multiplier", "constraint.stabilization": item}
            for item in ("projection", "baumgarte", "none")
        ),
    ),
    main=("bead.x", "bead.y"),
    closed_form=elliptic,
    closed_form_name="Jacobi elliptic functions, 30 digits",
)

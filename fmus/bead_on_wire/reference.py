"""What else is known of the bead: its motion in closed form, for references.

With psi the angle from the direction of the constant field e, w^2 = |e|/r and the energy
k^2 = sin^2(psi/2) + (psi'/(2 w))^2: sin(psi/2) = k sn(w t + c, k) for k < 1 (swinging) and
psi/2 = am(k w t + c, 1/k) for k > 1 (turning). Source: Whittaker, Analytical Dynamics (1904),
section 44.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import mpmath as mp
import numpy as np

from curvebound.study.reference.equations import Array, Equations, Inputs, Number

#: outputs that stand for the whole motion
MAIN = ("bead.x", "bead.y")
CLOSED_FORM_NAME = "Jacobi elliptic functions, 30 digits"


def elliptic(equations: Equations, inputs: Inputs, times: Sequence[float]) -> Array | None:
    """States at the times: without damping, with inputs that are held; None for any other."""
    p = equations.parameters
    m, r = p["bead.mass"], p["wire.radius"]
    if np.any(p["bead.damping"] != 0):
        return None
    ex = p["gravity.x"] + inputs["bead.fx"] / m - inputs["wire.ax"]
    ey = p["gravity.y"] + inputs["bead.fy"] / m - inputs["wire.ay"]
    start = equations.start()
    shape = np.broadcast_shapes(*(np.shape(x) for x in (ex, ey, r, *start)))
    members = shape[-1] if shape else 1
    states = np.zeros((6, len(times), members), dtype=Number)
    fields = [np.broadcast_to(x, (members,)) for x in (ex, ey, r, start[0], start[1])]
    with mp.workdps(30):
        for j in range(members):
            solution = _one_bead(*(_exact(f[j]) for f in fields), times)
            if solution is None:
                return None
            for i, (a, b) in enumerate(solution):
                states[0, i, j] = Number(mp.nstr(a, 25))
                states[1, i, j] = Number(mp.nstr(b, 25))
    t = np.array(times, dtype=Number)[:, None]
    ax, ay = inputs["wire.ax"], inputs["wire.ay"]
    states[2], states[3] = ax * t * t / 2, ay * t * t / 2
    states[4], states[5] = ax * t, ay * t
    return states


def _exact(x: Any) -> Any:
    """An extended number as mpmath's, without loss."""
    high = float(x)
    return mp.mpf(high) + mp.mpf(float(x - Number(high)))


def _one_bead(
    x: Any, y: Any, r: Any, angle: Any, rate: Any, times: Sequence[float]
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


CLOSED_FORM = elliptic

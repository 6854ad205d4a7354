"""Sample results by RK4 on the equations of motion, so that these tests need no FMU."""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import Any

import numpy as np
from numpy.typing import NDArray

Table = NDArray[Any]
G = 9.81


def table(columns: dict[str, Any]) -> Table:
    """A structured array of columns."""
    data = np.empty(len(columns["time"]), dtype=[(name, float) for name in columns])
    for name, values in columns.items():
        data[name] = values
    return data


def without(data: Table, *names: str) -> Table:
    return table({name: data[name] for name in data.dtype.names if name not in names})


def renamed(data: Table, rename: Callable[[str], str]) -> Table:
    return table({rename(name): data[name] for name in data.dtype.names})


def bead(stop: float, h: float, *, project: bool = True, radius: float = 1.0) -> Table:
    """A bead from the horizontal at rest, in Cartesian coordinates."""

    def slope(x: float, y: float, vx: float, vy: float) -> tuple[float, float, float, float]:
        multiplier = (G * y - vx * vx - vy * vy) / (x * x + y * y)
        return vx, vy, multiplier * x, multiplier * y - G

    rows = []
    s = (radius, 0.0, 0.0, 0.0)
    for _ in range(round(stop / h) + 1):
        rows.append(s)
        a = slope(*s)
        b = slope(*(p + h / 2 * q for p, q in zip(s, a, strict=True)))
        c = slope(*(p + h / 2 * q for p, q in zip(s, b, strict=True)))
        d = slope(*(p + h * q for p, q in zip(s, c, strict=True)))
        x, y, vx, vy = (
            p + h / 6 * (i + 2 * j + 2 * k + m) for p, i, j, k, m in zip(s, a, b, c, d, strict=True)
        )
        if project:
            scale = radius / math.hypot(x, y)
            x, y = scale * x, scale * y
            along = (vx * x + vy * y) / radius**2
            vx, vy = vx - along * x, vy - along * y
        s = (x, y, vx, vy)
    x, y, vx, vy = np.array(rows).T
    length = np.hypot(x, y)
    multiplier = (G * y - vx**2 - vy**2) / length**2
    kinetic, potential = (vx**2 + vy**2) / 2, G * y
    rest = np.zeros_like(x)
    columns = {
        "bead.x": x,
        "bead.y": y,
        "bead.vx": vx,
        "bead.vy": vy,
        "bead.angle": np.unwrap(np.arctan2(x, -y)),
        "bead.angular_velocity": (x * vy - y * vx) / length**2,
        "wire.x": rest,
        "wire.y": rest,
        "constraint.multiplier": multiplier,
        "constraint.force": multiplier * length,
        "constraint.drift": length - radius,
        "energy.kinetic": kinetic,
        "energy.potential": potential,
        "energy.total": kinetic + potential,
        "energy.residual": kinetic + potential,
        "solver.steps": np.arange(len(x)),
    }
    time = np.arange(len(x)) * h
    return table({"time": time, **{f"bead.{name}": v for name, v in columns.items()}})


def pendulum(
    stop: float, h: float, *, push: float = 0.0, a: float = 0.5, length: float = 1.0
) -> Table:
    """A pendulum on a parabola whose vertex is accelerated by push sin 3t; unit masses."""

    def slope(s: NDArray[np.float64]) -> NDArray[np.float64]:
        _, vx, u, angle, rate, turn, t = s
        ax, q = push * math.sin(3.0 * t), 2 * a * u
        sin, cos = math.sin(angle), math.cos(angle)
        g, k, w = G + 2 * a * rate**2, sin - q * cos, cos + q * sin
        d = 1 + q * q + k * k
        pull = g * cos - ax * sin + length * turn**2
        u2 = (-(ax + q * g) + k * pull) / d
        angle2 = -k * (2 * (g - q * ax) + w * length * turn**2) / (length * d)
        return np.array([vx, ax, rate, turn, u2, angle2, 1.0])

    s = np.array([0.0, 0.0, 0.5, 0.5, 0.0, 0.0, 0.0])
    rows = []
    for _ in range(round(stop / h) + 1):
        rows.append(s)
        k1 = slope(s)
        k2 = slope(s + h / 2 * k1)
        k3 = slope(s + h / 2 * k2)
        s = s + h / 6 * (k1 + 2 * k2 + 2 * k3 + slope(s + h * k3))
    x, vx, u, angle, rate, turn, _ = np.array(rows).T
    time = np.arange(len(x)) * h
    slider = (x + u, a * u * u)
    columns = {
        "slider.u": u,
        "slider.u_rate": rate,
        "slider.x": slider[0],
        "slider.y": slider[1],
        "pendulum.angle": angle,
        "pendulum.angular_velocity": turn,
        "pendulum.x": slider[0] + length * np.sin(angle),
        "pendulum.y": slider[1] - length * np.cos(angle),
        "parabola.x": x,
        "parabola.y": 0 * x,
        "parabola.vx": vx,
        "parabola.coefficient": np.full(len(x), a),
        "energy.residual": 1e-9 * time,
    }
    drive = {"parabola.ax": push * np.sin(3 * time), "slider.u": u, "pendulum.angle": angle}
    return table(
        {
            "time": time,
            **{f"plant.{name}": values for name, values in columns.items()},
            **{f"drive.{name}": values for name, values in drive.items()},
        }
    )

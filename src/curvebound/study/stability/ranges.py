"""Random points of the whole declared ranges of both systems.

Sizes are drawn uniformly in their logarithm. Terms that can be off (damping, inputs, gravity, a
start speed) are off in a share of the points, so that the simpler cases occur too.
"""

from __future__ import annotations

import math
import random
from collections.abc import Callable
from typing import NamedTuple

__all__ = ["SYSTEMS", "Point", "draw"]

Value = float | str


class Point(NamedTuple):
    """One point: its number in the sample and all that it sets, by variable name."""

    number: int
    values: dict[str, Value]


def _size(rng: random.Random, low: float, high: float) -> float:
    """Uniform in the logarithm."""
    return math.exp(rng.uniform(math.log(low), math.log(high)))


def _signed(rng: random.Random, low: float, high: float) -> float:
    return _size(rng, low, high) * rng.choice((-1.0, 1.0))


def _sometimes(rng: random.Random, share: float, value: float) -> float:
    """The value in a share of the points, else zero. The value is drawn in any case."""
    return value if rng.random() < share else 0.0


def _gravity(rng: random.Random) -> dict[str, Value]:
    """Mostly downward, sometimes upward or zero, sometimes oblique."""
    kind = rng.random()
    down = _size(rng, 1e-3, 1e3)
    if kind < 0.1:
        down = 0.0
    elif kind < 0.3:
        down = -down
    return {"gravity.x": _sometimes(rng, 0.25, _signed(rng, 1e-3, 1e3)), "gravity.y": -down}


def _angle(rng: random.Random) -> float:
    """Anywhere on the circle; sometimes many turns on."""
    return rng.uniform(-math.pi, math.pi) + _sometimes(
        rng, 0.1, 2.0 * math.pi * rng.randint(-1000, 1000)
    )


def bead(rng: random.Random) -> dict[str, Value]:
    """A bead on a wire."""
    radius = _size(rng, 1e-3, 1e3)
    mass = _size(rng, 1e-8, 1e8)
    speed = _sometimes(rng, 0.75, _signed(rng, 1e-3, 1e3))
    formulation = rng.choice(("lagrange_multiplier", "angle"))
    stabilization = rng.choice(("none", "baumgarte", "projection", "projection"))
    return {
        **_gravity(rng),
        "wire.radius": radius,
        "bead.mass": mass,
        "bead.damping": _sometimes(rng, 0.6, _size(rng, 1e-6, 1e6)),
        "bead.angle_start": _angle(rng),
        "bead.angular_velocity_start": speed / radius,
        "model.formulation": formulation,
        "constraint.stabilization": stabilization,
        "wire.ax": _sometimes(rng, 0.2, _signed(rng, 1e-3, 1e3)),
        "wire.ay": _sometimes(rng, 0.2, _signed(rng, 1e-3, 1e3)),
        "bead.fx": _sometimes(rng, 0.2, mass * _signed(rng, 1e-3, 1e3)),
        "bead.fy": _sometimes(rng, 0.2, mass * _signed(rng, 1e-3, 1e3)),
    }


def pendulum(rng: random.Random) -> dict[str, Value]:
    """A pendulum on a parabola."""
    slider = _size(rng, 1e-4, 1e4)
    bob = slider * _size(rng, 1e-8, 1e8)
    length = _size(rng, 1e-3, 1e3)
    coefficient = _sometimes(rng, 0.95, _signed(rng, 1e-4, 1e4))
    u = _sometimes(rng, 0.8, _signed(rng, 1e-3, 1e3))
    # start speeds are those along the parabola and of the bob about the slider
    slope = 2.0 * coefficient * u
    speed = _sometimes(rng, 0.7, _signed(rng, 1e-3, 1e3))
    turning = _sometimes(rng, 0.7, _signed(rng, 1e-3, 1e3))
    return {
        **_gravity(rng),
        "parabola.coefficient_start": coefficient,
        "parabola.coefficient_rate_start": _sometimes(rng, 0.1, _signed(rng, 1e-4, 1e4)),
        "slider.mass": slider,
        "pendulum.mass": bob,
        "pendulum.length": length,
        "slider.damping": _sometimes(rng, 0.4, _size(rng, 1e-6, 1e6)),
        "pendulum.damping": _sometimes(rng, 0.4, _size(rng, 1e-6, 1e6)),
        "slider.u_start": u,
        "slider.u_rate_start": speed / math.sqrt(1.0 + slope * slope),
        "pendulum.angle_start": _angle(rng),
        "pendulum.angular_velocity_start": turning / length,
        "model.fidelity": rng.choice(("nonlinear", "nonlinear", "nonlinear", "linear")),
        "parabola.ax": _sometimes(rng, 0.15, _signed(rng, 1e-3, 1e3)),
        "parabola.ay": _sometimes(rng, 0.15, _signed(rng, 1e-3, 1e3)),
        "parabola.coefficient_acceleration": _sometimes(rng, 0.1, _signed(rng, 1e-4, 1e4)),
        "slider.fx": _sometimes(rng, 0.15, slider * _signed(rng, 1e-3, 1e3)),
        "slider.fy": _sometimes(rng, 0.15, slider * _signed(rng, 1e-3, 1e3)),
        "pendulum.fx": _sometimes(rng, 0.15, bob * _signed(rng, 1e-3, 1e3)),
        "pendulum.fy": _sometimes(rng, 0.15, bob * _signed(rng, 1e-3, 1e3)),
    }


#: by the name of the system: its FMU, and how its points are drawn
SYSTEMS: dict[str, tuple[str, Callable[[random.Random], dict[str, Value]]]] = {
    "bead": ("BeadOnWire", bead),
    "pendulum": ("ParabolaPendulum", pendulum),
}


def draw(system: str, count: int, seed: int) -> list[Point]:
    """The first `count` points of the sample of `system`; KeyError for an unknown one."""
    _, one = SYSTEMS[system]
    return [Point(i, one(random.Random(f"{system} {seed} {i}"))) for i in range(count)]

"""Random motions of both plants that are hard on an integrator.

Each has parameters, start values, inputs that jump at each of PARTS communication steps, and a
tolerance; rests near the inverted one, settled states and extreme ratios are frequent.
"""

from __future__ import annotations

import math
import random
from dataclasses import dataclass

PARTS = 20


@dataclass
class Motion:
    """A point: values by variable name, inputs per communication step, step (s), tolerance."""

    values: dict[str, float]
    inputs: list[list[float]]
    step: float
    tolerance: float


def size(rng: random.Random, low: float, high: float) -> float:
    """Uniform in the logarithm."""
    return math.exp(rng.uniform(math.log(low), math.log(high)))


def signed(rng: random.Random, low: float, high: float) -> float:
    """Of either sign."""
    return size(rng, low, high) * rng.choice((-1.0, 1.0))


def maybe(rng: random.Random, share: float, value: float) -> float:
    """The value in a share of the points, else zero."""
    return value if rng.random() < share else 0.0


def angle(rng: random.Random) -> float:
    """Often near the inverted rest, sometimes near the hanging one, else anywhere."""
    kind = rng.random()
    if kind < 0.3:
        off = 0.0 if rng.random() < 0.15 else size(rng, 1e-13, 1e-3)
        return math.pi - off
    if kind < 0.4:
        return signed(rng, 1e-12, 1e-2)
    return rng.uniform(-math.pi, math.pi)


def gravity(rng: random.Random) -> dict[str, float]:
    """Mostly down, sometimes up, oblique or none."""
    down = rng.choice((9.81, 9.81, size(rng, 1e-2, 1e2), -9.81, 0.0))
    return {"gravity.x": maybe(rng, 0.2, signed(rng, 1e-2, 1e2)), "gravity.y": -down}


def bead(rng: random.Random) -> Motion:
    """A bead on its wire."""
    r = size(rng, 1e-3, 1e4)
    m = size(rng, 1e-8, 1e8)
    values = gravity(rng)
    pull = math.hypot(*values.values()) or 1.0
    time = math.sqrt(r / pull)
    rate = maybe(rng, 0.5, signed(rng, 1e-3, 30.0) / time)
    k = maybe(rng, 0.5, size(rng, 1e-3, 1e6))
    values |= {
        "wire.radius": r,
        "bead.mass": m,
        "bead.damping": m * k,
        "bead.angle_start": angle(rng),
        "bead.angular_velocity_start": rate,
        "model.formulation": rng.choice((1, 2)),
        "constraint.stabilization": 3,
        "solver.method": 4,
    }
    drive = maybe(rng, 0.4, size(rng, 1e-3, 10.0) * pull)
    push = maybe(rng, 0.3, m * size(rng, 1e-3, 10.0) * pull)
    sizes = (drive, drive, push, push)
    time = min(time, 1.0 / abs(rate) if rate else math.inf)
    if k and rng.random() < 0.5:
        time *= size(rng, 1e-4, 1e3)
    return finish(rng, values, sizes, time)


def pendulum(rng: random.Random) -> Motion:
    """A pendulum on its parabola."""
    m1 = size(rng, 1e-3, 1e3)
    m2 = m1 * rng.choice((1.0, size(rng, 1e-2, 1e2), size(rng, 1e-10, 1e10)))
    r = size(rng, 1e-2, 1e2)
    values = gravity(rng)
    pull = math.hypot(*values.values()) or 1.0
    time = math.sqrt(r / pull)
    a = rng.choice((0.0, 0.5, -0.5, 1.0 / r, size(rng, 1e-3, 1e5), -size(rng, 1e-3, 1e3)))
    # some ten oscillations of what is fastest
    time = min(time, 3.0 / math.sqrt(2.0 * abs(a) * pull)) if a else time
    u = maybe(rng, 0.7, signed(rng, 1e-4, 1e2))
    lean = math.hypot(1.0, 2.0 * a * u)
    values |= {
        "parabola.coefficient_start": a,
        "parabola.coefficient_rate_start": 0.0,
        "slider.mass": m1,
        "pendulum.mass": m2,
        "pendulum.length": r,
        "slider.damping": maybe(rng, 0.4, m1 * size(rng, 1e-3, 1e6)),
        "pendulum.damping": maybe(rng, 0.4, m2 * r * r * size(rng, 1e-3, 1e6)),
        "slider.u_start": u,
        "slider.u_rate_start": maybe(rng, 0.3, signed(rng, 1e-3, 10.0) * r / time / lean),
        "pendulum.angle_start": angle(rng),
        "pendulum.angular_velocity_start": maybe(rng, 0.3, signed(rng, 1e-3, 10.0) / time),
        "model.fidelity": 2,
        "solver.method": 4,
    }
    drive = maybe(rng, 0.3, size(rng, 1e-3, 10.0) * pull)
    push = maybe(rng, 0.3, size(rng, 1e-3, 10.0) * pull)
    sizes = (drive, drive, 0.0, m1 * push, m1 * push, m2 * push, m2 * push)
    return finish(rng, values, sizes, time)


def finish(
    rng: random.Random, values: dict[str, float], sizes: tuple[float, ...], time: float
) -> Motion:
    """Inputs of the sizes, the step from a characteristic time (s), and a tolerance."""
    inputs = [[x * rng.uniform(-1.0, 1.0) for x in sizes] for _ in range(PARTS)]
    if rng.random() < 0.5:
        inputs = [[0.0] * len(sizes)] * PARTS
    return Motion(values, inputs, time * size(rng, 0.05, 2.0), size(rng, 1e-12, 1e-2))

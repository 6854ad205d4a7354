"""Random motions of both plants with `adaptive`, against Taylor series in extended precision.

    python tests/stability/campaign.py PLANT COUNT [SEED] [FIRST]

PLANT is bead or pendulum. Each point is a plant with parameters, start values, inputs that jump at
each of PARTS communication steps, and a tolerance; rests near the inverted one, settled states and
extreme ratios are frequent. The reference is heyoka's Taylor integrator in long double, which
shares neither method nor formula with the kernel. A point's conditioning is how much it magnifies
a relative change of its numbers by CHANGE. It is wrong if its error exceeds MARGIN times tolerance
times conditioning and no warning says so, doubtful if one does though it is well conditioned.

Needs heyoka (the extra `peers`) and a C compiler. Prints every point that is wrong, failed or dear.
"""

from __future__ import annotations

import math
import random
import sys
from collections import Counter
from dataclasses import dataclass, field
from typing import Any

import numpy as np

from curvebound.bench import ours

PARTS = 20
CHANGE = 1e-9
MARGIN = 10.0
#: below this a point is well conditioned
WELL = 100.0
#: internal steps that are too many, steps of the reference below which no failure is excused
DEAR = 100_000
EASY = 1000
#: steps of the reference in a communication step after which a point is left out
MOST = 20_000
REST = 1e-6
Number = np.longdouble


@dataclass
class Motion:
    """A point: values by variable name, inputs per communication step, step (s), tolerance."""

    values: dict[str, float]
    inputs: list[list[float]]
    step: float
    tolerance: float


@dataclass
class Outcome:
    """What became of a point."""

    verdict: str
    error: float = math.nan
    conditioning: float = math.nan
    steps: int = 0
    reference_steps: int = 0
    warned: bool = False
    detail: str = ""


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


@dataclass
class Plant:
    """A plant: how points are drawn, what is compared, and the reference's parameters."""

    fmu: str
    draw: Any
    names: tuple[str, ...]
    inputs: int
    start: tuple[str, ...]
    taylor: Any = field(default=None, repr=False)

    def series(self) -> Any:
        """The Taylor integrator, made once."""
        if self.taylor is None:
            import heyoka as hy

            equations = bead_equations if self.fmu == "BeadOnWire" else pendulum_equations
            system = equations(hy)
            parameters = len(self.names) + self.inputs
            self.taylor = hy.taylor_adaptive(
                system,
                [Number(0)] * len(system),
                pars=[Number(1)] * parameters,
                fp_type=Number,
                tol=Number(1e-18),
            )
        return self.taylor


def bead_equations(hy: Any) -> list[Any]:
    """theta'' = e.(cos, sin)/r - k theta'."""
    th, om = hy.make_vars("th", "om")
    gx, gy, r, m, d, ax, ay, fx, fy = (hy.par[i] for i in range(9))
    ex = gx - ax + fx / m
    ey = gy - ay + fy / m
    return [(th, om), (om, (ex * hy.cos(th) + ey * hy.sin(th)) / r - d / m * om)]


def pendulum_equations(hy: Any) -> list[Any]:
    """Newton's law with the rod's tension eliminated."""
    u, th, v, om = hy.make_vars("u", "th", "v", "om")
    gx, gy, a, m1, m2, r, c1, c2, ax, ay, _, f1x, f1y, f2x, f2y = (hy.par[i] for i in range(15))
    s, c = hy.sin(th), hy.cos(th)
    slope = 2.0 * a * u
    couple = c2 * om / r
    bx, by = ax - gx, ay - gy + 2.0 * a * v * v
    along = s - slope * c
    steep = 1.0 + slope * slope
    push = f1x + slope * f1y - c1 * v * steep + couple * (c + slope * s)
    tension = f2x * s - f2y * c + m2 * (r * om * om - (bx * s - by * c))
    ddu = (push - m1 * (bx + by * slope) + along * tension) / (m1 * steep + m2 * along * along)
    across = (f2x * c + f2y * s - couple) / m2 - (bx * c + by * s)
    return [(u, v), (th, om), (v, ddu), (om, (across - ddu * (c + slope * s)) / r)]


PLANTS = {
    "bead": Plant(
        "BeadOnWire",
        bead,
        ("gravity.x", "gravity.y", "wire.radius", "bead.mass", "bead.damping"),
        4,
        ("bead.angle_start", "bead.angular_velocity_start"),
    ),
    "pendulum": Plant(
        "ParabolaPendulum",
        pendulum,
        (
            "gravity.x",
            "gravity.y",
            "parabola.coefficient_start",
            "slider.mass",
            "pendulum.mass",
            "pendulum.length",
            "slider.damping",
            "pendulum.damping",
        ),
        7,
        (
            "slider.u_start",
            "pendulum.angle_start",
            "slider.u_rate_start",
            "pendulum.angular_velocity_start",
        ),
    ),
}


def exact(
    plant: Plant, motion: Motion, factors: list[float] | None = None
) -> tuple[np.ndarray, int] | None:
    """States (PARTS + 1, n) at the communication points, and the most steps in one; or None.

    factors: by which all numbers are multiplied, None for 1.
    """
    ta = plant.series()
    of = iter(factors) if factors else iter(lambda: 1.0, None)
    ta.time = Number(0)
    ta.pars[: len(plant.names)] = [
        Number(motion.values[name]) * Number(next(of)) for name in plant.names
    ]
    ta.state[:] = [Number(motion.values[name]) * Number(next(of)) for name in plant.start]
    found = [ta.state.copy()]
    most = 0
    scales = [Number(next(of)) for _ in range(plant.inputs)]
    for i in range(PARTS):
        ta.pars[len(plant.names) :] = [
            Number(x) * y for x, y in zip(motion.inputs[i], scales, strict=True)
        ]
        done = ta.propagate_until(Number(motion.step) * (i + 1), max_steps=MOST)
        if "time_limit" not in str(done[0]) or not np.all(np.isfinite(ta.state)):
            return None
        most = max(most, int(done[3]))
        found.append(ta.state.copy())
    return np.array(found), most


def difference(plant: Plant, motion: Motion, states: np.ndarray, others: np.ndarray) -> float:
    """The largest difference of an output, relative to its largest value.

    Angles: to a radian or the angle turned. What hardly moves: to REST of the length.
    """
    half = states.shape[1] // 2
    worst = 0.0
    for i in range(states.shape[1]):
        place = states[:, i % half]
        if plant.start[i % half] == "slider.u_start":
            length = max(motion.values["pendulum.length"], float(np.abs(place).max()))
            scale = max(float(np.abs(states[:, i]).max()), REST * length)
        else:
            length = scale = max(1.0, float(np.abs(place - place[0]).max()))
        if i >= half:
            scale = float(np.abs(states[:, i]).max())
            scale = max(scale, REST * length / (PARTS * motion.step))
        worst = max(worst, float(np.abs(states[:, i] - others[:, i]).max()) / scale)
    return worst if not math.isnan(worst) else math.inf


def run(kernel: Any, plant: Plant, motion: Motion) -> tuple[np.ndarray, int, int, bool]:
    """The kernel's states, its outcome (0: done), steps in all, and whether it warns."""
    model = kernel.system(plant.fmu, motion.values)
    method = kernel.method(4)
    rows = [state_of(plant, model)]
    outcome = 0
    for i in range(PARTS):
        model.set_inputs(motion.inputs[i], 0)
        outcome = method.advance(model, motion.step, 1, motion.tolerance, DEAR)
        if outcome:
            break
        model.advance_frame(motion.step)
        rows.append(state_of(plant, model))
    return np.array(rows, dtype=Number), outcome, method.steps, method.doubt() > motion.tolerance


def state_of(plant: Plant, model: Any) -> list[float]:
    """Coordinates and rates in the reference's order."""
    if plant.fmu == "BeadOnWire":
        turned, rate, _ = model.rotation()
        return [turned, rate]
    model.observe(0, values := [0.0] * len(model.OUTPUTS), 0)
    return [values[0], values[2], values[1], values[3]]


def judge(kernel: Any, plant: Plant, motion: Motion, rng: random.Random) -> Outcome:
    """The verdict on a point."""
    found = exact(plant, motion)
    if found is None:
        return Outcome("no reference")
    states, most = found
    result, failure, steps, warned = run(kernel, plant, motion)
    outcome = Outcome("right", steps=steps, reference_steps=most, warned=warned)
    if failure:
        outcome.verdict = "failed" if most < EASY else "excused"
        outcome.detail = f"outcome {failure} in part {len(result)}"
        return outcome
    outcome.error = difference(plant, motion, states, result)
    conditioning = 1.0
    if outcome.error > MARGIN * motion.tolerance:
        for _ in range(3):
            factors = [1.0 + CHANGE * rng.choice((-1.0, 1.0)) for _ in range(40)]
            other = exact(plant, motion, factors)
            if other is not None:
                change = difference(plant, motion, states, other[0]) / CHANGE
                conditioning = max(conditioning, change)
    outcome.conditioning = conditioning
    if not outcome.error <= MARGIN * motion.tolerance * conditioning:
        if not warned:
            outcome.verdict = "wrong"
        elif conditioning < WELL:
            outcome.verdict = "doubtful"
    elif steps > DEAR:
        outcome.verdict = "dear"
    return outcome


def campaign(name: str, count: int, seed: int, first: int = 0, kernel: Any = None) -> list[Outcome]:
    """The outcomes of `count` points from number `first` on; the bad ones are printed."""
    plant = PLANTS[name]
    kernel = kernel or ours.compiled_kernel()
    outcomes = []
    for number in range(first, first + count):
        rng = random.Random(f"{name} {seed} {number}")
        motion = plant.draw(rng)
        outcome = judge(kernel, plant, motion, rng)
        outcomes.append(outcome)
        if outcome.verdict not in ("right", "no reference", "excused"):
            where = f"{name} seed {seed} point {number}, tolerance {motion.tolerance:.1e}"
            print(f"{where}: {outcome}", flush=True)
    return outcomes


if __name__ == "__main__":
    arguments = [int(x) for x in sys.argv[2:]]
    found = campaign(sys.argv[1], arguments[0], *(arguments[1:] or [1]))
    print(Counter(one.verdict for one in found))
    print("warned", sum(one.warned for one in found), "of", len(found))
    print("most steps", max(one.steps for one in found))

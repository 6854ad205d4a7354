"""Random motions of both plants with `adaptive`, against Taylor series in extended precision.

    python tests/stability/campaign.py PLANT COUNT [--seed N] [--first N] [--hints with|without]

PLANT is bead or pendulum, points are drawn by campaign_motions.py; hints are what a model says of
its motion beforehand (magnification), and each point is run with and without. The reference is
heyoka's Taylor integrator in long double, which shares neither method nor formula with the kernel.
A point's conditioning is how much it magnifies a relative change of its numbers by CHANGE. It is
wrong if its error exceeds MARGIN times tolerance times conditioning and no warning says so,
doubtful if one does though it is well conditioned (conditioning below WELL). A warning is needless
if its point is well conditioned and its error below FAR of that bound: counted beside the verdict,
which stays "right".

Needs heyoka (the extra `peers`) and a C compiler. Prints every point that is wrong, failed or dear.
"""

from __future__ import annotations

import argparse
import math
import random
import sys
from collections import Counter
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import numpy as np

sys.path.insert(0, str(Path(__file__).parents[1]))

from benchmarks import ours
from campaign_equations import bead_equations, pendulum_equations
from campaign_motions import PARTS, Motion, bead, pendulum

from curvebound.fmi.watch import MAGNIFIED

CHANGE = 1e-9
MARGIN = 10.0
#: below this a point is well conditioned
WELL = 100.0
#: share of the error that a warning is about below which it was needless
FAR = 0.01
#: internal steps that are too many, steps of the reference below which no failure is excused
DEAR = 100_000
EASY = 1000
#: steps of the reference in a communication step after which a point is left out
MOST = 20_000
REST = 1e-6
#: model.formulation
ANGLE = 2
Number = np.longdouble
TURN = 8.0 * np.arctan(Number(1))


@dataclass
class Outcome:
    """What became of a point."""

    verdict: str
    hints: bool = True
    error: float = math.nan
    conditioning: float = math.nan
    allowed: float = math.nan
    steps: int = 0
    reference_steps: int = 0
    warned: bool = False
    detail: str = ""

    @property
    def needless(self) -> bool:
        """Whether it warned of an error that is far from what is allowed, at a tame point."""
        return self.warned and self.conditioning < WELL and self.error < FAR * self.allowed


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


@dataclass
class Exact:
    """The reference: states (PARTS + 1, n) at the communication points, and their largest (n)
    magnitudes between them too; the most steps in a communication step."""

    states: np.ndarray
    largest: np.ndarray
    most: int


def exact(plant: Plant, motion: Motion, factors: list[float] | None = None) -> Exact | None:
    """The reference; None where it fails.

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
    largest = np.abs(ta.state)
    most = 0

    def look(ta: Any) -> bool:
        np.maximum(largest, np.abs(ta.state), out=largest)
        return True

    scales = [Number(next(of)) for _ in range(plant.inputs)]
    for i in range(PARTS):
        ta.pars[len(plant.names) :] = [
            Number(x) * y for x, y in zip(motion.inputs[i], scales, strict=True)
        ]
        done = ta.propagate_until(Number(motion.step) * (i + 1), max_steps=MOST, callback=look)
        if "time_limit" not in str(done[0]) or not np.all(np.isfinite(ta.state)):
            return None
        most = max(most, int(done[3]))
        found.append(ta.state.copy())
    return Exact(np.array(found), largest, most)


def difference(plant: Plant, motion: Motion, reference: Exact, others: np.ndarray) -> float:
    """The largest difference of an output, relative to its largest value during the motion.

    Angles: to a radian or the angle turned. What hardly moves: to REST of the length.
    """
    states = reference.states
    half = states.shape[1] // 2
    worst = 0.0
    for i in range(states.shape[1]):
        place = states[:, i % half]
        if plant.start[i % half] == "slider.u_start":
            length = max(motion.values["pendulum.length"], float(np.abs(place).max()))
            scale = max(float(reference.largest[i]), REST * length)
        else:
            length = scale = max(1.0, float(np.abs(place - place[0]).max()))
        if i >= half:
            scale = max(float(reference.largest[i]), REST * length / (PARTS * motion.step))
        worst = max(worst, float(np.abs(states[:, i] - others[:, i]).max()) / scale)
    return worst if not math.isnan(worst) else math.inf


def run(
    kernel: Any, plant: Plant, motion: Motion, hints: bool
) -> tuple[np.ndarray, int, int, bool]:
    """The kernel's states, its outcome (0: done), steps in all, and whether it warns."""
    model = kernel.system(plant.fmu, motion.values)
    method = kernel.method(4)
    rows = [state_of(motion, model)]
    outcome = 0
    doubt = 0.0
    for i in range(PARTS):
        # the frame, which the relative motion does not feel, stays where it is
        model.set_inputs(motion.inputs[i], 0)
        if not hints:
            model.magnification = 1.0
        doubt = max(doubt, MAGNIFIED * model.magnification)
        outcome = method.advance(model, motion.step, 1, motion.tolerance, DEAR)
        if outcome:
            break
        rows.append(state_of(motion, model))
    doubt = max(doubt, method.doubt(), method.loss())
    return np.array(rows, dtype=Number), outcome, method.steps, doubt > motion.tolerance


def state_of(motion: Motion, model: Any) -> list[float]:
    """Coordinates and rates in the reference's order; angles but for whole turns."""
    q0, q1, v0, v1 = model.q0, model.q1, model.v0, model.v1
    formulation = motion.values.get("model.formulation")
    if formulation is None:
        return [q0, q1, v0, v1]
    if formulation == ANGLE:
        return [q0, v0]
    return [math.atan2(q0, -q1), (q0 * v1 - q1 * v0) / (q0 * q0 + q1 * q1)]


def unwind(plant: Plant, states: np.ndarray, others: np.ndarray) -> None:
    """Add whole turns to the angles of `others`, to those nearest to `states`."""
    i = len(plant.start) // 2 - 1
    turns = np.round((states[: len(others), i] - others[:, i]) / TURN)
    others[:, i] += turns * TURN


@dataclass
class References:
    """A point's exact motion, and how much it magnifies a change of its numbers: found once."""

    plant: Plant
    motion: Motion
    rng: random.Random
    known: float = 0.0

    def __post_init__(self) -> None:
        self.exact = exact(self.plant, self.motion)

    def conditioning(self) -> float:
        """The largest of three changes of all numbers; at least 1."""
        assert self.exact is not None
        if self.known == 0.0:
            self.known = 1.0
            for _ in range(3):
                factors = [1.0 + CHANGE * self.rng.choice((-1.0, 1.0)) for _ in range(40)]
                other = exact(self.plant, self.motion, factors)
                if other is not None:
                    change = difference(self.plant, self.motion, self.exact, other.states) / CHANGE
                    self.known = max(self.known, change)
        return self.known


def judge(kernel: Any, references: References, hints: bool) -> Outcome:
    """The verdict on a point."""
    plant, motion, reference = references.plant, references.motion, references.exact
    if reference is None:
        return Outcome("no reference", hints)
    most = reference.most
    result, failure, steps, warned = run(kernel, plant, motion, hints)
    outcome = Outcome("right", hints, steps=steps, reference_steps=most, warned=warned)
    if failure:
        outcome.verdict = "failed" if most < EASY else "excused"
        outcome.detail = f"outcome {failure} in part {len(result)}"
        return outcome
    unwind(plant, reference.states, result)
    outcome.error = difference(plant, motion, reference, result)
    told = warned or outcome.error > MARGIN * motion.tolerance
    conditioning = references.conditioning() if told else 1.0
    outcome.conditioning = conditioning
    outcome.allowed = MARGIN * motion.tolerance * conditioning
    if not outcome.error <= outcome.allowed:
        if not warned:
            outcome.verdict = "wrong"
        elif conditioning < WELL:
            outcome.verdict = "doubtful"
    elif steps > DEAR:
        outcome.verdict = "dear"
    return outcome


def campaign(
    name: str, count: int, seed: int, first: int = 0, hints: tuple[bool, ...] = (True, False)
) -> list[Outcome]:
    """The outcomes of `count` points from number `first` on; the bad ones are printed."""
    plant = PLANTS[name]
    kernel = ours.compiled_kernel()
    outcomes = []
    for number in range(first, first + count):
        rng = random.Random(f"{name} {seed} {number}")
        motion = plant.draw(rng)
        references = References(plant, motion, rng)
        for with_hints in hints:
            outcome = judge(kernel, references, with_hints)
            outcomes.append(outcome)
            if outcome.verdict not in ("right", "no reference", "excused"):
                where = f"{name} seed {seed} point {number}, tolerance {motion.tolerance:.1e}"
                print(f"{where}: {outcome}", flush=True)
    return outcomes


def main() -> None:
    """The command."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("plant", choices=PLANTS)
    parser.add_argument("count", type=int)
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--first", type=int, default=0)
    parser.add_argument("--hints", choices=("with", "without"))
    chosen = parser.parse_args()
    hints = (True, False) if chosen.hints is None else (chosen.hints == "with",)
    found = campaign(chosen.plant, chosen.count, chosen.seed, chosen.first, hints)
    for one in hints:
        some = [outcome for outcome in found if outcome.hints == one]
        print("with hints:" if one else "without hints:", dict(Counter(o.verdict for o in some)))
        print("    warned", sum(o.warned for o in some), "of", len(some))
        print("        needless", sum(o.needless for o in some))
        print("    most steps", max(o.steps for o in some))


if __name__ == "__main__":
    main()

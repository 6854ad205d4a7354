"""Random points of the ranges that a system declares in its fmu.py.

Sizes are drawn uniformly in their logarithm. Terms that can be off (damping, inputs, gravity, a
start speed) are off in a share of the points, so that the simpler cases occur too.
"""

from __future__ import annotations

import math
import random
from collections.abc import Callable
from functools import partial
from pathlib import Path
from typing import NamedTuple

from ...fmi.declaration import CHOICE, INPUT, PARAMETER, Fmu, Variable
from ...fmi.folder import Folder, find, names
from ...fmi.ranges import Angle, Explored, Items, Range
from ...mechanics.derive import derive
from ...mechanics.derived import Derived
from ..reference.motion import Motion

__all__ = ["RandomPoint", "draw", "drawer", "sampled", "systems"]

Value = float | str
#: of what fmu.py names no range for
_SIZE = Range(1e-3, 1e3)
_SPEED = Range(1e-3, 1e3, signed=True, share=0.7, speed=True)
_START = Range(1e-3, 1e3, signed=True, share=0.8)
_DAMPING = Range(1e-6, 1e6, share=0.4)
_PUSH = Range(1e-3, 1e3, signed=True, share=0.15)


class RandomPoint(NamedTuple):
    """One point: its number in the sample and all that it sets, by variable name."""

    number: int
    values: dict[str, Value]


def sampled(which: str | Path) -> tuple[Folder, Derived]:
    """The folder of a system that can be sampled, and what follows from its statement."""
    folder = find(which)
    return folder, derive(folder.path / "mechanics.py", folder.name)


def systems() -> list[str]:
    """Names of the shipped systems that have mechanics."""
    return [name for name in names() if (find(name).path / "mechanics.py").is_file()]


def draw(which: str | Path, count: int, seed: int) -> list[RandomPoint]:
    """The first `count` points of the sample of a system, by its name or folder."""
    name = find(which).name
    one = drawer(which)
    return [RandomPoint(i, one(random.Random(f"{name} {seed} {i}"))) for i in range(count)]


def drawer(which: str | Path) -> Callable[[random.Random], dict[str, Value]]:
    """What draws one point of a system's ranges."""
    folder, derived = sampled(which)
    return partial(_point, ranges=_ranges(folder.fmu(), derived), derived=derived)


def _ranges(fmu: Fmu, derived: Derived) -> dict[str, Explored]:
    """Ranges of all that a sample sets: those declared, and the usual ones."""
    found = dict(fmu.ranges)
    solver = ("gravity.x", "gravity.y", "solver.step", "solver.tolerance")
    for v in fmu.variables:
        if v.name in found or v.name in solver or v.kind not in (PARAMETER, CHOICE, INPUT):
            continue
        usual = _usual(v, derived)
        if v.kind == CHOICE and v.type is not None and v.name != "solver.method":
            usual = Items(tuple(item for item, _ in v.type.items))
        elif v.kind == PARAMETER and usual is None and not v.name.startswith("constraint."):
            usual = _SIZE._replace(signed=True)
        if isinstance(usual, Range) and v.minimum is not None:
            usual = _within(usual, v)
        if usual is not None:
            found[v.name] = usual
    return found


def _within(usual: Range, v: Variable) -> Range:
    """The part of a range that is in a variable's domain."""
    least = max(usual.low, v.minimum or 0.0)
    zero = v.minimum == 0.0 and not v.above
    share = usual.share if zero else 1.0
    return usual._replace(low=least, high=max(usual.high, 2.0 * least), signed=False, share=share)


def _usual(v: Variable, derived: Derived) -> Explored | None:
    name = v.name
    if name in derived.damping:
        return _DAMPING
    if v.kind == INPUT:
        mass = f"{name.rpartition('.')[0]}.mass"
        of_mass = name in derived.forces and mass.partition(".")[0] in derived.masses
        return _PUSH._replace(times=mass) if of_mass else _PUSH
    for coordinate, rate, is_angle in zip(
        derived.coordinates, derived.rates, derived.angles, strict=True
    ):
        if name == f"{coordinate}_start":
            return Angle() if is_angle else _START
        if name == f"{rate}_start":
            return _SPEED
    if name in {f"{shape}_rate_start" for shape in derived.shapes}:
        return _PUSH
    return None


def _point(rng: random.Random, ranges: dict[str, Explored], derived: Derived) -> dict[str, Value]:
    values: dict[str, Value] = {}
    speeds = []
    if "gravity" not in ranges:
        values |= _gravity(rng)
    for name, explored in ranges.items():
        if name == "gravity":
            values |= _gravity(rng)
        elif isinstance(explored, Items):
            values[name] = rng.choice(explored.items)
        elif isinstance(explored, Angle):
            values[name] = _angle(rng, explored)
        else:
            value = _drawn(rng, explored)
            if explored.times:
                value *= float(values[explored.times])
            values[name] = value
            if explored.speed:
                speeds.append(name)
    rates = [f"{rate}_start" for rate in derived.rates]
    for name in speeds:
        speed = float(values[name])
        if speed != 0.0:
            still = {**values, **dict.fromkeys(rates, 0.0)}
            values[name] = speed / Motion(derived, still).reach(rates.index(name))
    return values


def _drawn(rng: random.Random, explored: Range) -> float:
    """A size, drawn in any case, and in a share of the points what is meant."""
    value = math.exp(rng.uniform(math.log(explored.low), math.log(explored.high)))
    if explored.signed:
        value *= rng.choice((-1.0, 1.0))
    if explored.share < 1.0 and not rng.random() < explored.share:
        return 0.0
    return value


def _gravity(rng: random.Random) -> dict[str, Value]:
    """Mostly downward, sometimes upward or zero, sometimes oblique."""
    kind = rng.random()
    down = _drawn(rng, _SIZE)
    if kind < 0.1:
        down = 0.0
    elif kind < 0.3:
        down = -down
    return {"gravity.x": _drawn(rng, Range(1e-3, 1e3, True, 0.25)), "gravity.y": -down}


def _angle(rng: random.Random, explored: Angle) -> float:
    angle = rng.uniform(-math.pi, math.pi)
    turns = 2.0 * math.pi * rng.randint(-explored.turns, explored.turns)
    return angle + (turns if rng.random() < explored.share_of_turns else 0.0)

"""What a macro step costs with inputs linear in time over it, beside one with inputs held.

Each plant is driven by a function of time, in the last row by an FMU that it drives in turn, with
both holds: CPU microseconds per macro step of 10 ms, the least of the rounds, set-up excluded, and
the median of the ratios. The two scenes driven by a function record all that they do elsewhere, the
other rows nothing between start and end.
"""

from __future__ import annotations

import argparse
import math
import time
from collections.abc import Callable
from contextlib import ExitStack
from functools import partial
from statistics import median

from curvebound.cosim import Scene, load_scene
from curvebound.cosim.prepared import Prepared

__all__ = ["configure", "run"]

STEP = 0.01
#: FMU, driven input, recorded output
PLANTS = (
    ("BeadOnWire", "wire.ax", "bead.angle"),
    ("ParabolaPendulum", "parabola.ax", "pendulum.angle"),
)
METHODS: tuple[tuple[str, dict[str, float | str]], ...] = (
    ("rk4, 1 internal step", {"solver.method": "rk4", "solver.step": STEP}),
    ("rk4, 10 internal steps", {"solver.method": "rk4", "solver.step": 0.1 * STEP}),
    ("adaptive, 1e-6", {"solver.method": "adaptive", "solver.tolerance": 1e-6}),
    ("adaptive, 1e-10", {"solver.method": "adaptive", "solver.tolerance": 1e-10}),
)


def scene(fmu: str, driven: str, output: str, start: dict[str, float | str], hold: str) -> Scene:
    """One plant, driven by a sine."""
    made = Scene("held", stop_time=1.0, step=STEP, hold=hold, record_every=10**9)
    made.add("plant", fmu, start).input(f"plant.{driven}", lambda t: 0.5 * math.sin(2.0 * t))
    return made.record(f"plant.{output}")


def cost(prepared: Prepared, steps: int) -> float:
    """CPU seconds of a run over so many macro steps."""
    began = time.process_time()
    prepared.run(stop_time=steps * STEP)
    return time.process_time() - began


def shaken(hold: str) -> Scene:
    """The scene shaken_wire."""
    made = load_scene("shaken_wire")
    made.hold = hold
    return made


def swayed(hold: str) -> Scene:
    """The scene swaying_parabola, driven by a function instead of its FMU."""
    omega = 2.0 * math.pi * 0.35
    made = Scene("swayed", stop_time=20.0, step=STEP, hold=hold)
    made.add("plant", "ParabolaPendulum", {"slider.u_start": 0.0, "pendulum.angle_start": 0.0})
    made.input("plant.parabola.ax", lambda t: -0.5 * omega * omega * math.cos(omega * t))
    return made.record(*load_scene("swaying_parabola").recorded)


def coupled(hold: str) -> Scene:
    """A drive FMU that measures the plant it drives."""
    made = load_scene("swaying_parabola")
    made.hold, made.record_every = hold, 10**9
    return made


def compare(name: str, make: Callable[[str], Scene], options: argparse.Namespace) -> None:
    """Print the row of a scene, which `make` gives for either hold."""
    found: dict[str, list[float]] = {"zero": [], "first": []}
    with ExitStack() as stack:
        ready = {hold: stack.enter_context(Prepared(make(hold))) for hold in found}
        for prepared in ready.values():
            cost(prepared, 10)
        for _ in range(options.rounds):
            for hold, prepared in ready.items():
                set_up = cost(prepared, 1)
                spent = cost(prepared, options.steps + 1) - set_up
                found[hold].append(1e6 * spent / options.steps)
    ratio = median(b / a for a, b in zip(found["zero"], found["first"], strict=True))
    zero, first = (min(values) for values in found.values())
    print(f"  {name:22s} {zero:6.2f}   {first:6.2f}   {ratio:6.2f}")


def configure(parser: argparse.ArgumentParser) -> None:
    """Add the arguments."""
    parser.add_argument("--steps", type=int, default=1000)
    parser.add_argument("--rounds", type=int, default=15)


def run(options: argparse.Namespace) -> int:
    """Print the table."""
    print("us per macro step        zero    first    ratio")
    for fmu, driven, output in PLANTS:
        print(fmu)
        for name, start in METHODS:
            compare(name, partial(scene, fmu, driven, output, start), options)
    print("scenes")
    compare("shaken_wire", shaken, options)
    compare("swaying, by a function", swayed, options)
    compare("swaying_parabola", coupled, options)
    return 0

"""How fast a sweep is: two workers against one, and against fmpy.simulate_fmu in a loop.

What two workers can gain is what the machine gives to two processes; it is measured in the same
rounds with two that share nothing. On a machine with other work to do neither comes near two.
"""

from __future__ import annotations

import argparse
import statistics
import subprocess
import sys
import tempfile
import time as clock
from dataclasses import dataclass
from pathlib import Path

from curvebound.study.sweep.design import Design, axis
from curvebound.study.sweep.engine import Sweep

__all__ = ["Speed", "configure", "run", "sweep_speed"]

_WORK = """
import time
began = time.perf_counter()
total = 0
for i in range(20_000_000):
    total += i & 7
print(time.perf_counter() - began)
"""


@dataclass(frozen=True)
class Speed:
    """Medians over the rounds.

    gain: speed with two workers over that with one; machine: the same of plain work.
    best: the largest gain of a round, that which other work on the machine disturbed least.
    against: throughput of two workers over that of simulate_fmu.
    """

    gain: float
    best: float
    machine: float
    against: float


def sweep_speed(points: int = 2000, rounds: int = 3) -> Speed:
    """Sweep a bead over 10 s at 100 communication points a second, with `points` dampings."""
    from fmpy import simulate_fmu

    node = _sweep(2).scene.check().nodes["bead"]
    gains, machine, against = [], [], []
    for _ in range(rounds):
        alone = _plain(1)
        one, two = _seconds_per_point(points, 1), _seconds_per_point(points, 2)
        machine.append(2.0 * alone / _plain(2))
        gains.append(one / two)
        began = clock.perf_counter()
        for i in range(10):
            simulate_fmu(
                str(node.fmu.path), stop_time=10.0, output_interval=0.01, output=["bead.y"],
                start_values={**node.start, "bead.damping": 0.1 * i},
            )  # fmt: skip
        against.append((clock.perf_counter() - began) / 10 / two)
    middle = statistics.median
    return Speed(middle(gains), max(gains), middle(machine), middle(against))


def _sweep(points: int) -> Sweep:
    design = Design([axis(f"bead.bead.damping=0:1:{points}")])
    return Sweep("bead_on_wire", design, ["final(bead.bead.y)"])


def _seconds_per_point(points: int, workers: int) -> float:
    marks: list[tuple[float, int]] = []
    with tempfile.TemporaryDirectory() as folder:
        _sweep(points).run(
            Path(folder) / "a.csv", workers=workers,
            progress=lambda done, _, __: marks.append((clock.perf_counter(), done)),
        )  # fmt: skip
    # from a quarter on: all workers are at work, and their start is not the sweep's speed
    first = next(i for i, (_, done) in enumerate(marks) if done > 0.25 * points)
    (a, at_a), (b, at_b) = marks[first], marks[-1]
    return (b - a) / (at_b - at_a)


def _plain(count: int) -> float:
    """Seconds that a fixed piece of work takes in the slowest of `count` processes at once."""
    running = [
        subprocess.Popen([sys.executable, "-c", _WORK], stdout=subprocess.PIPE, text=True)
        for _ in range(count)
    ]
    return max(float(process.communicate()[0]) for process in running)


def configure(parser: argparse.ArgumentParser) -> None:
    """There are no arguments."""


def run(options: argparse.Namespace) -> int:
    """Print the speed of a sweep."""
    found = sweep_speed()
    print(
        f"two workers: {found.gain:.2f} times the speed of one, {found.best:.2f} in the best "
        f"round; two processes that share nothing: {found.machine:.2f}"
    )
    print(f"two workers: {found.against:.1f} times fmpy.simulate_fmu called with the file name")
    return 0

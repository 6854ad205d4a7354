"""Long runs: 1e5 periods of the bead, 2000 s of it, 1e7 communication steps of the pendulum."""

from __future__ import annotations

import argparse

from rich.console import Console
from rich.progress import Progress

from curvebound.arguments import positive

from .endurance import print_endurance, run_endurance
from .iftomm import SETTINGS, print_benchmark, run_one
from .long_runs import METHODS, print_long, run_long

__all__ = ["configure", "run"]

LEAST, LONGEST = 1e3, 1e9


def configure(parser: argparse.ArgumentParser) -> None:
    """Add the arguments."""
    parser.add_argument(
        "--method", action="append", choices=METHODS, help="only the bead over many periods"
    )
    parser.add_argument("--periods", type=positive, default=1e5, help="of the bead (default: 1e5)")
    parser.add_argument(
        "--calls", type=positive, default=1e7, help="communication steps of the pendulum (1e7)"
    )


def run(options: argparse.Namespace) -> int:
    """Run and print; --method: the bead over many periods alone. Returns 1 where one misses."""
    if not all(LEAST <= n <= LONGEST for n in (options.periods, options.calls)):
        options.wrong(f"--periods and --calls must be at least {LEAST:g} and at most {LONGEST:g}")
    with Progress(console=Console(stderr=True)) as bar:
        methods = [m for m in METHODS if m in (options.method or METHODS)]
        grown = [
            run_long(method, options.periods)
            for method in bar.track(methods, description=f"{options.periods:g} periods")
        ]
    print_long(grown)
    good = all(one.as_expected for one in grown)
    if options.method:
        return int(not good)
    with Progress(console=Console(stderr=True)) as bar:
        numbers = range(len(SETTINGS))
        marks = [run_one(number) for number in bar.track(numbers, description="2000 s")]
    print_benchmark(marks)
    with Progress(console=Console(stderr=True)) as bar:
        task = bar.add_task("communication steps", total=options.calls)
        endurance = run_endurance(int(options.calls), lambda n: bar.update(task, completed=n))
    print_endurance(endurance)
    return int(not (good and all(one.good for one in marks) and endurance.good))

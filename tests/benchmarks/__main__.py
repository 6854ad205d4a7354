"""Evidence about the project itself: what it costs beside others, and whether its promises hold.

    python tests/benchmarks                   everything, one after the other (hours)
    python tests/benchmarks GROUP [...]       one group; GROUP --help shows its arguments

groups: cost, kernels, start, building, pythons, macro, holds, sweep, tune, facts, long, maps, live
"""

from __future__ import annotations

import argparse
import sys
from pathlib import Path

if __name__ == "__main__":  # this folder is found as `benchmarks`, not its files one by one
    sys.path[0] = str(Path(__file__).resolve().parents[1])

from benchmarks import (
    building,
    cost,
    facts,
    holds,
    kernels,
    live,
    long_runs_command,
    macro_step,
    maps_command,
    promises_command,
    pythons,
    start,
    sweep_speed,
)

from curvebound.errors import CurveboundError

GROUPS = {
    "cost": (cost, "kernel and FMUs beside hand-written C, scipy, heyoka and MuJoCo"),
    "kernels": (kernels, "the compiled kernel of another commit: same bits, and the cost"),
    "start": (start, "CPU time of the command line's start"),
    "building": (building, "CPU time of building: all FMUs, one kernel, again"),
    "pythons": (pythons, "one FMU file under each CPython, in fmpy and in a C host"),
    "macro": (macro_step, "a macro step of a scene here and in other tools that read SSP"),
    "holds": (holds, "a macro step with inputs linear in time beside one with inputs held"),
    "sweep": (sweep_speed, "two workers against one, and against fmpy.simulate_fmu in a loop"),
    "tune": (promises_command, "bounds met on fresh starts, and the cost beside the whole grid's"),
    "facts": (facts, "known facts about both systems, measured anew"),
    "long": (long_runs_command, "long runs of bead and pendulum against theory"),
    "maps": (maps_command, "stability maps of both systems, 12 parameters"),
    "live": (live, "pace, pictures and delay of live scenes in headless Chromium"),
}


def main(arguments: list[str] | None = None) -> int:
    """Run one group, or all; returns 1 where one of them found a promise broken."""
    parser = argparse.ArgumentParser(
        prog="python tests/benchmarks",
        description=__doc__,
        formatter_class=argparse.RawDescriptionHelpFormatter,
    )
    commands = parser.add_subparsers(metavar="GROUP")
    for name, (module, words) in GROUPS.items():
        sub = commands.add_parser(name, help=words, description=module.__doc__)
        module.configure(sub)
        sub.set_defaults(run=module.run, wrong=sub.error)
    options = parser.parse_args(arguments)
    chosen = [options] if hasattr(options, "run") else [parser.parse_args([g]) for g in GROUPS]
    try:
        return max(int(one.run(one)) for one in chosen)
    except CurveboundError as error:
        print(f"error: {error}", file=sys.stderr)
        return error.status


if __name__ == "__main__":
    sys.exit(main())

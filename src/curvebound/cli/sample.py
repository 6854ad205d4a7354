"""Run random points of all ranges that a system declares, each judged by an exact reference.

Every point is accurate, or says that it is not, or is so sensitive to its numbers that no more can
be asked; what is none of these is wrong. All points with their values go into a table (CSV). Exit
status 1 where one is wrong, or 1 % or more are not accurate.

examples:
  curvebound sample --points 2000 --jobs 2
  curvebound sample ./my_system --points 200 --method implicit
"""

from __future__ import annotations

import argparse
from pathlib import Path

from ..arguments import positive, whole
from ..output import console_of, hand_out
from ..progress import Progress

NAME = "sample"
HELP = "run random points of a system's ranges against exact references"
AS_JSON = True


def configure(parser: argparse.ArgumentParser) -> None:
    """Add the arguments."""
    from ..kernel.methods import METHODS  # with all of them, which `--help` alone does without

    parser.add_argument(
        "systems", nargs="*", metavar="SYSTEM", help="name or folder (default: the shipped ones)"
    )
    parser.add_argument(
        "--points", type=whole(1), default=200, metavar="N", help="of each system (default: 200)"
    )
    parser.add_argument("--seed", type=int, default=1, help="another sample (default: 1)")
    parser.add_argument("--method", choices=METHODS, default="adaptive", help="default: adaptive")
    parser.add_argument(
        "--tolerance", type=positive, default=1e-8, help="of adaptive (default: 1e-8)"
    )
    parser.add_argument(
        "--times", type=positive, default=10.0, help="characteristic times of a run (default: 10)"
    )
    parser.add_argument("--jobs", type=whole(1), default=1, help="processes (default: 1)")
    parser.add_argument("--out", type=Path, default=Path("build/stability"), metavar="DIR")


def run(options: argparse.Namespace) -> int:
    """Draw, run, judge, print; status 1 where a sample misses."""
    from collections import Counter

    from ..files import sole_writer
    from ..study.stability.ranges import systems
    from ..study.stability.sample import SampleSettings, run_sample
    from ..study.stability.sample_report import passes, print_sample, write_sample

    console = console_of(options)
    data = []
    files = {
        system: options.out / f"sample_{Path(system).name}.csv"
        for system in options.systems or systems()
    }
    good = True
    try:
        with sole_writer(*files.values()):
            for system, file in files.items():
                settings = SampleSettings(system, options.method, options.tolerance, options.times)
                with Progress(f"sample of the {system}", options.points, "points") as tell:
                    outcomes = run_sample(
                        settings, options.points, options.seed, jobs=options.jobs, progress=tell
                    )
                print_sample(console, outcomes, settings, options.seed)
                console.print(str(write_sample(outcomes, file)), soft_wrap=True)
                verdicts = dict(Counter(one.verdict for one in outcomes))
                data.append({"system": system, "verdicts": verdicts, "file": file})
                good = passes(outcomes) and good
    except KeyboardInterrupt:
        raise KeyboardInterrupt(
            "stopped by the keyboard; files named above are whole, nothing else is kept"
        ) from None
    hand_out(options, data)
    return 0 if good else 1

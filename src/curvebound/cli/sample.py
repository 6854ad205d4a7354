"""Run random points of all ranges that a system declares, each judged by an exact reference.

Every point is accurate, or says that it is not; what is neither is printed. All points with their
values go into a table (CSV).

examples:
  curvebound sample --points 2000 --jobs 2
  curvebound sample ./my_system --points 200 --method implicit
"""

from __future__ import annotations

import argparse
from pathlib import Path

from ..arguments import positive, whole
from ..kernel.methods import METHODS
from .bar import progress_bar

NAME = "sample"
HELP = "run random points of a system's ranges against exact references"


def configure(parser: argparse.ArgumentParser) -> None:
    """Add the arguments."""
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
    from rich.console import Console

    from ..files import sole_writer
    from ..study.stability.ranges import systems
    from ..study.stability.sample import SampleSettings, run_sample
    from ..study.stability.sample_report import passes, print_sample, write_sample

    console = Console(highlight=False)
    files = {
        system: options.out / f"sample_{Path(system).name}.csv"
        for system in options.systems or systems()
    }
    good = True
    try:
        with sole_writer(*files.values()):
            for system, file in files.items():
                settings = SampleSettings(system, options.method, options.tolerance, options.times)
                with progress_bar(console) as bar:
                    task = bar.add_task(f"sample of the {system}", total=options.points, note="")
                    outcomes = run_sample(
                        settings,
                        options.points,
                        options.seed,
                        jobs=options.jobs,
                        progress=lambda n, bar=bar, task=task: bar.update(task, completed=n),  # type: ignore[misc]
                    )
                print_sample(outcomes, settings, options.seed)
                console.print(str(write_sample(outcomes, file)))
                good = passes(outcomes) and good
    except KeyboardInterrupt:
        raise KeyboardInterrupt(
            "stopped by the keyboard; files named above are whole, nothing else is kept"
        ) from None
    return 0 if good else 1

"""What building takes: CPU time of the three FMUs with nothing cached, of one kernel, and again.

For this machine alone: where mingw-w64 is installed, `curvebound build` compiles for Windows as
well, which takes as long once more.
"""

from __future__ import annotations

import argparse
import os
import subprocess
import sys
import tempfile
from pathlib import Path

from rich.console import Console
from rich.table import Table

from curvebound.arguments import whole

__all__ = ["configure", "run"]

#: what is built -> CPU seconds that are aimed at
AIMS = {"all, nothing cached": 15.3, "a kernel of its own": 5.0, "all, again": 1.5}
_BUILD = """
import sys
from curvebound.cli import main
from curvebound.compiling.toolchain import HERE
from curvebound.fmi import binaries, compile
compile.PLATFORMS = (HERE,)
binaries.PLATFORMS = {HERE: binaries.PLATFORMS[HERE]}
sys.exit(main(["build", "--quiet", "--out", sys.argv[1], *sys.argv[2:]]))
"""


def configure(parser: argparse.ArgumentParser) -> None:
    """Add the arguments."""
    parser.add_argument("--rounds", type=whole(1), default=3, help="builds each (default: 3)")


def run(options: argparse.Namespace) -> int:
    """Print the least of the rounds; 1 where an aim is missed."""
    found: dict[str, list[float]] = {what: [] for what in AIMS}
    for _ in range(options.rounds):
        with tempfile.TemporaryDirectory(prefix="curvebound-bench-") as name:
            place = Path(name)
            subprocess.run(
                [sys.executable, "-m", "curvebound", "new", place / "own"],
                stdout=subprocess.DEVNULL,
                check=True,
            )
            whole_build, own, again = AIMS
            found[whole_build].append(_seconds(place))
            found[own].append(_seconds(place, str(place / "own")))
            found[again].append(_seconds(place))
    table = Table("build", "CPU s", "aim", box=None)
    for what, aim in AIMS.items():
        table.add_row(what, f"{min(found[what]):.2f}", f"{aim:g}")
    Console(highlight=False).print(table)
    return int(any(min(found[what]) > aim for what, aim in AIMS.items()))


def _seconds(place: Path, *systems: str) -> float:
    """CPU time of a build and the compilers that it starts, with the cache in `place`."""
    environment = {k: v for k, v in os.environ.items() if k != "PYTHONDONTWRITEBYTECODE"}
    environment["CURVEBOUND_CACHE"] = str(place / "cache")
    before = os.times()
    subprocess.run(
        [sys.executable, "-c", _BUILD, place / "built", *systems], check=True, env=environment
    )
    after = os.times()
    return sum(after[2:4]) - sum(before[2:4])

"""What the command line takes to start: CPU time of whole processes, the least of several."""

from __future__ import annotations

import argparse
import os
import subprocess
import sys

from rich.console import Console
from rich.table import Table

from curvebound.arguments import whole

__all__ = ["configure", "run"]

#: command -> CPU seconds that are aimed at on an idle machine, all that can be kept being kept
AIMS = {"--help": 0.25, "list": 0.25, "run bead_on_wire": 0.6, "run inverted_balance": 0.6}


def configure(parser: argparse.ArgumentParser) -> None:
    """Add the arguments."""
    parser.add_argument("--rounds", type=whole(1), default=7, help="processes each (default: 7)")


def run(options: argparse.Namespace) -> int:
    """Print the times; 1 where an aim is missed."""
    table = Table("command", "CPU s", "aim", box=None)
    missed = False
    bare = min(_seconds(["-c", "import numpy"]) for _ in range(options.rounds))
    for command, aim in AIMS.items():
        words = ["-m", "curvebound", *command.split()]
        _seconds(words)
        least = min(_seconds(words) for _ in range(options.rounds))
        missed = missed or least > aim
        table.add_row(f"curvebound {command}", f"{least:.2f}", f"{aim:g}")
    table.add_row("python -c 'import numpy'", f"{bare:.2f}", "")
    Console(highlight=False).print(table)
    return int(missed)


def _seconds(words: list[str]) -> float:
    """CPU time of a Python process and what it started, its modules kept as bytecode."""
    environment = {k: v for k, v in os.environ.items() if k != "PYTHONDONTWRITEBYTECODE"}
    before = os.times()
    subprocess.run([sys.executable, *words], stdout=subprocess.DEVNULL, check=True, env=environment)
    after = os.times()
    return sum(after[2:4]) - sum(before[2:4])

"""Measure what the kernel and the FMUs cost, beside C and beside general tools, in one run.

examples:
  curvebound bench --only kernel --only fmu
  curvebound bench --json bench.json
"""

from __future__ import annotations

import argparse
from pathlib import Path

NAME = "bench"
HELP = "measure cost and accuracy beside C, scipy, heyoka and MuJoCo"

_SECTIONS = ("kernel", "fmu", "accuracy", "size", "startup")


def configure(parser: argparse.ArgumentParser) -> None:
    """Add the arguments."""
    parser.add_argument(
        "--only",
        action="append",
        choices=_SECTIONS,
        metavar="SECTION",
        help=f"one of {', '.join(_SECTIONS)} (repeat for more; default: all)",
    )
    parser.add_argument("--json", type=Path, metavar="FILE", help="write all figures to FILE")
    parser.add_argument(
        "--every-point", action="store_true", help="print each setting of the accuracy section"
    )
    parser.add_argument(
        "--quick", action="store_true", help="see that it runs: few, small measurements"
    )


def run(options: argparse.Namespace) -> int:
    """Measure, print, save."""
    from rich.console import Console

    from ..bench.machine import machine
    from ..bench.report import as_data, print_report, save
    from ..bench.results import Settings
    from ..bench.run import run_sections
    from ..files import require_writable

    if options.json:  # known before the minutes that the figures take
        require_writable(options.json)
    settings = Settings(quick=options.quick, rounds=1 if options.quick else 7)
    names = [name for name in _SECTIONS if name in (options.only or _SECTIONS)]
    with Console(stderr=True).status("") as status:
        sections = run_sections(
            names, settings, lambda name, made: status.update(f"{name}: {made} measurements")
        )
    described = machine()
    print_report(sections, described, settings.rounds, every_point=options.every_point)
    if options.quick:
        Console(stderr=True).print("--quick: one small measurement each, not figures to quote")
    if options.json:
        save(as_data(sections, described, settings.rounds), options.json)
    return 0

"""What the kernel and the FMUs cost, beside C and beside general tools, in one run."""

from __future__ import annotations

import argparse
from pathlib import Path

from rich.console import Console

from curvebound.arguments import whole
from curvebound.files import require_writable

from .report import as_data, print_report, save
from .results import Settings
from .sections import SECTIONS, described_machine, run_sections

__all__ = ["configure", "run"]


def configure(parser: argparse.ArgumentParser) -> None:
    """Add the arguments."""
    parser.add_argument(
        "--only",
        action="append",
        choices=list(SECTIONS),
        metavar="SECTION",
        help=f"one of {', '.join(SECTIONS)} (repeat for more; default: all)",
    )
    parser.add_argument("--json", type=Path, metavar="FILE", help="write all figures to FILE")
    parser.add_argument(
        "--every-point", action="store_true", help="print each setting of the accuracy section"
    )
    parser.add_argument(
        "--rounds", type=whole(1), default=7, help="interleaved rounds of each (default: 7)"
    )
    parser.add_argument(
        "--quick", action="store_true", help="see that it runs: few, small measurements"
    )


def run(options: argparse.Namespace) -> int:
    """Measure, print, save."""
    if options.json:  # known before the minutes that the figures take
        require_writable(options.json)
    settings = Settings(quick=options.quick, rounds=1 if options.quick else options.rounds)
    names = [name for name in SECTIONS if name in (options.only or SECTIONS)]
    with Console(stderr=True).status("") as status:
        sections = run_sections(
            names, settings, lambda name, made: status.update(f"{name}: {made} measurements")
        )
    described = described_machine()
    print_report(sections, described, settings.rounds, every_point=options.every_point)
    if options.quick:
        Console(stderr=True).print("--quick: one small measurement each, not figures to quote")
    if options.json:
        save(as_data(sections, described, settings.rounds), options.json)
    return 0

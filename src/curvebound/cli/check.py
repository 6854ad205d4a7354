"""Check FMUs and scenes, as CI does after building them.

An FMU, ours or any of FMI 2.0 for co-simulation: description, a run, start values, its distance to
the reference that it carries (or --reference), reset, saved states, every method of solver.method,
and the same bits in another process. A scene: its components, a run, the needs that it states, and
the same bits in another process. What an FMU does not offer is skipped and said.

Exit status: 0 all passed, 1 something failed, 2 a target or an option is none.

examples:
  curvebound check build/*.fmu --junit report.xml
  curvebound check inverted_balance --max plant.energy.residual=1e-6
  curvebound check others/Plant.fmu --reference plant.csv --tolerance 1e-3 --json
"""

from __future__ import annotations

import argparse
from pathlib import Path
from typing import TYPE_CHECKING

from ..arguments import positive, seconds, setting
from ..errors import CurveboundError, OutsideError, nearest
from ..output import console_of, hand_out
from ..progress import Progress

if TYPE_CHECKING:
    from rich.console import Console

    from ..checking.finding import Report

NAME = "check"
HELP = "check FMUs and scenes: description, reference, states, methods"
AS_JSON = True

_COLOURS = {"passed": "green", "failed": "bold red", "skipped": "dim"}


def configure(parser: argparse.ArgumentParser) -> None:
    """Add the arguments."""
    parser.add_argument(
        "target", nargs="+", metavar="TARGET",
        help="an FMU, by file or name; a system's folder; or a scene, by name, .py or .ssp file",
    )  # fmt: skip
    parser.add_argument(
        "--max", metavar="OUTPUT=BOUND", type=_bound, action="append", default=[],
        help="largest absolute value allowed of an output of each target, in a scene of "
        "component.variable; may be repeated",
    )  # fmt: skip
    parser.add_argument(
        "--tolerance", metavar="REL", type=positive, default=1e-6,
        help="error allowed to the reference, relative to the largest value (default: 1e-6)",
    )  # fmt: skip
    parser.add_argument(
        "--reference", metavar="FILE.csv", type=Path,
        help="time and outputs, in place of those that the FMU carries",
    )  # fmt: skip
    parser.add_argument(
        "--inputs", metavar="FILE.csv", type=Path, help="time and inputs that belong to --reference"
    )
    parser.add_argument(
        "--set", metavar="VARIABLE=VALUE", type=setting, action="append", default=[],
        help="a start value; the FMU's own reference is then no measure; may be repeated",
    )  # fmt: skip
    parser.add_argument("--stop", metavar="T", type=seconds, help="stop time in s")
    parser.add_argument("--step", metavar="H", type=seconds, help="communication step in s")
    parser.add_argument(
        "--timeout", metavar="T", type=seconds, default=600.0,
        help="time that one target may take, in s (default: 600)",
    )  # fmt: skip
    parser.add_argument(
        "--junit", metavar="FILE.xml", type=Path, help="write a report for CI as well"
    )


def _bound(text: str) -> tuple[str, float]:
    path, value = setting(text)
    return path, positive(value)


def run(options: argparse.Namespace) -> int:
    """Check each target and report; 1 when one failed."""
    from ..checking.junit import junit
    from ..checking.request import Request
    from ..checking.run import check
    from ..files import require_writable, write_whole

    if options.junit is not None:
        require_writable(options.junit)
    for file in (options.reference, options.inputs):
        if file is not None and not file.is_file():
            raise OutsideError(f"There is no file {file}.")
    targets = [_target(word) for word in options.target]
    console = console_of(options)
    reports = []
    for target, kind in targets:
        request = Request(
            start=dict(options.set), stop=options.stop, step=options.step,
            reference=options.reference, inputs=options.inputs, tolerance=options.tolerance,
            most=dict(options.max),
        )  # fmt: skip
        with Progress(f"checking {target}") as tell:
            reports.append(
                check(
                    target, kind, request, timeout=options.timeout,
                    tell=lambda name, tell=tell: tell(note=name),  # type: ignore[misc]
                )
            )  # fmt: skip
        _show(console, reports[-1])
    passed = all(report.passed for report in reports)
    data = {"passed": passed, "targets": [report.as_data() for report in reports]}
    hand_out(options, data)
    if options.junit is not None:
        text = junit(reports)
        write_whole(options.junit, lambda path: path.write_bytes(text))
    return 0 if passed else 1


def _target(word: str) -> tuple[str, str]:
    """What a word names: (file or name, FMU or scene); OutsideError where that is nothing."""
    from ..cosim import scene_names
    from ..fmi.cached import cached_fmu
    from ..fmi.folder import find, names

    path = Path(word)
    ending = path.suffix.lower()
    if ending in (".fmu", ".py", ".ssp"):
        if not path.is_file():
            raise OutsideError(f"There is no file {word}.")
        return word, "FMU" if ending == ".fmu" else "scene"
    if word in scene_names():
        return word, "scene"
    try:
        folder = find(word)
    except CurveboundError as error:
        if path.is_dir():
            raise
        raise OutsideError(
            f"{word} is no FMU, system or scene; {nearest(word, [*scene_names(), *names()])}"
        ) from error
    return str(cached_fmu(folder)), "FMU"


def _show(console: Console, report: Report) -> None:
    from rich.table import Table
    from rich.text import Text

    verdict = Text("passed", "green") if report.passed else Text("failed", "bold red")
    console.print(Text.assemble(f"\n{report.target}: ", verdict), soft_wrap=True)
    table = Table(box=None, pad_edge=False, show_header=False)
    for _ in range(3):
        table.add_column(overflow="fold")
    for one in report.findings:
        table.add_row(
            f"  {one.check.replace('_', ' ')}", Text(one.outcome, _COLOURS[one.outcome]),
            Text(one.text),
        )  # fmt: skip
    console.print(table)

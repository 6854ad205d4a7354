"""Whether `curvebound tune` keeps its promises: fresh starts, and the cost beside the grid's."""

from __future__ import annotations

import argparse
from pathlib import Path

from rich.console import Console
from rich.table import Table

from curvebound.arguments import positive, whole
from curvebound.cosim import scene_names
from curvebound.files import sole_writer
from curvebound.study.data_files import write_json

from .promises import BOUNDS, MOST, Case, broken, verify_scene

__all__ = ["configure", "run"]

_COLUMNS = {
    "scene": 17, "bound": 5, "choice": 52, "met": 5, "worst": 8, "cost": 5, "remark": 0
}  # fmt: skip


def configure(parser: argparse.ArgumentParser) -> None:
    """Add the arguments."""
    parser.add_argument("scenes", metavar="SCENE", nargs="*", help="default: all")
    parser.add_argument(
        "--error", metavar="BOUND", type=positive, action="append", help="default: 1e-2 to 1e-9"
    )
    parser.add_argument(
        "--starts", type=whole(1), default=20, metavar="N", help="fresh starts (default: 20)"
    )
    parser.add_argument(
        "--limit", type=positive, default=5.0, metavar="S", help="CPU seconds of one run (5)"
    )
    parser.add_argument(
        "--continuous", action="store_true", help="as `curvebound tune --continuous`"
    )
    parser.add_argument("--out", type=Path, metavar="FILE.json", help="write the cases")


def run(options: argparse.Namespace) -> int:
    """Tune, judge and print; 1 where a promise is not kept."""
    with sole_writer(*([] if options.out is None else [options.out])):
        return _verified(options, Console(highlight=False))


def _verified(options: argparse.Namespace, console: Console) -> int:
    cases: list[Case] = []
    failed: list[str] = []
    with console.status("") as status:
        for name in options.scenes or scene_names():
            found = verify_scene(
                name,
                options.error or BOUNDS,
                fresh=options.starts,
                limit=options.limit,
                continuous=options.continuous,
                progress=status.update,
            )
            cases += found
            if options.out is not None:
                write_json([case.as_row() for case in cases], options.out)
            _print(found, console, heading=len(cases) == len(found))
            failed += broken(found)
    fresh = sum(case.fresh for case in cases)
    judged = sum(case.judged for case in cases)
    met = sum(case.met for case in cases)
    ratios = [case.ratio for case in cases if case.ratio is not None]
    console.print(
        f"bounds met at {met} of {judged} fresh starts ({met / max(judged, 1):.1%}), "
        f"{fresh - judged} more could not be judged; cost over the grid's best at most "
        f"{max(ratios, default=0.0):.2f}, above {MOST} in {sum(r > MOST for r in ratios)} of "
        f"{len(ratios)} cases; nothing fits in {sum(case.fresh == 0 for case in cases)} of "
        f"{len(cases)} cases",
        soft_wrap=not console.is_terminal,
    )
    for text in failed:
        console.print(f"not kept: {text}", soft_wrap=not console.is_terminal)
    return 1 if failed or not judged else 0


def _print(cases: list[Case], console: Console, *, heading: bool) -> None:
    """The rows of one scene."""
    table = Table(box=None, pad_edge=False, show_header=heading)
    for name, width in _COLUMNS.items():
        left = name in ("scene", "choice", "remark")
        table.add_column(name, justify="left" if left else "right", min_width=width)
    for case in cases:
        table.add_row(
            case.scene, f"{case.bound:.0e}", case.setting, f"{case.met}/{case.judged}",
            f"{case.worst:.2g}", "-" if case.ratio is None else f"{case.ratio:.2f}", case.remark,
        )  # fmt: skip
    console.print(table, soft_wrap=not console.is_terminal)

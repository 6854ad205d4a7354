"""Measure what every setting of a scene costs and gains: work and precision, as pages and tables.

examples:
  curvebound study bead_on_wire
  curvebound study bead_on_wire pendulum_small --quick --out build/study
  curvebound study all

JSON, and study.csv and study.json in the folder of each scene, have a row for each setting: `cpu`
in s of CPU time per simulated second, `macro_step` in s, `size` in s or as a tolerance (`size_is`),
`error` the largest of all outputs and times in their `unit`, `energy_residual` in J.
"""

from __future__ import annotations

import argparse
from pathlib import Path
from typing import Any

from ..arguments import positive
from ..output import console_of, hand_out
from ..progress import Progress

NAME = "study"
HELP = "measure error and cost of every setting of a scene"
AS_JSON = True


def configure(parser: argparse.ArgumentParser) -> None:
    """Add the arguments."""
    parser.add_argument(
        "scenes", metavar="SCENE", nargs="+", help="a .py or .ssp file, a scene's name, or all"
    )
    parser.add_argument(
        "--out",
        type=Path,
        default=Path("build/study"),
        metavar="DIR",
        help="folder; each scene gets its own in it (default: build/study)",
    )
    parser.add_argument("--quick", action="store_true", help="a thinner grid")
    parser.add_argument(
        "--output",
        action="append",
        metavar="COMPONENT.VARIABLE",
        help="judge by this output (default: those that the scene needs); may be repeated",
    )
    parser.add_argument(
        "--limit",
        type=positive,
        default=2.0,
        metavar="S",
        help="CPU seconds of one run (default: 2)",
    )
    parser.add_argument("--no-plots", action="store_true", help="tables and page only")
    parser.add_argument("--restart", action="store_true", help="forget an interrupted study")


def run(options: argparse.Namespace) -> int:
    """Run or resume; exit status 1 when it was interrupted."""
    from ..cosim import load_scene, scene_names
    from ..files import inside, remove, sole_writer
    from ..study.extras import require
    from ..study.precision.report import write_overview, write_study
    from ..study.precision.study import Study

    require("study")
    if not options.no_plots:
        require("plots")
    console = console_of(options)
    data = []
    names = scene_names() if options.scenes == ["all"] else options.scenes
    for name in names:
        scene = load_scene(name)
        study = Study.of(scene, quick=options.quick, limit=options.limit, outputs=options.output)
        folder = inside(options.out, scene.name)
        with sole_writer(folder, folder=True):
            journal = folder / "study.jsonl"
            if options.restart:
                remove(journal)
            interrupted = False
            with Progress(f"study of {scene.name}", unit="settings") as tell:
                try:
                    study.run(journal, tell)
                except KeyboardInterrupt:
                    interrupted = True
            page = write_study(study, folder, plots=not options.no_plots)
        if interrupted:
            console.print(
                f"{scene.name}: stopped after {len(study.rows)} settings, which are kept: {page}. "
                "The same command goes on from there."
            )
            return 1
        _print(console, study, page)
        data.append(_as_data(study, page))
    with sole_writer(options.out / "index.html", wait=True):  # the last one sees all studies
        overview = write_overview(options.out, plots=not options.no_plots)
    if overview is not None:
        page, sentences = overview
        console.print("\nOver all studies so far:")
        for text in sentences:
            console.print(f"- {text}", soft_wrap=not console.is_terminal)
        console.print(str(page), soft_wrap=True)
    hand_out(options, data)
    return 0


def _as_data(study: Any, page: Path) -> dict[str, Any]:
    from ..study.precision.lessons import crossings, lessons

    return {
        "scene": study.scene.name,
        "page": str(page),
        "unit": study.unit,
        "cheapest": [{"error": level, "setting": row} for level, row in crossings(study.rows)],
        "lessons": lessons(study.rows, study.unit),
        "references": study.references,
    }


def _print(console: Any, study: Any, page: Path) -> None:
    from rich.table import Table

    from ..numbers import plain, quantity
    from ..study.precision.lessons import crossings, lessons, name_of, size_of, spread_of
    from ..units import labelled

    table = Table(box=None, pad_edge=False, title=f"\n{study.scene.name}", title_justify="left")
    error = labelled("error", study.unit)
    for heading in (error, "cheapest setting", "macro step", "CPU time per s"):
        table.add_column(heading, justify="left" if "setting" in heading else "right")
    for level, row in crossings(study.rows):
        if row is None:
            table.add_row(plain(level), "none", "", "")
            continue
        words = f"{name_of(row)}, {size_of(row)}" if size_of(row) else name_of(row)
        table.add_row(plain(level), words, quantity(row["macro_step"], "s"), spread_of(row))
    console.print(table)
    for text in lessons(study.rows, study.unit):
        console.print(f"- {text}", soft_wrap=not console.is_terminal)
    for reference in study.references:
        doubt = max(reference["uncertainty"].values())
        console.print(
            f"reference ({reference['what']}): {reference['how']}; uncertainty {plain(doubt, 2)}",
            style="dim", soft_wrap=not console.is_terminal,
        )  # fmt: skip
    console.print(str(page), soft_wrap=True)

"""The linear model of a system about a state: A, B, C, D with names and units.

examples:
  curvebound linearize MySystem --input wire.ax --output rod.tension
  curvebound linearize systems/my_system --set rod.angle=3.1 --equilibrium --out model.npz
"""

from __future__ import annotations

import argparse
from pathlib import Path

from ..output import console_of

NAME = "linearize"
HELP = "the linear model of a system about a state, for control design"


def configure(parser: argparse.ArgumentParser) -> None:
    """Add the arguments."""
    from ..arguments import setting

    parser.add_argument("system", metavar="SYSTEM", help="name or folder of a system")
    parser.add_argument(
        "--set",
        type=setting,
        action="append",
        default=[],
        metavar="NAME=VALUE",
        help="a coordinate, rate, parameter or input of the state (default: as declared)",
    )
    parser.add_argument("--input", action="append", metavar="NAME", help="(default: all)")
    parser.add_argument(
        "--output", action="append", metavar="NAME", help="(default: the coordinates)"
    )
    parser.add_argument(
        "--equilibrium", action="store_true", help="about the state of rest next to this one"
    )
    parser.add_argument("--out", type=Path, metavar="FILE", help="write FILE.npz or FILE.json")


def run(options: argparse.Namespace) -> int:
    """Print the matrices, and write them."""
    from rich.table import Table

    from ..study.linear_model import linearize

    model = linearize(
        options.system,
        dict(options.set),
        options.input,
        options.output,
        equilibrium=options.equilibrium,
    )
    console = console_of(options)
    for title, matrix, rows, columns in (
        ("A", model.A, model.states, model.states),
        ("B", model.B, model.states, model.inputs),
        ("C", model.C, model.outputs, model.states),
        ("D", model.D, model.outputs, model.inputs),
    ):
        if matrix.size:
            table = Table("", *columns, title=title, title_justify="left", box=None)
            for name, row in zip(rows, matrix, strict=True):
                table.add_row(f"{name} ({model.units[name]})", *(f"{x:.6g}" for x in row))
            console.print(table)
    if options.out:
        model.write(options.out)
        console.print(str(options.out))
    return 0

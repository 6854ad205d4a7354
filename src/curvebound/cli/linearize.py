"""The linear model of a system about a state: A, B, C, D with names and units.

examples:
  curvebound linearize MySystem --input wire.ax --output rod.tension
  curvebound linearize systems/my_system --set rod.angle=3.1 --equilibrium --out model.npz

--json: A, B, C, D, states, inputs, outputs, their units by name, x0, u0, y0 and rest, x' at x0.
"""

from __future__ import annotations

import argparse
from typing import TYPE_CHECKING

from ..output import aligned, hand_out, say

if TYPE_CHECKING:
    from ..study.linear_model import LinearModel

NAME = "linearize"
HELP = "the linear model of a system about a state, for control design"
AS_JSON = True
#: largest rate, in its unit, of a state that rests
_REST = 1e-12
#: what is left of zero by the digits in which the equations are differentiated is far below
_ZERO = 1e-30


def configure(parser: argparse.ArgumentParser) -> None:
    """Add the arguments."""
    from ..arguments import file_of, setting

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
    parser.add_argument(
        "--out", type=file_of(".npz", ".json"), metavar="FILE", help="write FILE.npz or FILE.json"
    )


def run(options: argparse.Namespace) -> int:
    """Print the state and the matrices, and write them."""
    from ..study.linear_model import linearize

    model = linearize(
        options.system,
        dict(options.set),
        options.input,
        options.output,
        equilibrium=options.equilibrium,
    )
    say(options, _text(model))
    if options.out:
        model.write(options.out)
        say(options, str(options.out))
    hand_out(options, model.data())
    return 0


def _text(model: LinearModel) -> str:
    """Names, values and units first, then the matrices by number: so that no column is cut."""
    kinds = (
        ("x", "states", model.states, model.x0),
        ("u", "inputs", model.inputs, model.u0),
        ("y", "outputs", model.outputs, model.y0),
    )
    parts = ["x' = A (x - x0) + B (u - u0), y = y0 + C (x - x0) + D (u - u0)"]
    for letter, title, names, values in kinds:
        rows = [
            (f"  {letter}{i}", name, _shown(value), model.units[name])
            for i, (name, value) in enumerate(zip(names, values, strict=True), 1)
        ]
        if rows:
            parts.append(f"{title} {letter}, at {letter}0\n{aligned(rows, left=2)}")
    moving = [
        f"{name}' = {rate:.3g}"
        for name, rate in zip(model.states, model.rest, strict=True)
        if not abs(rate) <= _REST
    ]
    if moving:
        parts.append(f"x0 is no equilibrium, --equilibrium looks for one: {', '.join(moving)}")
    for title, matrix, row, column in (
        ("A", model.A, "x", "x"),
        ("B", model.B, "x", "u"),
        ("C", model.C, "y", "x"),
        ("D", model.D, "y", "u"),
    ):
        if matrix.size:
            head = ["  ", *(f"{column}{j}" for j in range(1, matrix.shape[1] + 1))]
            body = [[f"  {row}{i}", *map(_shown, line)] for i, line in enumerate(matrix, 1)]
            parts.append(f"{title}\n{aligned([head, *body])}")
    return "\n\n".join(parts)


def _shown(value: float) -> str:
    return "0" if abs(value) <= _ZERO else f"{value:.6g}"

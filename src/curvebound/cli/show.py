"""Show what a scene, an FMU or a variable is, before it is run.

A scene: components with the start values that it sets, connections, inputs, variants, needs. An FMU
(one of ours by name, or any file): its variables. A variable: everything declared of it, with the
numbers of an enumeration's items, which other tools ask for.

examples:
  curvebound show inverted_balance
  curvebound show ParabolaDrive
  curvebound show others/Plant.fmu
  curvebound show solver.method
"""

from __future__ import annotations

import argparse
from pathlib import Path
from typing import TYPE_CHECKING

from ..errors import CurveboundError

if TYPE_CHECKING:
    from rich.console import Console
    from rich.table import Table

    from ..cosim.fmu import Fmu, Variable
    from ..cosim.scene import Scene

NAME = "show"
HELP = "what a scene, an FMU or a variable is"


def configure(parser: argparse.ArgumentParser) -> None:
    """Add the arguments."""
    parser.add_argument(
        "name", metavar="NAME", help="a scene, an FMU (by name or file), or a variable"
    )


def run(options: argparse.Namespace) -> int:
    """Find out what NAME is and print it."""
    from rich.console import Console

    from ..cosim import load_scene, scene_names
    from ..cosim.fmu import nearest, read_fmu
    from ..fmi.folder import names

    console = Console(highlight=False)
    name: str = options.name
    kind = Path(name).suffix.lower()
    if kind == ".fmu":
        show_fmu(console, read_fmu(Path(name)))
    elif name in names():
        show_fmu(console, _ours(name))
    elif kind in (".py", ".ssp") or name in scene_names():
        _show_scene(console, load_scene(name))
    else:
        owners = {of: _ours(of) for of in names()}
        found = {of: fmu.variables[name] for of, fmu in owners.items() if name in fmu.variables}
        if not found:
            known = [*scene_names(), *owners, *(v for f in owners.values() for v in f.variables)]
            raise CurveboundError(
                f"{name} is neither a scene nor one of our FMUs nor a variable of one; "
                + nearest(name, dict.fromkeys(known))
            )
        for of, variable in found.items():
            _show_variable(console, of, variable)
    return 0


def _ours(name: str) -> Fmu:
    from ..cosim.fmu import read_fmu
    from ..fmi.cached import cached_fmu
    from ..fmi.folder import find

    return read_fmu(cached_fmu(find(name)))


def _table(title: str, *headings: str) -> Table:
    from rich.table import Table

    table = Table(title=f"\n{title}", title_justify="left", box=None, pad_edge=False)
    for heading in headings:
        table.add_column(heading, overflow="fold")
    return table


def show_fmu(console: Console, fmu: Fmu) -> None:
    """Print the variables of an FMU, ours or any."""
    from rich.markup import escape

    title = escape(f"{fmu.model_name}: {fmu.description}")
    table = _table(title, "variable", "kind", "unit", "start", "meaning")
    for variable in fmu.variables.values():
        table.add_row(
            *map(
                escape,
                (
                    variable.name,
                    _kind(variable),
                    variable.unit or "",
                    _start(variable),
                    variable.description,
                ),
            )
        )
    console.print(table)


def _show_variable(console: Console, owner: str, variable: Variable) -> None:
    from rich.markup import escape

    console.print(f"\n{owner} {variable.name}: {variable.description}", markup=False)
    table = _table("", "", "")
    table.title = None
    table.show_header = False
    low, high = variable.minimum or "-inf", variable.maximum or "inf"
    rows = {
        "kind": _kind(variable),
        "changes": "while running" if variable.is_drivable else "",
        "unit": variable.unit or "",
        "start": _start(variable),
        "range": "" if (low, high) == ("-inf", "inf") else f"{low} to {high}",
    }
    for label, text in rows.items():
        if text:
            table.add_row(f"  {label}", escape(text))
    for item, number in (variable.items or {}).items():
        table.add_row(f"  {number}", escape(item))
    console.print(table)


def _kind(variable: Variable) -> str:
    tunable = "tunable " if variable.is_drivable and variable.causality != "input" else ""
    form = "enumeration" if variable.items else variable.kind.lower()
    return f"{tunable}{variable.causality}" + ("" if form == "real" else f", {form}")


def _start(variable: Variable) -> str:
    if variable.start is None or not variable.is_settable_start:
        return ""
    for item, number in (variable.items or {}).items():
        if variable.start == str(number):
            return item
    return f"{float(variable.start):g}" if variable.kind == "Real" else variable.start


def _show_scene(console: Console, scene: Scene) -> None:
    from rich.markup import escape

    console.print(f"{scene.name}: {scene.description}", markup=False)
    macro = "adaptive macro steps" if scene.adaptive else f"macro steps of {scene.step:g} s"
    algorithm = f", {scene.algorithm}" if len(scene.components) > 1 else ""
    span = f"{scene.start_time:g} to {scene.stop_time:g} s"
    console.print(f"{span} in {macro}{algorithm}", markup=False)
    table = _table("components", "name", "FMU", "start values that differ from the FMU's")
    for component in scene.components.values():
        starts = ", ".join(f"{k} = {_number(v)}" for k, v in component.start.items())
        table.add_row(*map(escape, (component.name, str(component.source), starts)))
    console.print(table)
    system = scene.check()
    if system.links:
        table = _table("connections", "output", "input", "factor", "offset")
        for link in system.links:
            changed = link.factor != 1.0 or link.offset != 0.0
            scale = (f"{link.factor:g}", f"{link.offset:g}") if changed else ("", "")
            table.add_row(*map(escape, (".".join(link.source), ".".join(link.target), *scale)))
        console.print(table)
    rows = {
        "inputs from the scene": {
            path: "constant" if isinstance(value, int | float) else "varies with time"
            for path, value in scene.inputs.items()
        },
        "variants": {
            name: ", ".join(f"{k} = {_number(v)}" for k, v in values.items())
            for name, values in scene.variants.items()
        },
        "needs": {path: f"error below {bound:g}" for path, bound in scene.needs.errors.items()},
    }
    for title, entries in rows.items():
        if entries:
            table = _table(title, "name", "")
            for name, text in entries.items():
                table.add_row(escape(name), escape(text))
            console.print(table)


def _number(value: object) -> str:
    return f"{value:.6g}" if isinstance(value, float) else str(value)

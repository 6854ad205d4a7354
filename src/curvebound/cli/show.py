"""Show what a scene, an FMU or a variable is, before it is run.

A scene: components with the start values that it sets, connections, inputs, variants, needs. An FMU
(one of ours by name, or any file): its variables. A variable: everything declared of it, with the
numbers of an enumeration's items, which other tools ask for.

examples:
  curvebound show inverted_balance
  curvebound show ParabolaDrive --json
  curvebound show others/Plant.fmu
  curvebound show solver.method
"""

from __future__ import annotations

import argparse
from pathlib import Path
from typing import TYPE_CHECKING, Any

from ..errors import CurveboundError, nearest
from ..numbers import quantity
from ..output import console_of, hand_out

if TYPE_CHECKING:
    from rich.console import Console
    from rich.table import Table

    from ..cosim.fmu import Fmu, Variable
    from ..cosim.scene import Scene

NAME = "show"
HELP = "what a scene, an FMU or a variable is"
AS_JSON = True

Data = dict[str, Any]


def configure(parser: argparse.ArgumentParser) -> None:
    """Add the arguments."""
    parser.add_argument(
        "name", metavar="NAME", help="a scene, an FMU (by name or file), or a variable"
    )


def run(options: argparse.Namespace) -> int:
    """Find out what NAME is and print it."""
    data = _found(options.name)
    hand_out(options, data)
    if options.json:
        return 0
    console = console_of(options)
    if "variables" in data:
        show_fmu(console, data)
    elif "components" in data:
        _show_scene(console, data)
    else:
        for one in data["found"]:
            _show_variable(console, one)
    return 0


def _found(name: str) -> Data:
    """What NAME is, as data."""
    from ..cosim import load_scene, scene_names
    from ..cosim.fmu import read_fmu
    from ..fmi.folder import names

    kind = Path(name).suffix.lower()
    if kind == ".fmu":
        return fmu_data(read_fmu(Path(name)))
    if name in names():
        return fmu_data(_ours(name))
    if kind in (".py", ".ssp") or name in scene_names():
        return _scene_data(load_scene(name))
    owners = {of: _ours(of) for of in names()}
    found = {of: fmu.variables[name] for of, fmu in owners.items() if name in fmu.variables}
    if not found:
        known = [*scene_names(), *owners, *(v for f in owners.values() for v in f.variables)]
        raise CurveboundError(
            f"{name} is neither a scene nor one of our FMUs nor a variable of one; "
            + nearest(name, dict.fromkeys(known))
        )
    return {"found": [{"fmu": of, **_variable_data(v)} for of, v in found.items()]}


def _ours(name: str) -> Fmu:
    from ..cosim.fmu import read_fmu
    from ..fmi.cached import cached_fmu
    from ..fmi.folder import find

    return read_fmu(cached_fmu(find(name)))


# as data


def fmu_data(fmu: Fmu) -> Data:
    """What an FMU is, ours or any."""
    return {
        "name": fmu.model_name,
        "description": fmu.description,
        "start_time": fmu.start_time,
        "stop_time": fmu.stop_time,
        "step": fmu.step,
        "tolerance": fmu.tolerance,
        "variables": [_variable_data(variable) for variable in fmu.variables.values()],
    }


def _variable_data(variable: Variable) -> Data:
    def number(text: str | None) -> float | None:
        return None if text is None else float(text)

    numeric = variable.kind in ("Real", "Integer")
    return {
        "name": variable.name,
        "description": variable.description,
        "type": "Enumeration" if variable.items else variable.kind,
        "causality": variable.causality,
        "variability": variable.variability,
        "unit": variable.unit,
        "start": _start(variable),
        "min": number(variable.minimum) if numeric and not variable.items else None,
        "max": number(variable.maximum) if numeric and not variable.items else None,
        "items": variable.items,
    }


def _start(variable: Variable) -> float | str | None:
    if variable.start is None or not variable.is_settable_start:
        return None
    for item, number in (variable.items or {}).items():
        if variable.start == str(number):
            return item
    return float(variable.start) if variable.kind == "Real" else variable.start


def _scene_data(scene: Scene) -> Data:
    from ..cosim.system import port_of

    system = scene.check()
    return {
        "name": scene.name,
        "description": scene.description,
        "start_time": scene.start_time,
        "stop_time": scene.stop_time,
        "step": scene.step,
        "adaptive": scene.adaptive is not None,
        "algorithm": scene.algorithm,
        "components": [
            {"name": c.name, "fmu": str(c.source), "start": c.start}
            for c in scene.components.values()
        ],
        "connections": [
            {
                "output": ".".join(link.source),
                "input": ".".join(link.target),
                "factor": link.factor,
                "offset": link.offset,
            }
            for link in system.links
        ],
        "inputs": {
            path: value if isinstance(value, int | float) else None
            for path, value in scene.inputs.items()
        },
        "variants": scene.variants,
        "needs": scene.needs.errors,
        "units": {
            path: system.variable(port_of(path)).unit or "1"
            for path in (*scene.inputs, *scene.needs.errors)
        },
    }


# as tables


def titled(title: str, *headings: str) -> Table:
    """A table without lines."""
    from rich.table import Table

    table = Table(title=title and f"\n{title}", title_justify="left", box=None, pad_edge=False)
    for i, heading in enumerate(headings):
        # names, in the first, stay whole, to be copied and searched for
        table.add_column(heading, overflow="fold", no_wrap=i == 0)
    table.show_header = any(headings)
    return table


def add(table: Table, *words: object) -> None:
    """A row of words that are taken as they stand."""
    from rich.markup import escape

    table.add_row(*(escape("" if word is None else _word(word)) for word in words))


def _word(value: object) -> str:
    return f"{value:.6g}" if isinstance(value, float) else str(value)


def show_fmu(console: Console, data: Data) -> None:
    """Print the variables of an FMU, from fmu_data."""
    from rich.markup import escape

    title = escape(f"{data['name']}: {data['description']}")
    table = titled(title, "variable", "kind", "unit", "start", "meaning")
    for one in data["variables"]:
        add(table, one["name"], _kind(one), one["unit"], one["start"], one["description"])
    console.print(table)


def _kind(one: Data) -> str:
    tunable = "tunable " if (one["causality"], one["variability"]) == _TUNABLE else ""
    form = "" if one["type"] == "Real" else f", {one['type'].lower()}"
    return f"{tunable}{one['causality']}{form}"


_TUNABLE = ("parameter", "tunable")


def _show_variable(console: Console, one: Data) -> None:
    console.print(f"\n{one['fmu']} {one['name']}: {one['description']}", markup=False)
    table = titled("", "", "")
    moves = one["causality"] == "input" or (one["causality"], one["variability"]) == _TUNABLE
    add(table, "  kind", _kind(one))
    if moves:
        add(table, "  changes", "while running")
    for label in ("unit", "start"):
        if one[label] is not None:
            add(table, f"  {label}", one[label])
    low, high = one["min"], one["max"]
    if low is not None or high is not None:
        low, high = "-inf" if low is None else low, "inf" if high is None else high
        add(table, "  range", f"{_word(low)} to {_word(high)}")
    for item, number in (one["items"] or {}).items():
        add(table, f"  {number}", item)
    console.print(table)


def _show_scene(console: Console, data: Data) -> None:
    console.print(f"{data['name']}: {data['description']}", markup=False)
    macro = "adaptive macro steps" if data["adaptive"] else f"macro steps of {data['step']:g} s"
    algorithm = f", {data['algorithm']}" if len(data["components"]) > 1 else ""
    span = f"{data['start_time']:g} to {data['stop_time']:g} s"
    console.print(f"{span} in {macro}{algorithm}", markup=False)
    table = titled("components", "name", "FMU", "start values that differ from the FMU's")
    for one in data["components"]:
        starts = ", ".join(f"{name} = {_word(value)}" for name, value in one["start"].items())
        add(table, one["name"], one["fmu"], starts)
    console.print(table)
    if data["connections"]:
        table = titled("connections", "output", "input", "factor", "offset")
        for one in data["connections"]:
            plain = (one["factor"], one["offset"]) == (1.0, 0.0)
            scale = (None, None) if plain else (one["factor"], one["offset"])
            add(table, one["output"], one["input"], *scale)
        console.print(table)
    tables = {
        "inputs from the scene": {
            path: "varies with time" if value is None else value
            for path, value in data["inputs"].items()
        },
        "variants": {
            name: ", ".join(f"{k} = {_word(v)}" for k, v in values.items())
            for name, values in data["variants"].items()
        },
        "needs": {
            path: f"error below {quantity(bound, data['units'][path])}"
            for path, bound in data["needs"].items()
        },
    }
    for title, entries in tables.items():
        if entries:
            table = titled(title, "name", "")
            for name, text in entries.items():
                add(table, name, text)
            console.print(table)

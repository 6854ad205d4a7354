"""References kept on disk: what was computed once need not be computed again.

A reference is kept under all that it depends on: the scene's parameters, links and signals, the
starts, the statements of the systems, and the source code that computes it. Of the FMUs nothing but
those statements is part of it: a reference does not use them, and holds for every build of them.
"""

from __future__ import annotations

import ast
from collections.abc import Callable, Mapping, Sequence
from functools import lru_cache
from importlib.metadata import version
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from ... import cache
from ..identity import described
from .equations import Array, stated_in
from .monolith import Monolith, Value

if TYPE_CHECKING:
    from ...cosim.system import System

__all__ = ["kept", "question"]

_FILE = "reference.npz"


def question(
    system: System,
    paths: Sequence[str],
    stop: float,
    changes: Mapping[str, Value] | None,
    continuous: bool,
) -> list[str]:
    """All that a reference depends on, as parts of an entry of the cache; arguments of `refer`."""
    scene = system.scene
    parts: list[object] = [_code(), *(f"{name} {version(name)}" for name in ("numpy", "mpmath"))]
    parts += [str(np.finfo(np.longdouble)), scene.start_time, stop, scene.step, continuous]
    for name, node in system.nodes.items():
        parts += [f"{name} {node.fmu.model_name}", *stated_in(node.fmu).values()]
    parts += [
        f"{name} {variable.name} {node.start.get(variable.name, variable.start)}"
        for name, node in system.nodes.items()
        for variable in sorted(node.fmu.variables.values(), key=lambda v: v.name)
        if not variable.name.startswith("solver.")  # how an FMU solves the equations
    ]
    parts += sorted(str(link) for link in system.links)
    for path, value in sorted((changes or {}).items()):
        parts += [path, value if isinstance(value, str) else [*map(repr, np.ravel(value))]]
    for port, function in system.signals.items():
        parts += [port, described(function)]
    events = list(Monolith(system, changes, continuous=continuous).events(stop))
    return [*map(str, parts), *paths, *map(repr, events)]


@lru_cache(maxsize=1)
def _code() -> str:
    """Hash of the sources that a reference is computed by: `refer`'s, and all that they import.

    Co-simulation gives numbers only, and those are part of the question.
    """
    found: set[Path] = set()
    new = {Path(__file__).with_name("reference.py")}
    while new:
        file = new.pop()
        found.add(file)
        for node in ast.walk(ast.parse(file.read_bytes())):
            if isinstance(node, ast.ImportFrom) and node.level and node.module:
                path = file.parents[node.level - 1] / node.module.replace(".", "/")
                files = {path.with_suffix(".py"), *path.glob("*.py")}  # a module, or a package
                new |= {f for f in files - found if f.is_file() and f.parent.name != "cosim"}
    return cache.sources(*sorted(found))


def kept(
    parts: Sequence[str], monolith: Monolith, compute: Callable[[], Mapping[str, Array]]
) -> dict[str, Any]:
    """The arrays that `compute` gives for this question, from the cache if they are there.

    What was held over each step is kept with them, and given to the monolith.
    """

    def make(folder: Path) -> None:
        arrays = dict(compute())
        history = monolith.history
        ports = list(history[0][1]) if history else []
        shape = (monolith.members,)
        held = np.array(
            [[np.broadcast_to(values[port], shape) for port in ports] for _, values in history],
            dtype=np.longdouble,
        )
        arrays["ports"] = np.array([" ".join(port) for port in ports], dtype=str)
        arrays["held_at"] = np.array([t for t, _ in history])
        np.savez(folder / _FILE, **arrays, held=held)  # type: ignore[arg-type]

    with np.load(cache.entry("references", parts, make) / _FILE) as file:
        data = {name: file[name] for name in file.files}
    monolith.history = [
        (float(t), {_port(p): values[i] for i, p in enumerate(data["ports"])})
        for t, values in zip(data["held_at"], data["held"], strict=True)
    ]
    return data


def _port(text: Any) -> tuple[str, str]:
    name, _, variable = str(text).partition(" ")
    return name, variable

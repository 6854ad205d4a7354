"""A scene as the text of a Python file, which `load_scene` reads."""

from __future__ import annotations

import math
from pathlib import Path
from typing import Any

from ..errors import CurveboundError
from ..fmi.folder import find, names
from .scene_data import SceneData
from .scene_parts import Component, Needs

__all__ = ["scene_text"]


def scene_text(scene: SceneData) -> str:
    """The file of a scene whose macro step is fixed and whose inputs are numbers, tables or files.

    FMUs and systems that do not come with the package are named by their full paths. Raises
    CurveboundError for an input that is a function.
    """
    lines = [
        f'"""{_plain(scene.description or scene.name)}"""',
        "",
        "from curvebound.cosim import Needs, Scene",
        "",
        "scene = Scene(",
        *(f"    {text}," for text in _settings(scene)),
        ")",
    ]
    for component in scene.components.values():
        lines += _component(component, scene.folder)
    for one in scene.connections:
        more = [repr(one.source), repr(one.target), repr(one.factor), repr(one.offset)]
        if one.mapping:
            more.append(repr(dict(one.mapping)))
        lines.append(f"scene.connect({', '.join(more)})")
    lines += [f"scene.connect_matching({a!r}, {b!r})" for a, b in scene.matches]
    for path, given in scene.inputs.items():
        if callable(given):
            raise CurveboundError(f"The input {path} is a function, which no file can hold.")
        lines.append(f"scene.input({path!r}, {_value(given)})")
    lines += [f"scene.record({path!r})" for path in scene.recorded]
    for name, values in scene.variants.items():
        lines.append(f"scene.variant({name!r}, {values!r})")
    return "\n".join([*lines, "", 'if __name__ == "__main__":', "    scene.main()", ""])


def _settings(scene: SceneData) -> list[str]:
    own = [repr(scene.name), repr(scene.description)]
    for name in ("start_time", "stop_time", "step", "algorithm", "hold", "order", "groups",
                 "loop_tolerance", "tolerance", "record_every"):  # fmt: skip
        own.append(f"{name}={getattr(scene, name)!r}")
    if scene.needs != Needs():
        own.append(f"needs={scene.needs!r}")
    return own


def _component(component: Component, folder: Path | None) -> list[str]:
    source = repr(_source(component.source, folder))
    lines = ["scene.add(", f"    {component.name!r},", f"    {source},", "    {"]
    lines += [f"        {name!r}: {_value(value)}," for name, value in component.start.items()]
    return [*lines, "    },", f"    feedthrough={component.feedthrough!r},", ")"]


def _source(source: str | Path, folder: Path | None) -> str:
    if source in names():
        return str(source)
    if Path(source).suffix.lower() == ".fmu":
        return str(((folder or Path.cwd()) / source).resolve())
    return str(find(source, folder).path)


def _value(value: Any) -> str:
    """A literal; numbers that are none have no literal."""
    if isinstance(value, float) and not math.isfinite(value):
        return f'float("{value}")'
    return repr(str(value) if isinstance(value, Path) else value)


def _plain(text: str) -> str:
    """As the text of a docstring."""
    return text.replace("\\", "\\\\").replace('"', "'")

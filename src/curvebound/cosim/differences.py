"""In which settings scenes differ, for those who see their results side by side."""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

from ..numbers import quantity
from .capabilities import located
from .fmu import Value, Variable, read_fmu
from .scene_data import SceneData
from .system import port_of

__all__ = ["Difference", "differences", "own_label"]

_OWN = {"step": "s", "algorithm": "", "stop_time": "s"}


class Difference(NamedTuple):
    """A setting and its value in each scene; enumerations by their items."""

    path: str
    unit: str
    values: tuple[Value, ...]


def differences(scenes: Sequence[SceneData]) -> list[Difference]:
    """The start values, held inputs and settings in which scenes of the same FMUs differ."""
    given = [_settings(scene) for scene in scenes]
    found = []
    for path in dict.fromkeys(path for one in given for path in one):
        variable = _variable(scenes[0], path)
        values = tuple(_value(variable, one.get(path)) for one in given)
        if len(set(values)) > 1:
            unit = _OWN.get(path, "") if variable is None else variable.unit or ""
            found.append(Difference(path, unit, values))
    return found


def own_label(found: Sequence[Difference], number: int) -> str:
    """What a scene is called after its own settings, where it differs in one or two; or ''.

    Components that differ alike count once.
    """
    words: dict[str, None] = {}
    for path, unit, values in found:
        value = values[number]
        text = str(value) if isinstance(value, str | bool) else quantity(value, unit)
        words[f"{path.split('.')[-1]} {text}"] = None
    return ", ".join(words) if len(words) <= 2 else ""


def _settings(scene: SceneData) -> dict[str, Value]:
    own: dict[str, Value] = {name: getattr(scene, name) for name in _OWN}
    for component in scene.components.values():
        own |= {f"{component.name}.{name}": value for name, value in component.start.items()}
    numbers = {
        path: given for path, given in scene.inputs.items() if isinstance(given, float | int)
    }
    return {**own, **numbers}


def _variable(scene: SceneData, path: str) -> Variable | None:
    name, variable = port_of(path)
    component = scene.components.get(name)
    if component is None:
        return None
    return read_fmu(located(component.source, scene.folder)).variables.get(variable)


def _value(variable: Variable | None, given: Value | None) -> Value:
    if variable is None:
        return "" if given is None else given
    if given is None:
        given = variable.start if variable.start is not None else 0.0
    value = variable.value(given)
    if variable.items is not None:
        return next((item for item, number in variable.items.items() if number == value), value)
    return value

"""What our annotation says of a scene beyond SSP: written, and read only in that shape."""

from __future__ import annotations

import json
from dataclasses import asdict
from typing import Any

from .scene_data import SceneData
from .scene_parts import Adaptive, Needs

__all__ = ["read_settings", "write_settings"]

_NUMBER = (int, float)
_VALUE = (int, float, bool, str)
_MAYBE = (int, float, None)

#: name -> shape: types, [shape of every entry], {str: shape of every value} or {name: shape}
_SHAPE: dict[str, Any] = {
    "algorithm": (str,),
    "hold": (str,),
    "step": _NUMBER,
    "record_every": (int,),
    "order": [(str,)],
    "groups": [[(str,)]],
    "loop_tolerance": _NUMBER,
    "tolerance": _NUMBER,
    "variants": {str: {str: _VALUE}},
    "needs": {"errors": {str: _NUMBER}, "budget": _MAYBE, "frame_rate": _MAYBE},
    "adaptive": {
        "tolerance": _NUMBER,
        "scales": {str: _NUMBER},
        "smallest": _MAYBE,
        "largest": _MAYBE,
    },
    "feedthrough": {str: (bool, {str: [(str,)]})},
}


def write_settings(scene: SceneData) -> str:
    """The text of the annotation."""
    settings: dict[str, Any] = {
        "algorithm": scene.algorithm,
        "step": scene.step,
        "record_every": scene.record_every,
        "needs": asdict(scene.needs),
    }
    if scene.hold != "zero":
        settings["hold"] = scene.hold
    if scene.variants:
        settings["variants"] = scene.variants
    for name in ("order", "groups", "loop_tolerance", "tolerance"):
        value = getattr(scene, name)
        if value is not None:
            settings[name] = value
    if scene.adaptive is not None:
        settings["adaptive"] = {**vars(scene.adaptive), "scales": dict(scene.adaptive.scales)}
    feedthrough = {
        component.name: component.feedthrough
        if isinstance(component.feedthrough, bool)
        else {output: list(inputs) for output, inputs in component.feedthrough.items()}
        for component in scene.components.values()
        if component.feedthrough is not None
    }
    if feedthrough:
        settings["feedthrough"] = feedthrough
    return json.dumps(settings, sort_keys=True)


def read_settings(text: str) -> dict[str, Any]:
    """The settings in the text of an annotation, `adaptive` and `needs` as objects.

    Raises ValueError, which names the place, where it is no JSON or of another shape.
    """
    try:
        settings = json.loads(text or "{}")
    except ValueError as error:
        raise ValueError(f"it is no JSON: {error}") from error
    _require(settings, _SHAPE, "it")
    if len(settings.get("groups", ("", ""))) != 2:
        raise ValueError(f"groups are two, not {len(settings['groups'])}")
    for name, made in (("adaptive", Adaptive), ("needs", Needs)):
        if name in settings:
            settings[name] = made(**settings[name])
    return dict(settings)


def _require(value: Any, shape: Any, place: str) -> None:
    """Raise ValueError where `value` is not of the shape, see _SHAPE."""
    if isinstance(shape, tuple):
        plain = [one for one in shape if isinstance(one, type)]
        if isinstance(value, dict) and isinstance(shape[-1], dict):
            _require(value, shape[-1], place)
        elif not (value is None and None in shape) and type(value) not in plain:
            words = " or ".join(
                "null" if t is None else getattr(t, "__name__", "object") for t in shape
            )
            raise ValueError(f"{place} is {value!r}, not of type {words}")
    elif isinstance(shape, list):
        if not isinstance(value, list):
            raise ValueError(f"{place} is {value!r}, no list")
        for number, one in enumerate(value):
            _require(one, shape[0], f"{place}[{number}]")
    else:
        if not isinstance(value, dict):
            raise ValueError(f"{place} is {value!r}, no object")
        for name, one in value.items():
            inner = shape.get(str) or shape.get(name)
            if inner is None:
                raise ValueError(f"{place} has {name!r}; there is {', '.join(shape)}")
            _require(one, inner, f"{place}.{name}" if place != "it" else name)

"""What results depend on, as text: two that may differ anywhere read differently."""

from __future__ import annotations

import hashlib
import pickle
import uuid
from collections.abc import Mapping
from pathlib import Path
from types import CodeType, FunctionType, ModuleType
from typing import TYPE_CHECKING, Any

from .. import cache

if TYPE_CHECKING:
    from ..cosim.system import System

__all__ = ["described", "identity"]

_PACKAGE = Path(__file__).resolve().parents[1]
_SETTINGS = (
    *("start_time", "stop_time", "step", "algorithm", "hold", "tolerance", "loop_tolerance"),
    "record_every",
)


def described(value: object, above: tuple[object, ...] = ()) -> str:
    """The code of a function and all values in it, those of the functions that it calls included.

    What cannot be seen through is like nothing else, not even itself at another time.
    above: the functions and objects around, for those that know each other.
    """
    if any(value is one for one in above):
        return "above"
    inside = (*above, value)
    if isinstance(value, bool | int | float | str | bytes | type(None)):
        return repr(value)
    if isinstance(value, list | tuple):
        return f"[{' '.join(described(v, inside) for v in value)}]"
    if isinstance(value, Mapping):
        return described([pair for item in value.items() for pair in item], above)
    if isinstance(value, ModuleType):
        return value.__name__
    if isinstance(value, CodeType):
        return (
            f"{value.co_code.hex()} {' '.join(value.co_names)} {described(value.co_consts, above)}"
        )
    if isinstance(value, FunctionType):
        code = value.__code__
        held = [cell.cell_contents for cell in value.__closure__ or ()]
        held += [value.__globals__[name] for name in code.co_names if name in value.__globals__]
        held += [code, value.__defaults__, value.__kwdefaults__]
        return described(held, inside)
    try:
        call = vars(type(value)).get("__call__")
        if isinstance(call, FunctionType):
            return described([call, vars(value)], inside)
        return pickle.dumps(value).hex()
    except Exception:  # whatever a foreign object raises
        return uuid.uuid4().hex


def identity(system: System, **settings: Any) -> str:
    """A word that changes with all that results depend on: code, FMUs, scene, what was asked."""
    scene = system.scene
    parts: list[object] = [cache.sources(_PACKAGE), sorted(settings.items())]
    parts += [
        (
            name,
            node.fmu.guid,
            node.dependencies,
            node.initial_dependencies,
            sorted(node.start.items()),
        )
        for name, node in system.nodes.items()
    ]
    parts += [*map(str, system.links), scene.groups, scene.order, scene.adaptive]
    parts += [getattr(scene, name) for name in _SETTINGS]
    parts += [(port, described(function)) for port, function in system.signals.items()]
    return hashlib.sha256("\0".join(map(str, parts)).encode()).hexdigest()[:16]

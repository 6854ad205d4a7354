"""Scenes of coupled FMUs: their description, the masters that run them, SSP in and out."""

from __future__ import annotations

from importlib import import_module
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from .load import load_scene, scene_names
    from .prepared import Prepared
    from .results import Result, RunFailed, RunInterrupted
    from .scene import Scene
    from .scene_parts import Adaptive, Needs
    from .tables import read_csv, write_csv

__all__ = [
    "Adaptive",
    "Needs",
    "Prepared",
    "Result",
    "RunFailed",
    "RunInterrupted",
    "Scene",
    "load_scene",
    "read_csv",
    "scene_names",
    "write_csv",
]

_HOME = {
    "load": ("load_scene", "scene_names"),
    "prepared": ("Prepared",),
    "results": ("Result", "RunFailed", "RunInterrupted"),
    "scene": ("Scene",),
    "scene_parts": ("Adaptive", "Needs"),
    "tables": ("read_csv", "write_csv"),
}


def __getattr__(name: str) -> Any:
    """Import on first use: the command line asks for little of this, and numpy takes its time."""
    for module, names in _HOME.items():
        if name in names:
            return getattr(import_module(f".{module}", __name__), name)
    raise AttributeError(f"module {__name__!r} has no attribute {name!r}")

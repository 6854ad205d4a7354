"""Scenes of coupled FMUs: their description, the masters that run them, SSP in and out."""

from .load import load_scene, scene_names
from .results import Result, RunFailed, read_csv, write_csv
from .scene import Adaptive, Needs, Scene

__all__ = [
    "Adaptive",
    "Needs",
    "Result",
    "RunFailed",
    "Scene",
    "load_scene",
    "read_csv",
    "scene_names",
    "write_csv",
]

"""Sweeps: a scene over a grid or a sample of its parameters, on all cores or on a cluster."""

from .design import Axis, Design, axis
from .engine import Sweep, SweepResult
from .metrics import Metric

__all__ = ["Axis", "Design", "Metric", "Sweep", "SweepResult", "axis"]

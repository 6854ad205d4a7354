"""How an FMU or a scene is to be checked."""

from __future__ import annotations

from dataclasses import dataclass, field
from pathlib import Path

from ..cosim.fmu import Value

__all__ = ["Request"]


@dataclass
class Request:
    """How to check.

    start: start values by variable; stop, step: s, in place of those of the FMU's DefaultExperiment
    (1 s in 100 steps where it has none); reference, inputs: tables in place of those that it
    carries; tolerance: error allowed to the reference, relative to the largest value of that unit;
    most: largest absolute value allowed, by output.
    """

    start: dict[str, Value] = field(default_factory=dict)
    stop: float | None = None
    step: float | None = None
    reference: Path | None = None
    inputs: Path | None = None
    tolerance: float = 1e-6
    most: dict[str, float] = field(default_factory=dict)

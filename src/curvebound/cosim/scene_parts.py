"""What a scene is made of, as data: components, connections, macro steps, needs."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import NamedTuple

from .fmu import Value

__all__ = [
    "ALGORITHMS",
    "HOLDS",
    "Adaptive",
    "Algorithm",
    "Component",
    "Connection",
    "Jumping",
    "Needs",
]


class Algorithm(NamedTuple):
    """What others must know of a master algorithm.

    order: of its error in the macro step, inputs held; rolls_back: whether it takes states back.
    """

    order: int
    rolls_back: bool = False


#: the master algorithms; what a macro step of each does stands in `algorithms`
ALGORITHMS = {
    "gauss_seidel": Algorithm(1),
    "jacobi": Algorithm(1),
    "strang": Algorithm(2),
    "midpoint": Algorithm(2, rolls_back=True),
}
HOLDS = ("zero", "first")


@dataclass
class Component:
    """One FMU in a scene: `source` is the path of an FMU, or a system that is built if need be.

    A system is named by its folder's path, or by name: among those in the folder `systems` beside
    the scene, or that come with the package. Paths start at the scene's folder.
    feedthrough: None takes the dependencies that the FMU declares; False says that no output
    depends directly on an input, a mapping of output to inputs says which do.
    """

    name: str
    source: str | Path
    start: dict[str, Value]
    feedthrough: Mapping[str, Sequence[str]] | bool | None = None


@dataclass(frozen=True)
class Connection:
    """An output that drives an input: input = factor * output + offset.

    Between whole numbers (Integer, Enumeration, Boolean) `mapping` says which become others.
    """

    source: str
    target: str
    factor: float | None = None
    offset: float = 0.0
    mapping: Mapping[int, int] | None = None


@dataclass(frozen=True)
class Adaptive:
    """Macro steps chosen by the master, see curvebound.cosim.adaptive.

    tolerance: bound on the estimated error per second of every controlled output, relative to its
        scale; the error of the result is proportional to it.
    scales: size that an output's error is measured by, in its unit, by path (missing ones: the
        declared nominal, else 1). An output named here is controlled in any case.
    smallest, largest: bounds of the macro step in s (default: step / 1024, a quarter of the run).
    """

    tolerance: float = 1e-3
    scales: Mapping[str, float] = field(default_factory=dict)
    smallest: float | None = None
    largest: float | None = None


@dataclass
class Needs:
    """What a scene requires of its settings.

    errors: largest error allowed at any time, by output path, in the output's unit.
    budget: CPU seconds allowed per simulated second, or None.
    frame_rate: pictures per simulated second that the recording must allow, in Hz, or None.
    """

    errors: dict[str, float] = field(default_factory=dict)
    budget: float | None = None
    frame_rate: float | None = None


@dataclass(frozen=True)
class Jumping:
    """A function of time in s that is known to jump at the times `jumps`."""

    function: Callable[[float], float]
    jumps: Sequence[float]

    def __call__(self, time: float) -> float:
        return self.function(time)

"""What takes part in the comparison of accuracy and cost, and the contract it fulfils."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

__all__ = ["ANGLE", "CARTESIAN", "PENDULUM", "REFERENCE_OF", "Contender", "Run", "State4"]

#: state in the coordinates of the references
State4 = tuple[float, float, float, float]

#: the systems as they are integrated
ANGLE = "bead, angle"
CARTESIAN = "bead, Cartesian"
PENDULUM = "pendulum"
REFERENCE_OF = {ANGLE: "bead", CARTESIAN: "bead", PENDULUM: "pendulum"}


@dataclass(frozen=True)
class Run:
    """An integration over references.DURATION that can be repeated.

    `reset` returns to the start, `go` integrates (this alone is timed), `state` reads the result.
    """

    reset: Callable[[], object]
    go: Callable[[], object]
    state: Callable[[], State4]


@dataclass(frozen=True)
class Contender:
    """A method for a system; `prepare` makes a Run for one of its settings.

    `setting` says what the settings are: step (s) or tolerance; they go from coarse to fine.
    """

    tool: str
    method: str
    system: str
    setting: str
    settings: tuple[float, ...]
    prepare: Callable[[float], Run]

    @property
    def name(self) -> str:
        """Tool and method."""
        return f"{self.tool} {self.method}".strip()

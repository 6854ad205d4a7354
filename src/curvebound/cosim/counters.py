"""The work of a run."""

from __future__ import annotations

__all__ = ["Counters"]


class Counters:
    """Macro steps of the solution, steps computed to find it, and those taken back.

    forced: steps at their lower bound whose error was above the tolerance, `excess` times at most.
    """

    def __init__(self) -> None:
        self.steps = 0
        self.trials = 0
        self.rejected = 0
        self.forced = 0
        self.excess = 0.0

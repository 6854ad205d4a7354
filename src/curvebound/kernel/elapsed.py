"""Time within a communication step, as exact as many small steps need."""

from __future__ import annotations

__all__ = ["Elapsed"]


from typing import final


@final
class Elapsed:
    """A sum of step sizes in two parts: what rounding takes from the first is kept (Kahan 1965)."""

    def __init__(self) -> None:
        #: s since the communication point
        self.t: float = 0.0
        self.rest: float = 0.0

    def reset(self) -> None:
        """Back to the communication point."""
        self.t = 0.0
        self.rest = 0.0

    def add(self, h: float) -> None:
        """Go on by h s."""
        rest = self.rest + h
        t = self.t
        self.t = t + rest
        self.rest = (t - self.t) + rest

    def left(self, duration: float) -> float:
        """What is left of `duration`, s."""
        return (duration - self.t) - self.rest

    def finish(self, duration: float) -> None:
        """Go to the end of `duration`."""
        self.t = duration
        self.rest = 0.0

"""What the explicit methods with a given step share: counting, and the limit of steps."""

from __future__ import annotations

from .base import Model
from .method import DONE, TOO_MANY_STEPS, Method

__all__ = ["FixedStep"]


class FixedStep(Method):
    """Divides a communication step evenly; `each`: evaluations in an internal step.

    A method makes all steps of a communication step in one call, its loop written out there: a call
    for each step would cost as much as one of Euler's.
    """

    def __init__(self) -> None:
        super().__init__()
        self.each: int = 1

    def make(self, model: Model, h: float, count: int) -> None:
        """Make `count` steps of h seconds from the communication point on."""
        raise NotImplementedError

    def advance(
        self, model: Model, duration: float, count: int, tolerance: float, max_steps: int
    ) -> int:
        h = duration / count
        if count > max_steps:
            self.reached = h
            return TOO_MANY_STEPS
        self.make(model, h, count)
        self.steps += count
        self.evaluations += self.each * count
        return DONE

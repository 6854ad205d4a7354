"""The contract between a time-integration method and those who call it.

A method advances a model over one communication step of given duration and keeps its own memory
(the adaptive step size) from one to the next. It never raises for a numerical failure: it returns a
Failure code, and the caller undoes the step and words the message.
"""

from __future__ import annotations

from typing import Final

from .base import Model

__all__ = [
    "DONE",
    "NOT_CONVERGED",
    "NOT_FINITE",
    "STEP_TOO_SMALL",
    "TOO_MANY_STEPS",
    "Method",
]

DONE: Final = 0
#: max_steps internal steps, rejected ones included, did not reach the end
TOO_MANY_STEPS: Final = 1
#: the error control asks for a step below the resolution of time
STEP_TOO_SMALL: Final = 2
#: the Newton iteration did not converge, halving included
NOT_CONVERGED: Final = 3
#: state or acceleration left the finite numbers
NOT_FINITE: Final = 4


class Method:
    """Advances a model in time; one instance belongs to one model instance.

    Attributes: `steps` accepted internal steps and `evaluations` of the equations of motion since
    the start (both counted over all advance() calls), `reached` the internal step size (s) at a
    failure.
    """

    #: order of convergence; 0 stands for exact
    ORDER: int = 0
    #: whether the internal steps follow from `tolerance` or the method instead of from `count`
    CHOOSES_STEP: bool = False
    #: whether it moves a model whose inputs rise itself; others need a Ramp in its place
    MOVES: bool = False

    def __init__(self) -> None:
        self.steps: int = 0
        self.evaluations: int = 0
        self.reached: float = 0.0
        #: s of the communication step that were made before a failure, where the method knows
        self.passed: float = 0.0

    def reset(self) -> None:
        """Forget everything: before a first step."""
        self.steps = 0
        self.evaluations = 0
        self.reached = 0.0

    def advance(
        self, model: Model, duration: float, count: int, tolerance: float, max_steps: int
    ) -> int:
        """Advance `model` by `duration` s and return DONE or the kind of failure.

        Fixed-step methods make `count` steps of duration / count, or none and TOO_MANY_STEPS where
        count exceeds `max_steps`; adaptive ones honour `tolerance` and make at most `max_steps`,
        rejected ones included. After a failure the states of the model and of the method are
        undefined: the caller, who has called keep() of both, calls undo(). May let
        ZeroDivisionError, ValueError or OverflowError of the model pass: they mean NOT_FINITE.
        """
        raise NotImplementedError

    def doubt(self) -> float:
        """The largest error, relative to the rates, that rounding can have made so far; 0: unknown.

        For methods that keep to a tolerance, which is not kept where this exceeds it.
        """
        return 0.0

    def loss(self) -> float:
        """What errors of steps, relative to the rates, can have grown to so far; 0: unknown.

        In proportion to the tolerance, which is not kept where this exceeds it.
        """
        return 0.0

    def get_state(self) -> list[float]:
        """What the method carries from step to step, counters excepted."""
        return []

    def set_state(self, state: list[float]) -> None:
        """Return to what get_state() gave."""

    def keep(self) -> None:
        """Remember what get_state() would give, cheaply, for one undo()."""

    def undo(self) -> None:
        """Return to what keep() remembered, counters excepted."""

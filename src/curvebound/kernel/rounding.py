"""What the rounding of the state makes of the accelerations: no step can resolve less.

A coordinate q is known to half a unit in its last place, about 1e-16 q, and an acceleration thus
to that times its slope d(acceleration)/dq, however short the step; likewise for the rates. Forces
that cancel, at a rest for instance, have just such slopes.
"""

from __future__ import annotations

import math
from typing import Final

from .base import Model

__all__ = ["NEGLIGIBLE", "Rounding"]

EPSILON: Final = 2.220446049250313e-16
#: a rate that moves its coordinate by less than this part of its size counts as none
NEGLIGIBLE: Final = 1e-30
#: accelerations that are compared
PROBES: Final = 4
#: how far others may scatter beyond those
TIMES: Final = 4.0
#: four units in the last place: so far the values at the points of a step scatter
SPREAD: Final = 8.9e-16


class Rounding:
    """Sizes of the rounding of both accelerations, and of the coordinates so far.

    What is left of a coordinate that had a size is known to the rounding of that size: what
    damping has stopped at zero is at rest, though floats resolve it ever further.
    """

    def __init__(self) -> None:
        self.noise0: float = 0.0
        self.noise1: float = 0.0
        #: scatter seen in this communication step
        self.scatter0: float = 0.0
        self.scatter1: float = 0.0
        #: of the equations of motion, for the caller to count
        self.evaluations: int = 0
        #: largest coordinates and accelerations so far
        self.size0: float = 0.0
        self.size1: float = 0.0
        self.most0: float = 0.0
        self.most1: float = 0.0

    def forget(self) -> None:
        """Before a first step."""
        self.size0 = self.size1 = self.most0 = self.most1 = 0.0

    def take(self, other: Rounding) -> None:
        """Remember the sizes that `other` does."""
        self.size0, self.size1 = other.size0, other.size1
        self.most0, self.most1 = other.most0, other.most1

    def get_state(self) -> list[float]:
        """What is remembered from one communication step to the next."""
        return [self.size0, self.size1, self.most0, self.most1]

    def set_state(self, state: list[float]) -> None:
        """Return to what get_state() gave."""
        self.size0, self.size1, self.most0, self.most1 = state

    def begin(self) -> None:
        """Forget scatter and count: before a communication step."""
        self.scatter0 = 0.0
        self.scatter1 = 0.0
        self.evaluations = 0

    def follow(self, model: Model, a0: float, a1: float) -> None:
        """Take in the present coordinates, and their accelerations."""
        self.size0 = max(self.size0, math.fabs(model.q0))
        self.size1 = max(self.size1, math.fabs(model.q1))
        self.most0 = max(self.most0, math.fabs(a0))
        self.most1 = max(self.most1, math.fabs(a1))

    def hides(self, a0: float, a1: float) -> bool:
        """Whether accelerations are rounding, by what was found last."""
        return math.fabs(a0) <= self.noise0 and math.fabs(a1) <= self.noise1

    def estimate(self, model: Model, t: float, a0: float, a1: float) -> None:
        """Find what the rounding of the present state makes of its accelerations (a0, a1).

        By the slopes, and the scatter seen before. A model without Jacobian is looked at closely.
        """
        v0 = math.fabs(model.v0)
        v1 = math.fabs(model.v1)
        try:
            model.jacobian(t, model.q0, model.q1, model.v0, model.v1)
        except (ArithmeticError, ValueError, NotImplementedError):
            self.look(model, t, a0, a1)
            self.noise0 = self.scatter0
            self.noise1 = self.scatter1
            return
        noise0 = (math.fabs(model.a0_q0) * self.size0 + math.fabs(model.a0_q1) * self.size1) + (
            math.fabs(model.a0_v0) * v0 + math.fabs(model.a0_v1) * v1
        )
        noise1 = (math.fabs(model.a1_q0) * self.size0 + math.fabs(model.a1_q1) * self.size1) + (
            math.fabs(model.a1_v0) * v0 + math.fabs(model.a1_v1) * v1
        )
        self.noise0 = max(SPREAD * noise0, self.scatter0)
        self.noise1 = max(SPREAD * noise1, self.scatter1)

    def look_closely(self, model: Model, t: float, a0: float, a1: float) -> None:
        """Find it also from how the accelerations scatter between states that are all but equal.

        That shows what cancels within them, too, and so do accelerations that were larger.
        """
        self.look(model, t, a0, a1)
        self.estimate(model, t, a0, a1)

    def look(self, model: Model, t: float, a0: float, a1: float) -> None:
        """Include the scatter, and half of what was seen of it before, for a few values err."""
        q0, q1, v0, v1 = model.q0, model.q1, model.v0, model.v1
        self.scatter0 = max(0.5 * self.scatter0, SPREAD * self.most0)
        self.scatter1 = max(0.5 * self.scatter1, SPREAD * self.most1)
        try:
            for k in range(1, PROBES + 1):
                near = 1.0 + k * EPSILON
                far = 1.0 - (PROBES + k) * EPSILON
                model.acceleration(t, q0 * near, q1 * far, v0 * far, v1 * near)
                b0 = model.a0
                b1 = model.a1
                self.scatter0 = max(self.scatter0, TIMES * math.fabs(b0 - a0))
                self.scatter1 = max(self.scatter1, TIMES * math.fabs(b1 - a1))
                self.evaluations += 1
        except (ArithmeticError, ValueError):
            return

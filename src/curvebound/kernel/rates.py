"""How fast the outputs of a model change."""

from __future__ import annotations

import math
from typing import Annotated, Final

from .base import MOST_VARIABLES, Inputs, Model, Values

__all__ = ["OutputRates"]

Groups = Annotated[list[int], MOST_VARIABLES]

#: of the time in which the motion changes, for differences: their error is about its square
PART: Final = 1e-5
LONGEST: Final = 1.0


class OutputRates:
    """Time derivatives of the outputs of a model that has started, by differences along its motion.

    Right to about 1e-9 of the natural size of each, but for the jump of an angle's whole turns.
    """

    def __init__(self, model: Model) -> None:
        self.model: Model = model
        self.groups: Groups = [0] * MOST_VARIABLES
        self.count: int = 0
        for group in model.OUTPUTS.values():
            self.groups[self.count] = group
            self.count += 1
        # the present state, its accelerations and power, the time (s) to go either way
        self.q0: float = 0.0
        self.q1: float = 0.0
        self.v0: float = 0.0
        self.v1: float = 0.0
        self.work: float = 0.0
        self.a0: float = 0.0
        self.a1: float = 0.0
        self.power: float = 0.0
        self.ahead: float = LONGEST
        #: outputs that time before it
        self.before: Values = [0.0] * MOST_VARIABLES

    def begin(self) -> None:
        """Look at the motion of the present state, once for all groups."""
        model = self.model
        q0, q1, v0, v1 = model.q0, model.q1, model.v0, model.v1
        model.acceleration(0.0, q0, q1, v0, v1)
        a0 = model.a0
        a1 = model.a1
        self.power = model.power(0.0, q0, q1, v0, v1, a0, a1) if model.works else 0.0
        self.ahead = PART * time_of_change(model, q0, q1, v0, v1, a0, a1)
        self.q0, self.q1, self.v0, self.v1, self.work = q0, q1, v0, v1, model.work
        self.a0, self.a1 = a0, a1

    def find(self, group: int, slopes: Inputs, rates: Values, first: int) -> None:
        """Write the rates of one group's outputs to rates[first + position in OUTPUTS].

        Of the state of begin(), while inputs rise by `slopes`. The model is left as it was.
        """
        model = self.model
        t = self.ahead
        model.keep()
        try:
            model.begin_rise(slopes)
            self.move(-t)
            model.observe(group, self.before, 0)
            self.move(t)
            model.observe(group, rates, first)
        finally:
            model.hold_inputs()
            model.undo()
        for i in range(self.count):
            if self.groups[i] == group:
                rates[first + i] = (rates[first + i] - self.before[i]) / (2.0 * t)

    def move(self, t: float) -> None:
        """Bring the model to where it is t s from the present state."""
        model = self.model
        model.q0 = self.q0 + t * (self.v0 + 0.5 * t * self.a0)
        model.q1 = self.q1 + t * (self.v1 + 0.5 * t * self.a1)
        model.v0 = self.v0 + t * self.a0
        model.v1 = self.v1 + t * self.a1
        model.work = self.work + t * self.power
        model.move(t)


def time_of_change(
    model: Model, q0: float, q1: float, v0: float, v1: float, a0: float, a1: float
) -> float:
    """Time (s) in which the motion changes: by its rates, its forces and their slopes."""
    rate = math.fabs(v0) / model.q0_scale + math.fabs(v1) / model.q1_scale
    rate += math.sqrt(math.fabs(a0) / model.q0_scale + math.fabs(a1) / model.q1_scale)
    model.jacobian(0.0, q0, q1, v0, v1)
    rate += math.fabs(model.a0_v0) + math.fabs(model.a1_v1)
    rate += math.sqrt(math.fabs(model.a0_q0) + math.fabs(model.a1_q1))
    return 1.0 / rate if rate * LONGEST > 1.0 else LONGEST

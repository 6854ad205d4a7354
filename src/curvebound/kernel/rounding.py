"""What the rounding of the state makes of the accelerations: no step can resolve less.

A coordinate q is known to half a unit in its last place, about 1e-16 q, and an acceleration thus
to that times its slope d(acceleration)/dq, however short the step; likewise for the rates. Forces
that cancel, at a rest for instance, have just such slopes.
"""

from __future__ import annotations

import math
from typing import Final, final

from .base import Model

__all__ = ["NEGLIGIBLE", "Rounding"]

EPSILON: Final = 2.220446049250313e-16
#: a rate that moves its coordinate by less than this part of its size counts as none
NEGLIGIBLE: Final = 1e-30
#: growth below this part of the slopes is rounding
FLAT: Final = 1e-6
#: share of rounding in the rates from which there is nothing else in them
TREMBLING: Final = 1e-3
TINY: Final = 1e-300
#: relative distance of states that are compared
AWAY: Final = 1e-11
#: how far accelerations, larger before, exceed those of the slopes if they still cancel
CANCELLING: Final = 1e4
#: accelerations that are compared
PROBES: Final = 3
#: how far others may scatter beyond those
TIMES: Final = 4.0
#: four units in the last place: so far the values at the points of a step scatter
SPREAD: Final = 8.9e-16


@final
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
        #: largest coordinates, accelerations and rates so far
        self.size0: float = 0.0
        self.size1: float = 0.0
        self.most0: float = 0.0
        self.most1: float = 0.0
        self.fast0: float = 0.0
        self.fast1: float = 0.0
        #: s, time since the start
        self.time: float = 0.0
        #: the largest error, relative to the rates, that rounding can have made so far
        self.doubt: float = 0.0

    def forget(self) -> None:
        """Before a first step."""
        self.size0 = self.size1 = self.most0 = self.most1 = self.fast0 = self.fast1 = 0.0
        self.time = self.doubt = 0.0

    def take(self, other: Rounding) -> None:
        """Remember the sizes that `other` does."""
        self.size0, self.size1 = other.size0, other.size1
        self.most0, self.most1 = other.most0, other.most1
        self.fast0, self.fast1 = other.fast0, other.fast1
        self.time, self.doubt = other.time, other.doubt

    def get_state(self) -> list[float]:
        """What is remembered from one communication step to the next."""
        return [
            self.size0,
            self.size1,
            self.most0,
            self.most1,
            self.fast0,
            self.fast1,
            self.time,
            self.doubt,
        ]

    def set_state(self, state: list[float]) -> None:
        """Return to what get_state() gave."""
        self.size0, self.size1, self.most0, self.most1 = state[:4]
        self.fast0, self.fast1, self.time, self.doubt = state[4:]

    def begin(self) -> None:
        """Forget scatter and count: before a communication step."""
        self.scatter0 = 0.0
        self.scatter1 = 0.0
        self.evaluations = 0

    def follow(self, model: Model, a0: float, a1: float) -> None:
        """Take in the present state, and its accelerations."""
        x = math.fabs(model.q0)
        if x > self.size0:
            self.size0 = x
        x = math.fabs(model.q1)
        if x > self.size1:
            self.size1 = x
        x = math.fabs(model.v0)
        if x > self.fast0:
            self.fast0 = x
        x = math.fabs(model.v1)
        if x > self.fast1:
            self.fast1 = x
        x = math.fabs(a0)
        if x > self.most0:
            self.most0 = x
        x = math.fabs(a1)
        if x > self.most1:
            self.most1 = x

    def pace(self) -> float:
        """The fastest change of a rate so far, 1/s: by it an error of time counts there."""
        pace0 = self.most0 / self.fast0 if self.fast0 > 0.0 else 0.0
        pace1 = self.most1 / self.fast1 if self.fast1 > 0.0 else 0.0
        return max(pace0, pace1)

    def note_time(self, t: float, a0: float, a1: float) -> None:
        """Note what a rounding of the time, t s into the communication step, counts there."""
        late = 0.5 * EPSILON * (self.time + t)
        self.note(late * math.fabs(a0), self.fast0)
        self.note(late * math.fabs(a1), self.fast1)

    def note(self, error: float, fast: float) -> None:
        """Note an error of a rate, the largest of which was `fast`."""
        if error > self.doubt * fast:
            self.doubt = max(self.doubt, error / max(fast, error))

    def note_noise(self, model: Model, t: float, h: float) -> None:
        """Note what the rounding of a step of h s counts beside the rates so far."""
        try:
            model.jacobian(t, model.q0, model.q1, model.v0, model.v1)
        except (ArithmeticError, ValueError, NotImplementedError):
            return
        half = 0.5 * (model.a0_q0 + model.a1_q1)
        product = model.a0_q0 * model.a1_q1 - model.a0_q1 * model.a1_q0
        apart = math.sqrt(max(0.0, half * half - product))
        growth = half + apart
        error0 = h * self.noise0
        error1 = h * self.noise1
        if growth <= FLAT * (math.fabs(model.a0_q0) + math.fabs(model.a1_q1)):
            # a rest that has moved by nothing but rounding is one
            if error0 >= TREMBLING * max(self.fast0, error0):
                error0 = 0.0
            if error1 >= TREMBLING * max(self.fast1, error1):
                error1 = 0.0
            # roundings d of the places make forces by their slopes, which lead back where they are
            # great: to places that are d off, at rates of d times the pace, however long they act.
            # What scatters besides acts for the whole step
            radians0 = max(1.0, h * math.sqrt(max(0.0, -model.a0_q0)))
            radians1 = max(1.0, h * math.sqrt(max(0.0, -model.a1_q1)))
            error0 = min(error0, max(error0 / radians0, h * self.scatter0))
            error1 = min(error1, max(error1 / radians1, h * self.scatter1))
        self.note_rates(error0, error1)

    def note_rates(self, error0: float, error1: float) -> None:
        """Note errors of both rates, but for a coordinate that hardly moves beside the other."""
        pace0 = self.fast0 * self.size1
        pace1 = self.fast1 * self.size0
        if pace0 >= FLAT * pace1:
            self.note(error0, self.fast0)
        if pace1 >= FLAT * pace0:
            self.note(error1, self.fast1)

    def hides(self, a0: float, a1: float) -> bool:
        """Whether accelerations are rounding, by what was found last."""
        return math.fabs(a0) <= self.noise0 and math.fabs(a1) <= self.noise1

    def estimate(self, model: Model, t: float) -> None:
        """Find what the rounding of the present state makes of its accelerations.

        By the slopes, and the scatter seen before. A model without Jacobian is looked at closely.
        """
        v0 = math.fabs(model.v0)
        v1 = math.fabs(model.v1)
        try:
            model.jacobian(t, model.q0, model.q1, model.v0, model.v1)
        except (ArithmeticError, ValueError, NotImplementedError):
            self.look(model, t)
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

    def look_closely(self, model: Model, t: float) -> None:
        """Find it also from how the accelerations scatter between states that are all but equal.

        That shows what cancels within them, too, and so do accelerations that were larger, unless
        they were those of a place that is too violent to be compared with.
        """
        self.look(model, t)
        self.estimate(model, t)

    def look(self, model: Model, t: float) -> None:
        """Include the scatter, and half of what was seen of it before, for a few values err."""
        q0, q1, v0, v1 = model.q0, model.q1, model.v0, model.v1
        most0 = self.most0
        most1 = self.most1
        try:
            # far enough for all digits to differ, less what is slope
            model.jacobian(t, q0, q1, v0, v1)
            j00, j01, j10, j11 = model.a0_q0, model.a0_q1, model.a1_q0, model.a1_q1
            k00, k01, k10, k11 = model.a0_v0, model.a0_v1, model.a1_v0, model.a1_v1
            step = AWAY
            part = CANCELLING * max(
                (math.fabs(j00) * self.size0 + math.fabs(j01) * self.size1) / (most0 + TINY),
                (math.fabs(j10) * self.size0 + math.fabs(j11) * self.size1) / (most1 + TINY),
            )
            if part < 1.0:
                most0 *= part
                most1 *= part
        except NotImplementedError:
            j00 = j01 = j10 = j11 = k00 = k01 = k10 = k11 = 0.0
            step = EPSILON
        except (ArithmeticError, ValueError):
            step = 0.0
        self.scatter0 = max(0.5 * self.scatter0, SPREAD * most0)
        self.scatter1 = max(0.5 * self.scatter1, SPREAD * most1)
        if step == 0.0:
            return
        try:
            # not those that a step ended with: they are as good as its sweeps have converged
            model.acceleration(t, q0, q1, v0, v1)
            a0 = model.a0
            a1 = model.a1
            self.evaluations += 1
            for k in range(1, PROBES + 1):
                near = 1.0 + k * step
                far = 1.0 - (PROBES + k) * step
                x0 = q0 * near
                x1 = q1 * far
                w0 = v0 * far
                w1 = v1 * near
                model.acceleration(t, x0, x1, w0, w1)
                x0 -= q0
                x1 -= q1
                w0 -= v0
                w1 -= v1
                b0 = model.a0 - (a0 + ((j00 * x0 + j01 * x1) + (k00 * w0 + k01 * w1)))
                b1 = model.a1 - (a1 + ((j10 * x0 + j11 * x1) + (k10 * w0 + k11 * w1)))
                self.scatter0 = max(self.scatter0, TIMES * math.fabs(b0))
                self.scatter1 = max(self.scatter1, TIMES * math.fabs(b1))
                self.evaluations += 1
        except (ArithmeticError, ValueError):
            return

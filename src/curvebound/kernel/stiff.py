"""Long steps where motion is smooth but stiff: damping that would hold other methods to short ones.

A trial begins with the step that the sweeps of lobatto.Collocation can make. A Radau step costs
some fifty of those: it goes on only while it is GAIN times as long as they could be.
"""

from __future__ import annotations

import math
from typing import Final

from .base import Model
from .elapsed import Elapsed
from .method import DONE, STEP_TOO_SMALL, TOO_MANY_STEPS
from .radau import Radau
from .radau_tables import STAGES
from .rounding import NEGLIGIBLE, Rounding

__all__ = ["Stiff", "is_stiff"]

#: steps that must be as long to pay, the tries in which they must become so, rejected ones at most
GAIN: Final = 16.0
TRIAL: Final = 10
MOST_REJECTED: Final = 4
#: the size of the polynomial's tail as a power of the error, which is far smaller
TAIL_POWER: Final = 0.7
SAFETY: Final = 0.8
#: bounds of the ratio of one step size to the next
MOST_GROWTH: Final = 4.0
MOST_SHRINKING: Final = 0.02
#: smallest step relative to the communication step
RESOLUTION: Final = 1e-22
#: the shortest step that damping explains, as a part of its time constant: a tight tolerance, and
#: rounding at rest, shorten what convergence allows
STIFF: Final = 0.03
LARGEST: Final = 1e300


class Stiff:
    """The steps of a stiff stretch, with counts of what it did in a communication step."""

    def __init__(self) -> None:
        self.radau = Radau()
        #: s, step to go on with; 0: the motion is not stiff
        self.wished: float = 0.0
        #: steps accepted, and tried
        self.steps: int = 0
        self.tries: int = 0
        self.evaluations: int = 0
        #: s, internal step at a failure
        self.reached: float = 0.0

    def begin(self) -> None:
        """Forget the counts: before a communication step."""
        self.steps = 0
        self.tries = 0
        self.evaluations = 0

    def pays(self, short: float, duration: float) -> bool:
        """Whether a communication step begins with stiff steps, where others make `short` s."""
        return self.wished > 0.0 and duration > GAIN * short

    def go_on(
        self,
        model: Model,
        rounding: Rounding,
        elapsed: Elapsed,
        duration: float,
        short: float,
        share: float,
        most_tries: int,
    ) -> int:
        """Steps beyond `short` s until they no longer pay, or to the end of `duration`.

        Each with an error of about `share`; at most `most_tries` since begin(). DONE or the kind of
        failure.
        """
        radau = self.radau
        settles = model.settles
        bound = math.exp(TAIL_POWER * math.log(share))
        h = self.wished
        if h <= 0.0:
            h = 2.0 * short
        slow = rejected = 0
        while slow <= TRIAL and rejected < MOST_REJECTED:
            if self.tries >= most_tries:
                self.reached = h
                return TOO_MANY_STEPS
            self.tries += 1
            wished = h
            left = elapsed.left(duration)
            ends = h >= left
            if ends:
                h = left
            elif 2.0 * h > left:
                h = 0.5 * left
            radau.evaluations = 0
            try:
                if rejected > 0:
                    rounding.look(model, elapsed.t)
                size = radau.step(model, rounding, elapsed.t, h, share, bound)
            except (ArithmeticError, ValueError, NotImplementedError):
                size = math.inf
            self.evaluations += radau.evaluations
            if h < GAIN * max(
                short, usual(model, elapsed.t, model.q0, model.q1, model.v0, model.v1)
            ):
                slow += 1
            else:
                slow = rejected = 0
            if size <= bound:
                self.steps += 1
                if settles:
                    model.settle(h)
                rounding.follow(model, radau.a[STAGES - 1], radau.b[STAGES - 1])
                rounding.note_rates(radau.off0, radau.off1)
                after = h * min(MOST_GROWTH, max(0.5, growth(size / bound)))
                if ends:
                    # a step that the end cut short may only grow
                    self.wished = max(wished, after)
                    elapsed.finish(duration)
                    return DONE
                elapsed.add(h)
                h = after
            else:
                rejected += 1
                shrinking = max(MOST_SHRINKING, min(SAFETY, growth(size / bound)))
                h *= 0.25 if size > LARGEST else shrinking
                if h < duration * RESOLUTION:
                    self.reached = h
                    return STEP_TOO_SMALL
        self.wished = 0.0
        return DONE


def usual(model: Model, t: float, q0: float, q1: float, v0: float, v1: float) -> float:
    """About the step (s) that the sweeps could make at this state, as far as stiffness goes.

    It is what the step at the start of a stretch was only while that lasts. Without a Jacobian
    there is no limit known.
    """
    try:
        model.jacobian(t, q0, q1, v0, v1)
    except (ArithmeticError, ValueError, NotImplementedError):
        return LARGEST
    rate = math.fabs(model.a0_v0 + model.a1_v1)
    rate += math.sqrt(math.fabs(model.a0_q0) + math.fabs(model.a1_q1))
    return 1.0 / rate if rate * LARGEST > 1.0 else LARGEST


def is_stiff(model: Model, rounding: Rounding, t: float, h: float, a0: float, a1: float) -> bool:
    """Whether damping, not the motion with its acceleration (a0, a1), keeps steps to h s.

    Rest up to rounding is no motion. Where this errs it costs a trial.
    """
    v0 = math.fabs(model.v0)
    v1 = math.fabs(model.v1)
    try:
        model.jacobian(t, model.q0, model.q1, model.v0, model.v1)
    except (ArithmeticError, ValueError, NotImplementedError):
        return False
    damping = -(model.a0_v0 + model.a1_v1)
    rounding.look_closely(model, t)
    still = NEGLIGIBLE * damping * damping
    change0 = math.fabs(a0) - max(rounding.noise0, still * rounding.size0)
    change1 = math.fabs(a1) - max(rounding.noise1, still * rounding.size1)
    if change0 <= 0.0 and change1 <= 0.0:
        # whatever h is: other steps shrink to what is left
        return damping > 0.0
    slow = 4.0 * change0 <= damping * v0 and 4.0 * change1 <= damping * v1
    return slow and h * damping >= STIFF


def growth(error: float) -> float:
    """Ratio of the next step to one whose tail is `error` in units of its bound."""
    return SAFETY * math.exp(math.log(max(error, 1e-30)) * (-1.0 / STAGES))

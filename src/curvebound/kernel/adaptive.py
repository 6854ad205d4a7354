"""Adaptive integration: Lobatto IIIA collocation of order 14 with PI control of the step.

The step is lobatto.Collocation's, in stiff stretches that of stiff.Stiff (Radau IIA, order 13).
The controller is the proportional-integral one of Gustafsson (1991; Hairer, Wanner 1996, eq.
IV.2.43): h *= safety error^-alpha error_before^beta.
"""

from __future__ import annotations

import math
from typing import Final

from .base import Model
from .elapsed import Elapsed
from .growth import Growth
from .lobatto import Collocation
from .method import DONE, NOT_FINITE, STEP_TOO_SMALL, TOO_MANY_STEPS, Method
from .rounding import Rounding
from .stiff import Stiff, is_stiff, usual

__all__ = ["Adaptive"]

#: alpha and beta
PRESENT: Final = 0.064
LAST: Final = 0.0285
SAFETY: Final = 0.82
#: how far a rate changes in a step of ordinary motion
CALM: Final = 2.0
#: bounds of the ratio of one step size to the next
MOST_GROWTH: Final = 1.5
MOST_SHRINKING: Final = 0.2
#: smallest error in units of the tolerance that is told apart from none
LEAST_ERROR: Final = 1e-8
#: error of a step in units of the tolerance, so that over many steps the sum keeps to the tolerance
SHARE: Final = 0.2
#: an error of a step below this is rounding
LEAST_SHARE: Final = 1e-16
#: errors that grow are held no closer than this: rounding then decides
CLOSEST: Final = 1e-14
#: nor is anything than this where rounding has made more than the tolerance already
SPOILT: Final = 1e-13
#: smallest step relative to the communication step, and that below which the state has to move
RESOLUTION: Final = 1e-22
SHORT: Final = 1e-14
#: steps after which one in REJECTS rejected is a reason to try stiff ones; then half as many again
FIRST_TRIAL: Final = 60
REJECTS: Final = 4
#: steps after which rest up to rounding is a reason; likewise
FIRST_CALM: Final = 8
#: one step less than those after which rounding is looked at, for it may be all that limits them
LOOK: Final = 31
LARGEST: Final = 1e300


class Adaptive(Method):
    """Seven evaluations per sweep, usually three or four sweeps per step, order 14.

    One coordinate alone takes one sweep of two and one or two of seven, by Newton's method.

    The tolerance is relative to the rates, each coordinate's own. A motion that starts from rest,
    or rests, thus needs no absolute tolerance. Where something fast has happened, slow steps may
    make as much less, for their errors of time count there; so may all steps where the model says
    beforehand that the motion magnifies errors (magnification). The error over ten oscillations is
    of the size of the tolerance, or of what rounding makes of it.
    """

    ORDER = 14
    CHOOSES_STEP = True

    def __init__(self) -> None:
        super().__init__()
        self.collocation = Collocation()
        #: s, step that the error control wishes to make next; 0: not begun
        self.wished: float = 0.0
        #: logarithm of the last accepted error in units of the tolerance
        self.log_error: float = 0.0
        self.stiff = Stiff()
        self.rounding = Rounding()
        self.growth = Growth()
        self.elapsed = Elapsed()
        self.kept = Collocation()
        self.kept_stiff: float = 0.0
        self.kept_rounding = Rounding()
        self.kept_growth = Growth()
        self.kept_wished: float = 0.0
        self.kept_log_error: float = 0.0

    def reset(self) -> None:
        super().reset()
        self.collocation = Collocation()
        self.wished = 0.0
        self.log_error = 0.0
        self.stiff.wished = 0.0
        self.rounding.forget()
        self.growth.forget()

    def keep(self) -> None:
        self.kept.take(self.collocation)
        self.kept_wished = self.wished
        self.kept_log_error = self.log_error
        self.kept_stiff = self.stiff.wished
        self.kept_rounding.take(self.rounding)
        self.kept_growth.take(self.growth)

    def undo(self) -> None:
        self.collocation.take(self.kept)
        self.wished = self.kept_wished
        self.log_error = self.kept_log_error
        self.stiff.wished = self.kept_stiff
        self.rounding.take(self.kept_rounding)
        self.growth.take(self.kept_growth)

    def get_state(self) -> list[float]:
        return [
            self.wished,
            self.log_error,
            self.stiff.wished,
            *self.rounding.get_state(),
            *self.growth.get_state(),
            *self.collocation.get_state(),
        ]

    def set_state(self, state: list[float]) -> None:
        self.wished, self.log_error, self.stiff.wished = state[:3]
        self.rounding.set_state(state[3:11])
        self.growth.set_state(state[11:31])
        self.collocation.set_state(state[31:])

    def advance(
        self, model: Model, duration: float, count: int, tolerance: float, max_steps: int
    ) -> int:
        self.stiff.begin()
        outcome = self.reach(model, duration, tolerance, max_steps)
        self.evaluations += 7 * self.collocation.sweeps + self.collocation.newton.evaluations
        self.evaluations += self.stiff.evaluations + self.rounding.evaluations
        self.steps += self.stiff.steps
        if outcome == DONE:
            self.rounding.time += duration
        else:
            self.passed = self.elapsed.t
        return outcome

    def doubt(self) -> float:
        return self.rounding.doubt

    def loss(self) -> float:
        return self.growth.lost

    def reach(self, model: Model, duration: float, tolerance: float, max_steps: int) -> int:
        """The steps of advance()."""
        # in one piece: with what follows a step in functions, a step cost up to 4 % more
        collocation = self.collocation
        rounding = self.rounding
        growth = self.growth
        rounding.begin()
        settles = model.settles
        share = max(SHARE * tolerance / model.magnification, LEAST_SHARE)
        collocation.begin(share)
        least = duration * SHORT
        model.acceleration(0.0, model.q0, model.q1, model.v0, model.v1)
        a0 = model.a0
        a1 = model.a1
        self.evaluations += 1
        if not math.fabs(a0) + math.fabs(a1) <= LARGEST:
            self.reached = self.wished
            return NOT_FINITE
        rounding.follow(model, a0, a1)
        pace = rounding.pace() / CALM
        if self.wished <= 0.0:
            self.wished = first_step(model, a0, a1, duration, share)
        elapsed = self.elapsed
        elapsed.reset()
        stiff = self.stiff
        rejected = trying = False
        tries = rejections = since = 0
        trial = FIRST_TRIAL
        calm = FIRST_CALM
        if stiff.pays(self.wished, duration):
            trial = 0
        while True:
            # entered once for all steps up to one that is rejected, not for each: that costs
            try:
                while tries + stiff.tries < max_steps:
                    if tries >= trial or (
                        tries >= calm and collocation.noisy and rounding.hides(a0, a1)
                    ):
                        if (
                            trial == 0
                            or REJECTS * rejections >= tries - since
                            or is_stiff(model, rounding, elapsed.t, self.wished, a0, a1)
                        ):
                            outcome = stiff.go_on(
                                model,
                                rounding,
                                elapsed,
                                duration,
                                self.wished,
                                share,
                                max_steps - tries,
                            )
                            # what comes next has nothing to extrapolate from
                            collocation.h = 0.0
                            growth.leave()
                            if outcome != DONE:
                                self.reached = stiff.reached
                                return outcome
                            t = elapsed.t
                            if t >= duration:
                                return DONE
                            model.acceleration(t, model.q0, model.q1, model.v0, model.v1)
                            a0 = model.a0
                            a1 = model.a1
                            self.evaluations += 1
                        since = tries
                        trial = tries + max(FIRST_TRIAL, tries // 2)
                        calm = tries + max(FIRST_CALM, tries // 2)
                        rejections = 0
                    tries += 1
                    if tries & LOOK == 0:
                        collocation.noisy = True
                    t = elapsed.t
                    wished = self.wished
                    remaining = elapsed.left(duration)
                    h = wished
                    ends = h >= remaining
                    if ends:
                        h = remaining
                    elif 2.0 * h > remaining:
                        h = 0.5 * remaining
                    # an error of time made here counts by what is fastest
                    allowed = share / max(1.0, pace * h)
                    allowed = max(allowed / growth.closer, min(allowed, CLOSEST), LEAST_SHARE)
                    if rounding.doubt > tolerance:
                        allowed = max(allowed, SPOILT)
                    q0 = model.q0
                    q1 = model.q1
                    trying = True
                    error = collocation.step(model, rounding, t, h, a0, a1, allowed) / allowed
                    trying = False
                    if not error <= 1.0:
                        break
                    self.steps += 1
                    if 2.0 * h >= wished:
                        # a step that the end of the communication step cut short says nothing
                        log_error = math.log(max(error, LEAST_ERROR))
                        wish = h * SAFETY * math.exp(LAST * self.log_error - PRESENT * log_error)
                        most = h if rejected else MOST_GROWTH * wished
                        self.wished = min(max(wish, MOST_SHRINKING * h), most)
                        self.log_error = log_error
                    rejected = False
                    moved0 = model.q0 - q0
                    moved1 = model.q1 - q1
                    if settles:
                        model.settle(h)
                    rounding.follow(model, collocation.a7, collocation.b7)
                    if collocation.noisy:
                        # beside the rates that it leads to: from rest there were none
                        rounding.note_noise(model, t, h)
                    rounding.note_time(t + h, collocation.a7, collocation.b7)
                    gained0 = collocation.a7 - a0
                    gained1 = collocation.b7 - a1
                    growth.follow(
                        model, rounding, t + h, h, moved0, moved1, gained0, gained1, allowed
                    )
                    pace = rounding.pace() / CALM
                    if ends:
                        return DONE
                    elapsed.add(h)
                    if settles:
                        t = elapsed.t
                        model.acceleration(t, model.q0, model.q1, model.v0, model.v1)
                        a0 = model.a0
                        a1 = model.a1
                        self.evaluations += 1
                    else:
                        a0 = collocation.a7
                        a1 = collocation.b7
                else:
                    self.reached = self.wished
                    return TOO_MANY_STEPS
            except (ArithmeticError, ValueError, NotImplementedError):
                if not trying:
                    raise
                trying = False
                if collocation.newton.failed and not collocation.plain:
                    collocation.plain = True
                    continue
                # a stage left the model's domain or the finite numbers: far too large a step
                error = math.inf
            collocation.noisy = rejected
            rejected = True
            rejections += 1
            if error <= LARGEST:
                shrinking = max(SAFETY * math.exp(-PRESENT * math.log(error)), MOST_SHRINKING)
            else:
                shrinking = 0.5
            self.wished = h * shrinking
            if self.wished < least and (
                self.wished < duration * RESOLUTION or stands(model, self.wished, a0, a1)
            ):
                self.reached = self.wished
                return STEP_TOO_SMALL


def stands(model: Model, h: float, a0: float, a1: float) -> bool:
    """Whether a step of h s is lost in the rounding of the state."""
    q0, q1, v0, v1 = model.q0, model.q1, model.v0, model.v1
    return q0 + h * v0 == q0 and q1 + h * v1 == q1 and v0 + h * a0 == v0 and v1 + h * a1 == v1


def first_step(model: Model, a0: float, a1: float, duration: float, tolerance: float) -> float:
    """A cautious first step (s): a part of the time in which the acceleration changes.

    That is known at the start, and where the start leads to.
    """
    part = 0.5 * math.exp(PRESENT * math.log(tolerance))
    q0, q1, v0, v1 = model.q0, model.q1, model.v0, model.v1
    h = min(duration, part * usual(model, 0.0, q0, q1, v0, v1))
    for _ in range(2):
        u0 = v0 + h * a0
        u1 = v1 + h * a1
        x0 = q0 + 0.5 * h * (v0 + u0)
        x1 = q1 + 0.5 * h * (v1 + u1)
        h = min(h, part * usual(model, h, x0, x1, u0, u1))
    return h

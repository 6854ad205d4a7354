"""How errors that were made on the way grow where the motion is unstable.

Near a rest that is unstable, a coordinate and its acceleration change alike: in proportion to the
square of the rate of growth, whether the motion comes or goes. What comes near such a rest and
leaves it again magnifies errors made before by the growth of all that stretch, though nothing of
the motion is larger afterwards, and though a change of its start may count for far less.
"""

from __future__ import annotations

import math
from typing import Final, final

from .base import Model
from .rounding import Rounding

__all__ = ["Growth"]

UNIT_ROUNDOFF: Final = 1.1102230246251565e-16
#: slopes below this part of the largest are rounding
FLAT: Final = 1e-6
#: growth that counts, and that of the motion itself from which on errors are held closer
LEAST: Final = 3.0
#: logarithm of the growth that a motion has to show before the Jacobian is asked
SHOWN: Final = 2.0
#: share of what steps are allowed that is met by errors, as they add up
MET: Final = 0.02
#: logarithm of the growth in one step, at most
MOST: Final = 100.0
TINY: Final = 1e-300


@final
class Stretch:
    """The present unstable stretch of one coordinate, and its errors before."""

    def __init__(self) -> None:
        #: errors of a step in rate and coordinate, each times itself, the largest so far; way: of
        #: the coordinate, at most about that there and back
        self.made: float = 0.0
        self.off: float = 0.0
        self.way: float = 0.0
        #: logarithm of the growth that the motion shows, and the time (s) that it takes
        self.shown: float = 0.0
        self.span: float = 0.0
        #: of the rate, what rounding can have made of it, and errors of steps; 0: none known
        self.error: float = 0.0
        self.slack: float = 0.0
        #: by what errors made at its begin have grown, and the fastest rate then
        self.grown: float = 1.0
        self.first: float = 0.0

    def forget(self) -> None:
        """Before a first step."""
        self.leave()
        self.made = self.off = self.way = 0.0

    def take(self, other: Stretch) -> None:
        """Remember what `other` does."""
        self.made, self.off, self.way = other.made, other.off, other.way
        self.shown, self.span = other.shown, other.span
        self.error, self.slack = other.error, other.slack
        self.grown, self.first = other.grown, other.first

    # fmt: off
    def get_state(self) -> list[float]:
        """What is remembered from one communication step to the next."""
        return [
            self.made, self.off, self.way, self.shown, self.span, self.error, self.slack,
            self.grown, self.first,
        ]
    # fmt: on

    def set_state(self, state: list[float]) -> None:
        """Return to what get_state() gave."""
        self.made, self.off, self.way, self.shown, self.span = state[:5]
        self.error, self.slack, self.grown, self.first = state[5:]

    def leave(self) -> None:
        """At the end of the stretch."""
        self.shown = self.span = self.error = self.slack = self.first = 0.0
        self.grown = 1.0

    def move(
        self,
        h: float,
        moved: float,
        gained: float,
        speed: float,
        allowed: float,
        size: float,
        fast: float,
    ) -> bool:
        """Take in a step of h s, in which coordinate and acceleration changed by these.

        Returns whether they show growth enough to be looked into. allowed: the error relative to
        the rates that the step was held to; those of slow and of short motion count by what they
        are for its energy. size, fast: the largest coordinate and rate so far.
        """
        self.way = min(self.way + math.fabs(moved), 2.0 * size)
        met = MET * allowed
        self.off = max(self.off, met * self.way * self.way)
        self.made = max(self.made, met * speed * speed)
        if not moved * gained > 0.0:
            self.leave()
            return False
        if self.span == 0.0 and self.error == 0.0:
            self.grown = 1.0
            self.first = max(fast, TINY)
        self.shown += h * math.sqrt(gained / moved)
        self.span += h
        return self.shown > SHOWN or self.error > 0.0

    def grow(self, rate: float, fast: float, noise: float, strain: float) -> None:
        """Include what was shown since the last time.

        rate: the fastest rate of growth, 1/s. fast: the fastest rate of the coordinate so far.
        noise, strain: of the acceleration, by rounding and by errors of steps.
        """
        grows = math.exp(min(min(self.span * rate, self.shown), MOST))
        self.grown *= grows
        error = max(self.error, UNIT_ROUNDOFF * (fast if self.error > 0.0 else self.first))
        self.error = error * grows + self.span * noise
        self.slack = max(self.slack, self.made / self.first) * grows + self.span * strain
        self.shown = self.span = 0.0


@final
class Growth:
    """The unstable stretches of both coordinates, and what they make of errors of steps.

    A motion that leaves the neighbourhood of a rest grows by a factor. Where it returns, errors
    made meanwhile grow by the square of it, and so much closer are they to be held. What was made
    before that was known is lost.
    """

    def __init__(self) -> None:
        self.stretch0 = Stretch()
        self.stretch1 = Stretch()
        #: by how much closer
        self.closer: float = 1.0
        #: what errors of steps can have grown to, relative to the rates
        self.lost: float = 0.0

    def forget(self) -> None:
        """Before a first step."""
        self.stretch0.forget()
        self.stretch1.forget()
        self.closer = 1.0
        self.lost = 0.0

    def leave(self) -> None:
        """At the end of both stretches."""
        self.stretch0.leave()
        self.stretch1.leave()

    def take(self, other: Growth) -> None:
        """Remember what `other` does."""
        self.stretch0.take(other.stretch0)
        self.stretch1.take(other.stretch1)
        self.closer, self.lost = other.closer, other.lost

    def get_state(self) -> list[float]:
        """What is remembered from one communication step to the next."""
        both = [*self.stretch0.get_state(), *self.stretch1.get_state()]
        return [*both, self.closer, self.lost]

    def set_state(self, state: list[float]) -> None:
        """Return to what get_state() gave."""
        self.stretch0.set_state(state[:9])
        self.stretch1.set_state(state[9:18])
        self.closer, self.lost = state[18:]

    def follow(
        self,
        model: Model,
        rounding: Rounding,
        t: float,
        h: float,
        moved0: float,
        moved1: float,
        gained0: float,
        gained1: float,
        allowed: float,
    ) -> None:
        """Take in a step of h s to time t, in which coordinates and accelerations changed so.

        allowed: the error relative to the rates that it was held to.
        """
        one, two = self.stretch0, self.stretch1
        if moved0 == 0.0 and model.v0 != 0.0:
            note_standing(model, rounding, t, model.q0, rounding.fast0)
        if moved1 == 0.0 and model.v1 != 0.0:
            note_standing(model, rounding, t, model.q1, rounding.fast1)
        size0, size1, fast0, fast1 = rounding.size0, rounding.size1, rounding.fast0, rounding.fast1
        grows0 = one.move(h, moved0, gained0, model.v0, allowed, size0, fast0)
        grows1 = moved1 != 0.0 and two.move(h, moved1, gained1, model.v1, allowed, size1, fast1)
        if not grows0 and not grows1:
            return
        rate = growth_rate(model, t)
        if rate == 0.0:
            one.leave()
            two.leave()
            return
        off0 = one.off / max(size0, TINY)
        off1 = two.off / max(size1, TINY)
        size0 *= UNIT_ROUNDOFF
        size1 *= UNIT_ROUNDOFF
        if grows0:
            slope0, slope1 = math.fabs(model.a0_q0), math.fabs(model.a0_q1)
            one.grow(rate, fast0, slope0 * size0 + slope1 * size1, slope0 * off0 + slope1 * off1)
            self.note(one, rounding, fast0)
        if grows1:
            slope0, slope1 = math.fabs(model.a1_q0), math.fabs(model.a1_q1)
            two.grow(rate, fast1, slope0 * size0 + slope1 * size1, slope0 * off0 + slope1 * off1)
            self.note(two, rounding, fast1)

    def note(self, stretch: Stretch, rounding: Rounding, fast: float) -> None:
        """Note what errors have grown to, and how close further ones are to be held.

        By what the motion itself has grown, unless rounding leaves nothing of it.
        """
        if stretch.grown <= LEAST:
            return
        rounding.note(stretch.error, fast)
        if stretch.slack > self.lost * fast:
            self.lost = max(self.lost, stretch.slack / max(fast, stretch.slack))
        grown = min(stretch.grown, fast / stretch.first)
        if rounding.doubt * grown >= 1.0:
            self.closer = 1.0
        elif grown > LEAST:
            self.closer = max(self.closer, (grown / LEAST) * (grown / LEAST))


def note_standing(model: Model, rounding: Rounding, t: float, q: float, fast: float) -> None:
    """Note what rounding makes of a coordinate q that has a rate, and yet stays where it is.

    Where the motion is unstable, what is lost in the last digit would have grown. fast: its fastest
    rate so far.
    """
    rounding.note(growth_rate(model, t) * UNIT_ROUNDOFF * math.fabs(q), fast)


def growth_rate(model: Model, t: float) -> float:
    """The fastest rate (1/s) at which errors grow at the present state; 0: they do not."""
    try:
        model.jacobian(t, model.q0, model.q1, model.v0, model.v1)
    except (ArithmeticError, ValueError, NotImplementedError):
        return 0.0
    half = 0.5 * (model.a0_q0 + model.a1_q1)
    apart = 0.5 * (model.a0_q0 - model.a1_q1)
    root = apart * apart + model.a0_q1 * model.a1_q0
    if root < 0.0:
        return 0.0
    square = half + math.sqrt(root)
    if square <= FLAT * (math.fabs(model.a0_q0) + math.fabs(model.a1_q1)):
        return 0.0
    slowed = 0.5 * max(0.0, min(-model.a0_v0, -model.a1_v1))
    return square / (slowed + math.sqrt(slowed * slowed + square))

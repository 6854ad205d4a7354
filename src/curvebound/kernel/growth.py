"""How errors that were made on the way grow where the motion is unstable.

Near a rest that is unstable, a coordinate and its acceleration change alike: in proportion to the
square of the rate of growth, whether the motion comes or goes. What comes near such a rest and
leaves it again magnifies errors made before by the growth of all that stretch, though nothing of
the motion is larger afterwards, and though a change of its start may count for far less.
"""

from __future__ import annotations

import math
from typing import Final

from .base import Model
from .rounding import Rounding

__all__ = ["Growth"]

UNIT_ROUNDOFF: Final = 1.1102230246251565e-16
#: slopes below this part of the largest are rounding
FLAT: Final = 1e-6
#: growth of the motion itself from which on errors are held closer
LEAST: Final = 3.0
#: share of what steps are allowed that is met by errors, as they add up
MET: Final = 0.03
#: logarithm of the growth in one step, at most
MOST: Final = 100.0
TINY: Final = 1e-300


class Stretch:
    """The present unstable stretch of one coordinate, and its errors before."""

    def __init__(self) -> None:
        #: errors of a step in rate and coordinate, each times itself, the largest so far; way: of
        #: the coordinate, at most about that there and back
        self.made: float = 0.0
        self.off: float = 0.0
        self.way: float = 0.0
        #: of the rate, what rounding can have made of it, and errors of steps; 0: no stretch
        self.error: float = 0.0
        self.slack: float = 0.0
        #: by what errors made at its begin have grown, and the fastest rate until then
        self.grown: float = 1.0
        self.first: float = 0.0

    def forget(self) -> None:
        """Before a first step."""
        self.leave()
        self.made = self.off = self.way = 0.0

    def take(self, other: Stretch) -> None:
        """Remember what `other` does."""
        self.made, self.off, self.way = other.made, other.off, other.way
        self.error, self.slack = other.error, other.slack
        self.grown, self.first = other.grown, other.first

    def get_state(self) -> list[float]:
        """What is remembered from one communication step to the next."""
        return [self.made, self.off, self.way, self.error, self.slack, self.grown, self.first]

    def set_state(self, state: list[float]) -> None:
        """Return to what get_state() gave."""
        self.made, self.off, self.way = state[:3]
        self.error, self.slack, self.grown, self.first = state[3:]

    def leave(self) -> None:
        """At the end of the stretch."""
        self.error = self.slack = 0.0

    def move(self, moved: float, speed: float, allowed: float, size: float, fast: float) -> None:
        """Take in a step that moved by this, with an error relative to the rates that was allowed.

        Errors of slow and of short motion count by what they are for its energy. size, fast: the
        largest coordinate and rate so far.
        """
        self.way = min(self.way + math.fabs(moved), 2.0 * size)
        met = MET * allowed
        self.off = max(self.off, met * self.way * self.way)
        self.made = max(self.made, met * speed * speed)

    def grow(
        self,
        h: float,
        rate: float,
        moved: float,
        gained: float,
        fast: float,
        noise: float,
        strain: float,
    ) -> None:
        """Go on by a step of h s, in which coordinate and acceleration changed by these.

        rate: the fastest rate of growth, 1/s. fast: the fastest rate of the coordinate so far.
        noise, strain: of the acceleration, by rounding and by errors of steps.
        """
        if not moved * gained > 0.0:
            self.leave()
            return
        grows = math.exp(min(h * min(rate, math.sqrt(gained / moved)), MOST))
        if self.error == 0.0:
            self.grown = 1.0
            self.first = max(fast, TINY)
        else:
            self.grown *= grows
        self.error = max(self.error, UNIT_ROUNDOFF * fast) * grows + h * noise
        self.slack = max(self.slack, self.made / self.first) * grows + h * strain


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
        self.stretch0.set_state(state[:7])
        self.stretch1.set_state(state[7:14])
        self.closer, self.lost = state[14:]

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
        size0, size1, fast0, fast1 = rounding.size0, rounding.size1, rounding.fast0, rounding.fast1
        one.move(moved0, model.v0, allowed, size0, fast0)
        two.move(moved1, model.v1, allowed, size1, fast1)
        rate = 0.0
        if moved0 * gained0 > 0.0 or moved1 * gained1 > 0.0:
            rate = growth_rate(model, t)
        if rate == 0.0:
            self.leave()
            return
        off0 = one.off / max(size0, TINY)
        off1 = two.off / max(size1, TINY)
        slope0, slope1 = math.fabs(model.a0_q0), math.fabs(model.a0_q1)
        noise = UNIT_ROUNDOFF * (slope0 * size0 + slope1 * size1)
        strain = slope0 * off0 + slope1 * off1
        one.grow(h, rate, moved0, gained0, fast0, noise, strain)
        slope0, slope1 = math.fabs(model.a1_q0), math.fabs(model.a1_q1)
        noise = UNIT_ROUNDOFF * (slope0 * size0 + slope1 * size1)
        strain = slope0 * off0 + slope1 * off1
        two.grow(h, rate, moved1, gained1, fast1, noise, strain)
        self.note(one, rounding, fast0)
        self.note(two, rounding, fast1)

    def note(self, stretch: Stretch, rounding: Rounding, fast: float) -> None:
        """Note what errors have grown to, and how close further ones are to be held.

        By what the motion itself has grown, unless rounding leaves nothing of it.
        """
        if stretch.error == 0.0:
            return
        rounding.note(stretch.error, fast)
        if stretch.slack > self.lost * fast:
            self.lost = max(self.lost, stretch.slack / max(fast, stretch.slack))
        grown = min(stretch.grown, fast / stretch.first)
        if rounding.doubt * grown >= 1.0:
            self.closer = 1.0
        elif grown > LEAST:
            self.closer = max(self.closer, (grown / LEAST) * (grown / LEAST))


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

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
LEAST: Final = 10.0
#: logarithm of the growth in one step, at most
MOST: Final = 100.0
TINY: Final = 1e-300


class Stretch:
    """The present unstable stretch of one coordinate."""

    def __init__(self) -> None:
        #: of the rate, what rounding can have made of it; 0: there is no stretch
        self.error: float = 0.0
        #: by what errors made at its begin have grown, and the fastest rate until then
        self.grown: float = 1.0
        self.first: float = 0.0

    def take(self, other: Stretch) -> None:
        """Remember what `other` does."""
        self.error, self.grown, self.first = other.error, other.grown, other.first

    def grow(
        self, h: float, rate: float, moved: float, gained: float, noise: float, fast: float
    ) -> None:
        """Go on by a step of h s, in which coordinate and acceleration changed by these.

        rate: the fastest rate of growth, 1/s. noise: rounding of the acceleration. fast: the
        fastest rate of the coordinate so far.
        """
        if not moved * gained > 0.0:
            self.error = 0.0
            return
        grows = math.exp(min(h * min(rate, math.sqrt(gained / moved)), MOST))
        if self.error == 0.0:
            self.grown = 1.0
            self.first = max(fast, TINY)
        else:
            self.grown *= grows
        self.error = max(self.error, UNIT_ROUNDOFF * fast) * grows + h * noise


class Growth:
    """The unstable stretches of both coordinates, and what they ask of the steps that follow.

    A motion that leaves the neighbourhood of a rest grows by a factor. Where it returns, errors
    made meanwhile grow by the square of it, and so much closer are they to be held.
    """

    def __init__(self) -> None:
        self.stretch0 = Stretch()
        self.stretch1 = Stretch()
        #: by how much closer
        self.closer: float = 1.0

    def forget(self) -> None:
        """Before a first step."""
        self.leave()
        self.closer = 1.0

    def leave(self) -> None:
        """At the end of both stretches."""
        self.stretch0.error = 0.0
        self.stretch1.error = 0.0

    def take(self, other: Growth) -> None:
        """Remember what `other` does."""
        self.stretch0.take(other.stretch0)
        self.stretch1.take(other.stretch1)
        self.closer = other.closer

    def get_state(self) -> list[float]:
        """What is remembered from one communication step to the next."""
        one, two = self.stretch0, self.stretch1
        return [one.error, one.grown, one.first, two.error, two.grown, two.first, self.closer]

    def set_state(self, state: list[float]) -> None:
        """Return to what get_state() gave."""
        one, two = self.stretch0, self.stretch1
        one.error, one.grown, one.first = state[:3]
        two.error, two.grown, two.first, self.closer = state[3:]

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
    ) -> None:
        """Take in a step of h s to time t, in which coordinates and accelerations changed so."""
        rate = 0.0
        if moved0 * gained0 > 0.0 or moved1 * gained1 > 0.0:
            rate = growth_rate(model, t)
        if rate == 0.0:
            self.leave()
            return
        size0 = UNIT_ROUNDOFF * rounding.size0
        size1 = UNIT_ROUNDOFF * rounding.size1
        noise0 = math.fabs(model.a0_q0) * size0 + math.fabs(model.a0_q1) * size1
        noise1 = math.fabs(model.a1_q0) * size0 + math.fabs(model.a1_q1) * size1
        self.stretch0.grow(h, rate, moved0, gained0, noise0, rounding.fast0)
        self.stretch1.grow(h, rate, moved1, gained1, noise1, rounding.fast1)
        rounding.note(self.stretch0.error, rounding.fast0)
        rounding.note(self.stretch1.error, rounding.fast1)
        self.ask(self.stretch0, rounding.fast0, rounding.doubt)
        self.ask(self.stretch1, rounding.fast1, rounding.doubt)

    def ask(self, stretch: Stretch, fast: float, doubt: float) -> None:
        """Hold errors closer by what the motion has grown, unless rounding leaves nothing of it."""
        if stretch.error > 0.0:
            grown = min(stretch.grown, fast / stretch.first)
            if doubt * grown >= 1.0:
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

"""Whether the sweeps of a collocation step converge, and where rounding is all that they change."""

from __future__ import annotations

import math
from typing import Final, final

from .base import Model
from .rounding import NEGLIGIBLE, Rounding

__all__ = [
    *("CONVERGED", "DIVERGES", "FASTEST", "GOES_ON", "MOST_SWEEPS"),
    *("PRESUMED", "ROUNDING", "SLOWEST", "Course", "scale"),
]

# what comes out of a sweep
GOES_ON: Final = 0
CONVERGED: Final = 1
DIVERGES: Final = 2

#: sweeps converge to PART tolerance^POWER of the tolerance: what they leave adds up over the steps,
#: of which a smaller tolerance takes more, while errors of the symmetric method cancel where the
#: motion returns. By the least work for errors from 1e-4 to 1e-12.
PART: Final = 0.4
POWER: Final = 0.1
#: most sweeps in a step, and most of corrections in one of these
MOST_SWEEPS: Final = 12
#: the slowest convergence at which a step is not better halved
SLOWEST: Final = 0.5
#: the convergence that is counted on at most, and that as long as it is the last step's
FASTEST: Final = 0.003
PRESUMED: Final = 0.1
#: changes below this, relative, are rounding
ROUNDING: Final = 5e-16
TINY: Final = 1e-300


@final
class Course:
    """The sweeps of one step.

    Changes are relative to the rates of the coordinates, each for itself.
    """

    def __init__(self) -> None:
        #: 1 / size of the rates; 0 until measure()
        self.scale0: float = 0.0
        self.scale1: float = 0.0
        #: whether it is known what rounding makes of the accelerations, and that; else 0
        self.known: bool = False
        self.noise0: float = 0.0
        self.noise1: float = 0.0
        #: how much the last sweep changed, and the factor by which it did less than the one before
        self.change: float = 0.0
        self.contraction: float = SLOWEST
        #: part of the tolerance to which sweeps converge
        self.part: float = 0.0

    def choose_part(self, tolerance: float) -> None:
        """Before steps that are allowed that error."""
        self.part = PART * math.exp(POWER * math.log(tolerance))

    def begin(
        self, model: Model, rounding: Rounding, t: float, noisy: bool, contraction: float
    ) -> None:
        """Before the sweeps of a step from time t (s); contraction: that of the last step."""
        self.scale0 = 0.0
        self.scale1 = 0.0
        self.known = noisy
        self.noise0 = 0.0
        self.noise1 = 0.0
        self.change = 0.0
        self.contraction = contraction
        if noisy:
            rounding.look_closely(model, t)
            self.noise0 = rounding.noise0
            self.noise1 = rounding.noise1

    def look(self, model: Model, rounding: Rounding, t: float) -> None:
        """Find out what rounding makes of the accelerations."""
        self.known = True
        rounding.estimate(model, t)
        self.noise0 = rounding.noise0
        self.noise1 = rounding.noise1

    def outcome(
        self,
        model: Model,
        rounding: Rounding,
        t: float,
        h: float,
        sweep: int,
        change: float,
        tolerance: float,
    ) -> int:
        """What comes out of a sweep that made that change: GOES_ON or another."""
        left = change * max(self.contraction, PRESUMED)
        if self.change > 0.0:
            self.contraction = max(change / self.change, FASTEST)
            left = change * self.contraction
        self.change = change
        contraction = self.contraction if sweep > 1 else 0.0
        return self.judged(model, rounding, t, h, change, left, contraction, self.part * tolerance)

    def judged(
        self,
        model: Model,
        rounding: Rounding,
        t: float,
        h: float,
        change: float,
        left: float,
        contraction: float,
        allowed: float,
    ) -> int:
        """What comes out where a change leaves as much, and is that part of the one before."""
        if left <= max(allowed, ROUNDING):
            return CONVERGED
        if contraction > SLOWEST:
            if not self.known:
                self.look(model, rounding, t)
            if change <= h * (self.noise0 * self.scale0 + self.noise1 * self.scale1):
                return CONVERGED
            return DIVERGES
        return GOES_ON


def scale(v: float, w: float, h: float, a: float, b: float, size: float) -> float:
    """1 / size of a rate that goes from v to w within h s, with accelerations from a to b.

    size: that of its coordinate.
    """
    rate = max(math.fabs(v), math.fabs(w)) + h * max(math.fabs(a), math.fabs(b))
    return 1.0 / max(rate, NEGLIGIBLE * size / h + TINY)

"""Whether the sweeps of a collocation step converge, and where rounding is all that they change."""

from __future__ import annotations

import math
from typing import Final, final

from .base import Model
from .rounding import NEGLIGIBLE, Rounding

__all__ = [
    *("CONVERGED", "DIVERGES", "FASTEST", "GOES_ON", "MOST_SWEEPS", "OPEN"),
    *("PRESUMED", "ROUNDING", "SLOWEST", "Course", "scale"),
]

# what comes out of a sweep
GOES_ON: Final = 0
CONVERGED: Final = 1
DIVERGES: Final = 2

#: changes from this on, relative, leave open how large the rates are, and how much is left: less
#: than the quadrature's last weight, so that a last stage that was thrown far passes for no size
OPEN: Final = 0.01
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

    Errors and `change` are relative to the rates of the coordinates, each for itself.
    """

    def __init__(self) -> None:
        #: 1 / size of the rates; 0 until measure()
        self.scale0: float = 0.0
        self.scale1: float = 0.0
        #: whether it is known what rounding makes of the accelerations, and that; else 0
        self.known: bool = False
        self.noise0: float = 0.0
        self.noise1: float = 0.0
        #: how much the last sweep changed both rates, and the larger of them, relative; 0: none has
        self.change0: float = 0.0
        self.change1: float = 0.0
        self.change: float = 0.0
        #: factor by which it, or a correction of Newton's method, did less than the one before
        self.contraction: float = SLOWEST

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

    def measure(self, scale0: float, scale1: float) -> None:
        """Set 1 / size of both rates."""
        self.scale0 = scale0
        self.scale1 = scale1
        if self.change > 0.0:
            self.change = max(self.change0 * scale0, self.change1 * scale1)

    def weigh(self, change0: float, change1: float) -> float:
        """The larger of changes of both rates, relative to each."""
        self.change0 = change0
        self.change1 = change1
        return max(change0 * self.scale0, change1 * self.scale1)

    def outcome(
        self,
        model: Model,
        rounding: Rounding,
        t: float,
        h: float,
        sweep: int,
        change0: float,
        change1: float,
        allowed: float,
    ) -> int:
        """What comes out of a sweep that changed the rates as much: GOES_ON or another.

        allowed: what further sweeps may change yet, all together.
        """
        change = self.weigh(change0, change1)
        contraction = max(self.contraction, PRESUMED)
        if self.change > 0.0:
            self.contraction = contraction = max(change / self.change, FASTEST)
        self.change = change
        left = change * contraction
        allowed *= 1.0 - contraction
        slow = contraction if sweep > 1 else 0.0
        return self.judged(model, rounding, t, h, change, left, slow, allowed)

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
        if change < OPEN and left <= max(allowed, ROUNDING):
            return CONVERGED
        if contraction > SLOWEST:
            if not self.known:
                self.look(model, rounding, t)
            if self.change0 <= h * self.noise0 and self.change1 <= h * self.noise1:
                return CONVERGED
            return DIVERGES
        return GOES_ON


def scale(v: float, w: float, h: float, a: float, b: float, size: float) -> float:
    """1 / size of a rate that goes from v to w within h s, with accelerations from a to b.

    size: that of its coordinate.
    """
    rate = max(math.fabs(v), math.fabs(w)) + h * max(math.fabs(a), math.fabs(b))
    return 1.0 / max(rate, NEGLIGIBLE * size / h + TINY)

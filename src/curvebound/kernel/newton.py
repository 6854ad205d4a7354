"""The stages of a Lobatto step of one coordinate, found by Newton's method.

Where the step is a hundredth to 1.6 times as long as the last, the first sweep evaluates the two
middle stages, and what the guess has missed there extends it; else it evaluates all. The second
takes the derivatives at all stages, too: the corrections by which the accelerations meet their
values to first order are found at once, by sweeps that take no evaluation. They square what was
left, and where that is not enough, the same derivatives serve for further ones. The equations cost
more than the sums only where there is one coordinate: with two, derivatives cost more than they
save.
"""

from __future__ import annotations

import math
from typing import Final, final

from .base import Model
from .course import (
    CONVERGED,
    DIVERGES,
    FASTEST,
    GOES_ON,
    MOST_SWEEPS,
    OPEN,
    PRESUMED,
    ROUNDING,
    SLOWEST,
    Course,
    scale,
)
from .lobatto_tables import LAGRANGE_3_4, NODES, STAGES, A, R, Stages
from .polynomial import FARTHEST, NEAR, NEAREST, extend, extrapolated, miss, span, tail
from .rounding import Rounding
from .stages import LAST, LATE, apart, copy, fill, follow, weighted

__all__ = ["ANOTHER", "Newton"]

#: for an error: another coordinate moves
ANOTHER: Final = -1.0
#: the first stage that the first sweep evaluates where the guess is extended
FIRST: Final = 3
#: part of the tolerance to which sweeps converge: most leave far less, single ones a little more
PART: Final = 0.5
#: what corrections leave of a change, relative to its square, in most steps (tests/integrators):
#: of accelerations that depend on the coordinate, and on the rate, too
CURVATURE: Final = 0.01
CURVATURE_BY_RATES: Final = 0.1
#: how far corrections may be off: in units of what sweeps may leave, and of their own square
OFF: Final = 0.01
SQUARED: Final = 1e-3


@final
class Newton:
    """What the method found last: accelerations at the stages."""

    def __init__(self) -> None:
        self.a: Stages = [0.0] * STAGES
        # derivatives of the acceleration by the coordinate and by its rate
        self.a_x: Stages = [0.0] * STAGES
        self.a_u: Stages = [0.0] * STAGES
        #: of the equations of motion, for the caller to count
        self.evaluations: int = 0
        #: whether derivatives have failed
        self.failed: bool = False
        #: how much the other coordinate is accelerated
        self.other: float = 0.0

    def solve(
        self,
        model: Model,
        rounding: Rounding,
        course: Course,
        last: Stages,
        last_h: float,
        t: float,
        h: float,
        a0: float,
        tolerance: float,
    ) -> float:
        """Find the accelerations at the stages of a step of h s from time t (s), where it is a0.

        last: those of the step before, of last_h s; 0: there was none. Returns the estimated error
        relative to the rate, as lobatto.Collocation.step() does, or ANOTHER.
        """
        q1 = model.q1
        v1 = model.v1
        rates = model.uses_rates
        # accelerations, before a sweep, by how much they miss, corrections, and those before;
        # coordinates and rates, and by how much corrections shift them
        a: Stages = [0.0] * STAGES
        f: Stages = [0.0] * STAGES
        r: Stages = [0.0] * STAGES
        d: Stages = [0.0] * STAGES
        e: Stages = [0.0] * STAGES
        x: Stages = [0.0] * STAGES
        u: Stages = [0.0] * STAGES
        y: Stages = [0.0] * STAGES
        w: Stages = [0.0] * STAGES
        # the nodal polynomial, and what the guess has missed
        nodal: Stages = [0.0] * STAGES
        lack: Stages = [0.0] * STAGES
        ratio = 0.0
        if 0.0 < h <= FARTHEST * last_h:
            ratio = 2.0 * h / last_h
            a[1:8] = extrapolated(last, a0, ratio)
        else:
            fill(a, a0)
        a[0], x[0], u[0] = a0, model.q0, model.v0
        self.other = 0.0
        unit = rest = 0.0
        near: bool = NEAREST * last_h <= h <= NEAR * last_h
        allowed = PART * tolerance
        off = OFF * max(allowed, ROUNDING)
        for sweep in range(MOST_SWEEPS):
            copy(a, f)
            if sweep == 0:
                if not near:
                    follow(rates, h, a, x, u, 1, FIRST)
                    evaluate(self, model, t, h, x, q1, u, v1, a, 1, FIRST)
                follow(rates, h, a, x, u, FIRST, LATE)
                evaluate(self, model, t, h, x, q1, u, v1, a, FIRST, LATE)
                if near:
                    span(ratio, nodal)
                    miss(f, nodal, a, lack, FIRST, LATE)
                    extend(f, nodal, lack, LAGRANGE_3_4, FIRST, 2, a, 1, FIRST)
                    extend(f, nodal, lack, LAGRANGE_3_4, FIRST, 2, a, LATE, STAGES)
                follow(True, h, a, x, u, LAST, STAGES)
                course.scale0 = scale(u[0], u[7], h, a0, a[7], rounding.size0)
                unit = h * course.scale0
                if near and unit * apart(a, f) * PRESUMED > allowed:
                    if self.other != 0.0:
                        return ANOTHER
                    continue
                follow(rates, h, a, x, u, LATE, LAST)
                evaluate(self, model, t, h, x, q1, u, v1, a, LATE, STAGES)
                change = course.weigh(h * apart(a, f), 0.0)
                contraction = max(course.contraction, PRESUMED)
            else:
                follow(rates, h, a, x, u, 1, STAGES)
                if sweep == 1:
                    self.failed = True
                    linearise(self, model, t, h, x, q1, u, v1, a)
                    self.failed = False
                else:
                    evaluate(self, model, t, h, x, q1, u, v1, a, 1, STAGES)
                if not 0.0 < course.change < OPEN:
                    if not rates:
                        follow(True, h, f, x, u, LAST, STAGES)
                    course.measure(scale(u[0], u[7], h, a0, a[7], rounding.size0), 0.0)
                    unit = h * course.scale0
                subtract(a, f, r)
                copy(r, d)
                before = course.change
                change = course.weigh(h * apart(a, f), 0.0)
                enough = max(off, SQUARED * change * change)
                converges: bool = True
                shifted_before = 0.0
                for _ in range(MOST_SWEEPS):
                    copy(d, e)
                    shift(rates, h, d, y, w, 1, LATE)
                    correct(self, rates, r, y, w, d, 1, LATE)
                    shift(rates, h, d, y, w, LATE, STAGES)
                    correct(self, rates, r, y, w, d, LATE, STAGES)
                    shifted = unit * apart(d, e)
                    if shifted_before > 0.0:
                        # corrections are sweeps of the linearised equations
                        course.contraction = max(shifted / shifted_before, FASTEST)
                        converges = course.contraction <= SLOWEST
                        if not converges:
                            break
                    rest = shifted * min(course.contraction, SLOWEST)
                    if rest <= enough:
                        break
                    shifted_before = shifted
                if not converges:
                    # the sweep as it is
                    copy(r, d)
                    rest = 0.0
                add(f, d, a)
                contraction = course.contraction
                if before > 0.0:
                    contraction = max(change / before, FASTEST)
                if not converges:
                    contraction = max(contraction, course.contraction)
                elif sweep == 1:
                    contraction = (CURVATURE_BY_RATES if rates else CURVATURE) * change
            if self.other != 0.0:
                return ANOTHER
            course.change = change
            left = change * contraction + rest
            slow = contraction if sweep > 1 else 0.0
            outcome = course.judged(model, rounding, t, h, change, left, slow, allowed)
            if outcome == DIVERGES:
                return math.inf
            if sweep == 0:
                if outcome == GOES_ON:
                    continue
                if near:
                    # there is no other sweep that would
                    follow(rates, h, a, x, u, 1, FIRST)
                    evaluate(self, model, t, h, x, q1, u, v1, a, 1, FIRST)
                    if self.other != 0.0:
                        return ANOTHER
            # known well enough after two sweeps to spare the further ones of too large a step
            error = course.scale0 * (h * tail(course.noise0, *a))
            if not error <= tolerance and not course.known:
                # less what is rounding, which shorter steps have too
                course.look(model, rounding, t)
                error = course.scale0 * (h * tail(course.noise0, *a))
            if outcome == CONVERGED or not error <= tolerance:
                copy(a, self.a)
                return error
        return math.inf


# -- over the stages: written out where they are called when compiled (runtime.WRITTEN_OUT) --------
# fmt: off
def evaluate(
    newton: Newton, model: Model, t: float, h: float, x: Stages, q1: float, u: Stages, v1: float,
    a: Stages, start: int, stop: int,
) -> None:
    """Set the accelerations a at the stages start to stop - 1."""
    for i in range(start, stop):
        model.acceleration(t + NODES[i] * h, x[i], q1, u[i], v1)
        a[i] = model.a0
        newton.other += math.fabs(model.a1)
    newton.evaluations += stop - start


def linearise(
    newton: Newton, model: Model, t: float, h: float, x: Stages, q1: float, u: Stages, v1: float,
    a: Stages,
) -> None:
    """Set the accelerations a at all stages, and their derivatives there."""
    for i in range(1, STAGES):
        model.jacobian(t + NODES[i] * h, x[i], q1, u[i], v1)
        a[i] = model.a0
        newton.other += math.fabs(model.a1)
        newton.a_x[i] = model.a0_q0
        newton.a_u[i] = model.a0_v0
    newton.evaluations += STAGES - 1


def correct(
    newton: Newton, rates: bool, r: Stages, y: Stages, w: Stages, d: Stages, start: int, stop: int,
) -> None:
    """Set the corrections d of the stages start to stop - 1, which are shifted by y and w."""
    for i in range(start, stop):
        d[i] = r[i] + newton.a_x[i] * y[i]
    if rates:
        for i in range(start, stop):
            d[i] += newton.a_u[i] * w[i]
# fmt: on


def shift(rates: bool, h: float, k: Stages, x: Stages, w: Stages, start: int, stop: int) -> None:
    """Set by how much corrections k shift the stages start to stop - 1."""
    for i in range(start, stop):
        x[i] = h * h * weighted(R, STAGES * i, k, i % LAST - STAGES)
    if rates:
        for i in range(start, stop):
            w[i] = h * weighted(A, STAGES * i, k, i - STAGES)


def subtract(k: Stages, before: Stages, target: Stages) -> None:
    """Set all but the first element of target to the difference."""
    for i in range(1, STAGES):
        target[i] = k[i] - before[i]


def add(k: Stages, correction: Stages, target: Stages) -> None:
    """Set all but the first element of target to the sum."""
    for i in range(1, STAGES):
        target[i] = k[i] + correction[i]

"""One step of the eight-stage Lobatto IIIA method, order 14, solved by sweeps.

Collocation at the Lobatto points c0 = 0 < c1 < ... < c7 = 1 (Hairer, Norsett, Wanner 1993,
sec. II.7; Hairer, Wanner 1996, sec. IV.5). With K_j the accelerations at the points, a step of h s
has the stages

    V_i = v + h sum_j A_ij K_j,    Q_i = q + c_i h v + h^2 sum_j R_ij K_j,    R = A A

The first guess of the K_j extrapolates the polynomial through those of the last step. A sweep
evaluates them anew, the early half with the old ones, the late half with the new early ones, and
gains two to three digits. The first one of a step that is a hundredth to 1.6 times as long as the
last goes through stages 1, 2, 3 and 4, and the late ones, and where the guess misses more than is
allowed, each of these groups extends the guess of those that follow. The evaluations of a half do
not wait for each other, and the sums are added in pairs: the processor overlaps them. Where one
coordinate moves alone, newton.Newton finds them.
"""

from __future__ import annotations

import math
from typing import Final, final

from .base import Model
from .course import (
    CONVERGED,
    DIVERGES,
    GOES_ON,
    MOST_SWEEPS,
    OPEN,
    SLOWEST,
    Course,
    scale,
)
from .lobatto_tables import (
    LAGRANGE_1,
    LAGRANGE_1_2,
    LAGRANGE_1_TO_4,
    NODES,
    STAGES,
    WEIGHTS,
    Stages,
)
from .newton import ANOTHER, Newton
from .polynomial import FARTHEST, NEAR, NEAREST, extend, extrapolated, miss, span, tail
from .rounding import Rounding
from .stages import LAST, LATE, apart, copy, fill, follow

__all__ = ["Collocation"]

#: sweeps converge to a part of a step's tolerance, PART tolerance^POWER of a communication step's.
#: What they leave adds up over the steps, of which a smaller tolerance takes more, while errors of
#: the symmetric method cancel where the motion returns. By the least work for errors from 1e-4 to
#: 1e-12.
PART: Final = 0.4
POWER: Final = 0.1
#: part of the tolerance to which an error has to come up for rounding to be forgotten
BELOW: Final = 0.01
#: what lies above, or is no number, has left the finite numbers; cheaper than math.isfinite here
LARGEST: Final = 1e300


@final
class Collocation:
    """The step, and its memory: accelerations a of q0 and b of q1 at the points of the last."""

    def __init__(self) -> None:
        self.a: Stages = [0.0] * STAGES
        self.b: Stages = [0.0] * STAGES
        #: accelerations at the end of the last step
        self.a7: float = 0.0
        self.b7: float = 0.0
        #: s, size of the last step; 0: there was none
        self.h: float = 0.0
        #: factor by which its last sweep reduced the change
        self.contraction: float = SLOWEST
        #: whether to look closely at rounding in the next step, for it may be all that there is
        self.noisy: bool = False
        #: part of its tolerance to which the sweeps of a step converge
        self.part: float = 0.0
        #: sweeps made, for the caller to count
        self.sweeps: int = 0
        self.course = Course()
        self.newton = Newton()
        #: whether Newton's method is left alone, for there are no derivatives
        self.plain: bool = False

    def begin(self, tolerance: float) -> None:
        """Forget counts: before a communication step whose steps may have errors of `tolerance`."""
        self.part = PART * math.exp(POWER * math.log(tolerance))
        self.sweeps = 0
        self.plain = False
        self.newton.evaluations = 0
        self.newton.failed = False

    def take(self, other: Collocation) -> None:
        """Remember what `other` does."""
        copy(other.a, self.a)
        copy(other.b, self.b)
        self.a7 = other.a7
        self.b7 = other.b7
        self.h = other.h
        self.contraction = other.contraction
        self.noisy = other.noisy

    def get_state(self) -> list[float]:
        """All that the next step depends on."""
        a = [self.a[i] for i in range(STAGES)]
        b = [self.b[i] for i in range(STAGES)]
        return [*a, *b, self.h, self.contraction, 1.0 if self.noisy else 0.0]

    def set_state(self, state: list[float]) -> None:
        """Return to what get_state() gave."""
        for i in range(STAGES):
            self.a[i] = state[i]
            self.b[i] = state[STAGES + i]
        self.a7 = self.a[7]
        self.b7 = self.b[7]
        self.h, self.contraction, noisy = state[2 * STAGES :]
        self.noisy = noisy != 0.0

    def step(
        self,
        model: Model,
        rounding: Rounding,
        t: float,
        h: float,
        a0: float,
        b0: float,
        tolerance: float,
    ) -> float:
        """Try a step of h s from time t (s), where the acceleration is (a0, b0).

        Returns the estimated error relative to the rates of the coordinates: up to `tolerance`
        the model's state and work have been advanced, else they are as before. Infinite: the
        sweeps, which converge to a part of it, diverge. Lets the model's ArithmeticError and
        ValueError pass.
        """
        q0, q1, v0, v1 = model.q0, model.q1, model.v0, model.v1
        # accelerations of both coordinates at the stages, the coordinates there and their rates
        a: Stages = [0.0] * STAGES
        b: Stages = [0.0] * STAGES
        x: Stages = [0.0] * STAGES
        y: Stages = [0.0] * STAGES
        u: Stages = [0.0] * STAGES
        w: Stages = [0.0] * STAGES
        # accelerations before a sweep, the nodal polynomial, and what the guess has missed
        f: Stages = [0.0] * STAGES
        g: Stages = [0.0] * STAGES
        nodal: Stages = [0.0] * STAGES
        lack0: Stages = [0.0] * STAGES
        lack1: Stages = [0.0] * STAGES
        # a coordinate that rests is left out until a sweep finds an acceleration of it
        two: bool = q1 != 0.0 or v1 != 0.0 or b0 != 0.0
        # nor are rates at the stages needed that no acceleration depends on
        rates = model.uses_rates
        fill(b, b0)
        a[0], x[0], u[0] = a0, q0, v0
        b[0], y[0], w[0] = b0, q1, v1
        fill(y, q1)
        fill(w, v1)
        course = self.course
        course.begin(model, rounding, t, self.noisy, self.contraction)
        error = ANOTHER
        if not two and not self.plain:
            newton = self.newton
            error = newton.solve(model, rounding, course, self.a, self.h, t, h, a0, tolerance)
            if error == ANOTHER:
                two = True
                course.begin(model, rounding, t, self.noisy, self.contraction)
            elif not error <= tolerance:
                return error
            else:
                copy(newton.a, a)
        if error == ANOTHER:
            allowed = self.part * tolerance
            extends: bool = False
            near: bool = NEAREST * self.h <= h <= NEAR * self.h
            if 0.0 < h <= FARTHEST * self.h:
                r = 2.0 * h / self.h
                a[1:8] = extrapolated(self.a, a0, r)
                if two:
                    b[1:8] = extrapolated(self.b, b0, r)
                if near:
                    span(r, nodal)
            else:
                fill(a, a0)
            for sweep in range(MOST_SWEEPS):
                copy(a, f)
                copy(b, g)
                if sweep == 0 and near:
                    place(two, rates, h, a, x, u, b, y, w, 1, 2)
                    evaluate(model, t, h, x, y, u, w, a, b, 1, 2)
                    miss(f, nodal, a, lack0, 1, 2)
                    miss(g, nodal, b, lack1, 1, 2)
                    # what the guess misses at the end by that; less is disturbed by rounding only
                    off0 = math.fabs(lack0[1] * nodal[7]) * scale(
                        v0, v0, h, a0, a[1], rounding.size0
                    )
                    off1 = math.fabs(lack1[1] * nodal[7]) * scale(
                        v1, v1, h, b0, b[1], rounding.size1
                    )
                    extends = h * max(off0, off1) > allowed
                    if extends:
                        proceed(two, f, g, nodal, lack0, lack1, LAGRANGE_1, 2, a, b, 2)
                    place(two, rates, h, a, x, u, b, y, w, 2, 3)
                    evaluate(model, t, h, x, y, u, w, a, b, 2, 3)
                    if extends:
                        proceed(two, f, g, nodal, lack0, lack1, LAGRANGE_1_2, 2, a, b, 3)
                    place(two, rates, h, a, x, u, b, y, w, 3, LATE)
                    evaluate(model, t, h, x, y, u, w, a, b, 3, LATE)
                    if extends:
                        proceed(two, f, g, nodal, lack0, lack1, LAGRANGE_1_TO_4, 3, a, b, LATE)
                else:
                    place(two, rates, h, a, x, u, b, y, w, 1, LATE)
                    evaluate(model, t, h, x, y, u, w, a, b, 1, LATE)
                place(two, rates, h, a, x, u, b, y, w, LATE, LAST)
                place(two, True, h, a, x, u, b, y, w, LAST, STAGES)
                evaluate(model, t, h, x, y, u, w, a, b, LATE, STAGES)
                self.sweeps += 1
                if not two:
                    two = moves(b)
                    if two:
                        course.change = 0.0
                        continue
                if sweep == 0 and extends:
                    # the guess tells neither sizes nor how sweeps converge
                    continue
                if not 0.0 < course.change < OPEN:
                    course.measure(
                        scale(v0, u[7], h, a0, a[7], rounding.size0),
                        scale(v1, w[7], h, b0, b[7], rounding.size1),
                    )
                change0 = h * apart(a, f)
                change1 = h * apart(b, g) if two else 0.0
                outcome = course.outcome(model, rounding, t, h, sweep, change0, change1, allowed)
                if outcome == DIVERGES:
                    return math.inf
                if outcome == GOES_ON and sweep != (2 if extends else 1):
                    continue
                # known well enough by now to spare the further sweeps of too large a step
                error = estimated(course, two, h, a, b)
                if not error <= tolerance and not course.known:
                    # less what is rounding, which shorter steps have too
                    course.look(model, rounding, t)
                    error = estimated(course, two, h, a, b)
                if not error <= tolerance:
                    return error
                if outcome == CONVERGED:
                    break
            else:
                return math.inf
        work = 0.0
        if model.works:
            p: Stages = [0.0] * STAGES
            place(two, True, h, a, x, u, b, y, w, 1, STAGES)
            find_powers(model, t, h, x, y, u, w, a, b, p)
            work = quadrature(p)
        else:
            place(two, True, h, a, x, u, b, y, w, LAST, STAGES)
        if not math.fabs(x[7]) + math.fabs(y[7]) + math.fabs(u[7]) + math.fabs(w[7]) <= LARGEST:
            return math.inf
        model.q0, model.q1, model.v0, model.v1 = x[7], y[7], u[7], w[7]
        model.work += h * work
        copy(a, self.a)
        copy(b, self.b)
        self.a7, self.b7 = a[7], b[7]
        self.h = h
        self.contraction = course.contraction
        if course.known:
            self.noisy = error <= BELOW * tolerance
        return error


# -- over the stages: written out where they are called when compiled (runtime.WRITTEN_OUT) --------
# fmt: off
def place(
    two: bool, rates: bool, h: float, a: Stages, x: Stages, u: Stages, b: Stages, y: Stages,
    w: Stages, start: int, stop: int,
) -> None:
    """Set the stages start to stop - 1 of one coordinate or two, with their rates or without."""
    follow(rates, h, a, x, u, start, stop)
    if two:
        follow(rates, h, b, y, w, start, stop)


def proceed(
    two: bool, f: Stages, g: Stages, nodal: Stages, lack0: Stages, lack1: Stages,
    weights: list[float], start: int, a: Stages, b: Stages, stop: int,
) -> None:
    """Extend the guesses f and g from stage `stop` on; those from `start` to it are new."""
    miss(f, nodal, a, lack0, start, stop)
    extend(f, nodal, lack0, weights, 1, stop - 1, a, stop, STAGES)
    if two:
        miss(g, nodal, b, lack1, start, stop)
        extend(g, nodal, lack1, weights, 1, stop - 1, b, stop, STAGES)


def evaluate(
    model: Model, t: float, h: float, x: Stages, y: Stages, u: Stages, w: Stages,
    a: Stages, b: Stages, start: int, stop: int,
) -> None:
    """Set the accelerations a and b at the stages start to stop - 1."""
    for i in range(start, stop):
        model.acceleration(t + NODES[i] * h, x[i], y[i], u[i], w[i])
        a[i] = model.a0
        b[i] = model.a1


def find_powers(
    model: Model, t: float, h: float, x: Stages, y: Stages, u: Stages, w: Stages,
    a: Stages, b: Stages, p: Stages,
) -> None:
    """Set p to the power at all stages."""
    for i in range(STAGES):
        p[i] = model.power(t + NODES[i] * h, x[i], y[i], u[i], w[i], a[i], b[i])
# fmt: on


def quadrature(p: Stages) -> float:
    """The mean of p over the step: with row 7 of A."""
    return (
        WEIGHTS[0] * p[0]
        + WEIGHTS[1] * p[1]
        + WEIGHTS[2] * p[2]
        + WEIGHTS[3] * p[3]
        + WEIGHTS[4] * p[4]
        + WEIGHTS[5] * p[5]
        + WEIGHTS[6] * p[6]
        + WEIGHTS[7] * p[7]
    )


def moves(k: Stages) -> bool:
    """Whether one of the accelerations but the first is not zero."""
    return (k[1] != 0.0 or k[2] != 0.0 or k[3] != 0.0 or k[4] != 0.0) or (
        k[5] != 0.0 or k[6] != 0.0 or k[7] != 0.0
    )


def estimated(course: Course, two: bool, h: float, a: Stages, b: Stages) -> float:
    """The error of the step with the accelerations a and b, zero unless there are two."""
    return h * max(
        course.scale0 * tail(course.noise0, *a),
        course.scale1 * tail(course.noise1, *b) if two else 0.0,
    )

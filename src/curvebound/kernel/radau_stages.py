"""The accelerations at the stages of a Radau IIA step, found by Newton's method.

The model's Jacobian at every stage makes the matrix, so that neither damping nor a stiff constraint
limits the step. It is kept while the iteration converges well. Residuals that are left count as
rounding only where the matrix is that of the present stages: one of before hides those along a
curve behind the stiffness that holds the motion to it.
"""

from __future__ import annotations

import math
from typing import Annotated, Final

from .base import Model
from .elimination import Exchanges, Matrix, Vector, factorised, substitute
from .radau_tables import HIGHEST, NEXT, NODES, STAGES, A, B
from .rounding import Rounding

__all__ = ["Stages"]

#: Newton corrections below this, relative, are rounding
ROUNDING: Final = 1e-14
#: corrections below this that shrink no more are the noise of the model's own arithmetic
NOISE: Final = 1e-8
EPSILON: Final = 2.220446049250313e-16
#: residuals below this, relative to the accelerations, are none whatever the matrix
CLOSE: Final = 1e-12
#: how far corrections can be above the rounding of the accelerations
SPREAD: Final = 8.0
#: sets of stages that are compared to see what rounding makes of them
PROBES: Final = 2
#: the contraction beyond which the matrix is made anew, and the most that is made of it
SLOW: Final = 0.05
MOST_ITERATIONS: Final = 15
LARGEST: Final = 1e300


class Stages:
    """The stages of a step, and room to find them in: they remember nothing."""

    def __init__(self) -> None:
        #: of the equations of motion, for the caller to count
        self.evaluations: int = 0
        # accelerations at the stages
        self.a: Annotated[list[float], STAGES] = [0.0] * STAGES
        self.b: Annotated[list[float], STAGES] = [0.0] * STAGES
        # stages: coordinates and rates
        self.x0: Annotated[list[float], STAGES] = [0.0] * STAGES
        self.x1: Annotated[list[float], STAGES] = [0.0] * STAGES
        self.w0: Annotated[list[float], STAGES] = [0.0] * STAGES
        self.w1: Annotated[list[float], STAGES] = [0.0] * STAGES
        #: residuals, and corrections
        self.left: Vector = [0.0] * (2 * STAGES)
        self.r: Vector = [0.0] * (2 * STAGES)
        #: the largest accelerations
        self.most0: float = 0.0
        self.most1: float = 0.0
        #: the factorised Newton matrix by rows, and its row exchanges
        self.m: Matrix = [0.0] * (4 * STAGES * STAGES)
        self.rows: Exchanges = [0] * (2 * STAGES)
        #: largest slopes of both accelerations by q0, q1, v0, v1
        self.slopes: Annotated[list[float], 8] = [0.0] * 8
        #: what the rounding of coordinates and rates makes of the accelerations
        self.noise0: float = 0.0
        self.noise1: float = 0.0
        #: and of the new rates, where it was looked at
        self.off0: float = 0.0
        self.off1: float = 0.0
        #: units of the Newton matrix
        self.unit0: float = 1.0
        self.unit1: float = 1.0

    def place(self, model: Model, h: float) -> None:
        """The stages that belong to the accelerations."""
        a = self.a
        b = self.b
        q0, q1, v0, v1 = model.q0, model.q1, model.v0, model.v1
        hh = h * h
        for i in range(STAGES):
            row = STAGES * i
            y0 = y1 = z0 = z1 = 0.0
            for j in range(STAGES):
                f = A[row + j]
                g = B[row + j]
                y0 += f * a[j]
                y1 += f * b[j]
                z0 += g * a[j]
                z1 += g * b[j]
            ch = NODES[i] * h
            self.w0[i] = v0 + h * y0
            self.w1[i] = v1 + h * y1
            self.x0[i] = q0 + (ch * v0 + hh * z0)
            self.x1[i] = q1 + (ch * v1 + hh * z1)

    def solve(self, model: Model, rounding: Rounding, t: float, h: float) -> bool:
        """Newton's method for the accelerations; leaves the stages that belong to them."""
        a = self.a
        b = self.b
        r = self.r
        left = self.left
        fresh = False
        before = math.inf
        least = math.inf
        stalls = 0
        # corrections are measured by what moves the rates by as much as they are
        unit0 = math.fabs(model.v0) / h
        unit1 = math.fabs(model.v1) / h
        # the equations are scaled by what their corrections begin with, if that is more
        scaled = False
        for _ in range(MOST_ITERATIONS):
            self.place(model, h)
            left0 = left1 = 0.0
            for i in range(STAGES):
                model.acceleration(t + NODES[i] * h, self.x0[i], self.x1[i], self.w0[i], self.w1[i])
                f0 = model.a0 - a[i]
                f1 = model.a1 - b[i]
                left0 = max(left0, math.fabs(f0))
                left1 = max(left1, math.fabs(f1))
                left[i] = f0
                left[STAGES + i] = f1
            self.evaluations += STAGES
            if unit0 == 0.0 or unit1 == 0.0:
                # from rest: by the accelerations
                unit0 = unit0 or left0
                unit1 = unit1 or left1
                unit0 = unit0 or unit1 or 1.0
                unit1 = unit1 or unit0
            if not scaled:
                self.unit0 = max(unit0, left0)
                self.unit1 = max(unit1, left1)
                scaled = True
            made = not fresh
            if made:
                if not self.factorise(model, t, h):
                    return False
                fresh = True
            self.correct()
            size = self.moved(unit0, unit1)
            close = left0 <= CLOSE * max(self.most0, unit0)
            close = close and left1 <= CLOSE * max(self.most1, unit1)
            if not made and not close and (size <= ROUNDING or size > 0.5 * least):
                # a matrix of before may hide what is left
                if not self.factorise(model, t, h):
                    return False
                self.correct()
                size = self.moved(unit0, unit1)
            for i in range(STAGES):
                a[i] += r[i]
                b[i] += r[STAGES + i]
            if not size + self.most0 + self.most1 <= LARGEST:
                return False
            if size <= ROUNDING:
                break
            if size > 0.5 * least:
                stalls += 1
                if stalls >= 2:
                    rounding.look(model, t)
                    self.round_off(rounding)
                    if size <= NOISE or (left0 <= self.noise0 and left1 <= self.noise1):
                        break
                    if stalls >= 5:
                        return False
            if size > SLOW * before and size > NOISE:
                fresh = False
            before = size
            least = min(least, size)
        else:
            return False
        self.place(model, h)
        self.round_off(rounding)
        return True

    def sizes(self, rounding: Rounding) -> tuple[float, float, float, float]:
        """The largest coordinates, so far and at the stages, and the largest rates there."""
        x0 = rounding.size0
        x1 = rounding.size1
        w0 = w1 = 0.0
        for i in range(STAGES):
            x0 = max(x0, math.fabs(self.x0[i]))
            x1 = max(x1, math.fabs(self.x1[i]))
            w0 = max(w0, math.fabs(self.w0[i]))
            w1 = max(w1, math.fabs(self.w1[i]))
        return x0, x1, w0, w1

    def round_off(self, rounding: Rounding) -> None:
        """Find what rounding makes of the accelerations of the present stages."""
        x0, x1, w0, w1 = self.sizes(rounding)
        s = self.slopes
        noise0 = (s[0] * x0 + s[1] * x1) + (s[2] * w0 + s[3] * w1)
        noise1 = (s[4] * x0 + s[5] * x1) + (s[6] * w0 + s[7] * w1)
        # at twice as many points as those at which it was looked at, or more
        self.noise0 = max(SPREAD * EPSILON * noise0, 2.0 * rounding.scatter0)
        self.noise1 = max(SPREAD * EPSILON * noise1, 2.0 * rounding.scatter1)

    def look(self, model: Model, rounding: Rounding, t: float, h: float) -> None:
        """Find what rounding makes of the accelerations as Newton's method passes it on.

        From how its corrections differ between stages that are all but equal: what a stiff
        direction makes of rounding is not in the accelerations that keep to it.
        """
        r = self.r
        left = self.left
        a = self.a
        b = self.b
        x0, x1, y0, y1 = self.sizes(rounding)
        if not self.factorise(model, t, h):
            return
        noise0 = noise1 = 0.0
        last = STAGES * (STAGES - 1)
        sign = EPSILON
        for k in range(PROBES + 1):
            for i in range(STAGES):
                p, q, v, w = self.x0[i], self.x1[i], self.w0[i], self.w1[i]
                if k > 0:
                    # by their own signs: alike for a motion and its mirror image
                    p += k * sign * math.copysign(x0, p)
                    w += k * sign * math.copysign(y1, w)
                    sign = -sign
                    q += k * sign * math.copysign(x1, q)
                    v += k * sign * math.copysign(y0, v)
                model.acceleration(t + NODES[i] * h, p, q, v, w)
                left[i] = model.a0 - a[i]
                left[STAGES + i] = model.a1 - b[i]
            sign = -sign
            self.evaluations += STAGES
            self.correct()
            high0 = next0 = high1 = next1 = end0 = end1 = 0.0
            for i in range(STAGES):
                high0 += HIGHEST[i] * r[i]
                next0 += NEXT[i] * r[i]
                end0 += A[last + i] * r[i]
                high1 += HIGHEST[i] * r[STAGES + i]
                next1 += NEXT[i] * r[STAGES + i]
                end1 += A[last + i] * r[STAGES + i]
            noise0 = max(noise0, max(math.fabs(high0), math.fabs(next0)))
            noise1 = max(noise1, max(math.fabs(high1), math.fabs(next1)))
            self.off0 = max(self.off0, h * math.fabs(end0))
            self.off1 = max(self.off1, h * math.fabs(end1))
        self.noise0 = min(self.noise0, SPREAD * noise0)
        self.noise1 = min(self.noise1, SPREAD * noise1)

    def factorise(self, model: Model, t: float, h: float) -> bool:
        """The Newton matrix I - h^2 B dK/dq - h A dK/dv, in the units, and its triangles."""
        m = self.m
        n = 2 * STAGES
        hh = h * h
        ratio = self.unit1 / self.unit0
        slopes = self.slopes
        for i in range(8):
            slopes[i] = 0.0
        for i in range(STAGES):
            model.jacobian(t + NODES[i] * h, self.x0[i], self.x1[i], self.w0[i], self.w1[i])
            j00, j01, j10, j11 = model.a0_q0, model.a0_q1, model.a1_q0, model.a1_q1
            k00, k01, k10, k11 = model.a0_v0, model.a0_v1, model.a1_v0, model.a1_v1
            slopes[0] = max(slopes[0], math.fabs(j00))
            slopes[1] = max(slopes[1], math.fabs(j01))
            slopes[2] = max(slopes[2], math.fabs(k00))
            slopes[3] = max(slopes[3], math.fabs(k01))
            slopes[4] = max(slopes[4], math.fabs(j10))
            slopes[5] = max(slopes[5], math.fabs(j11))
            slopes[6] = max(slopes[6], math.fabs(k10))
            slopes[7] = max(slopes[7], math.fabs(k11))
            j01 *= ratio
            k01 *= ratio
            j10 /= ratio
            k10 /= ratio
            row = STAGES * i
            upper = n * i
            lower = n * (STAGES + i)
            for j in range(STAGES):
                f = h * A[row + j]
                g = hh * B[row + j]
                m[upper + j] = -(g * j00 + f * k00)
                m[upper + STAGES + j] = -(g * j01 + f * k01)
                m[lower + j] = -(g * j10 + f * k10)
                m[lower + STAGES + j] = -(g * j11 + f * k11)
            m[upper + i] += 1.0
            m[lower + STAGES + i] += 1.0
        return factorised(m, self.rows, n)

    def correct(self) -> None:
        """Find the corrections that belong to the residuals."""
        r = self.r
        left = self.left
        unit0 = self.unit0
        unit1 = self.unit1
        for i in range(STAGES):
            r[i] = left[i] / unit0
            r[STAGES + i] = left[STAGES + i] / unit1
        substitute(self.m, self.rows, r, 2 * STAGES)
        for i in range(STAGES):
            r[i] *= unit0
            r[STAGES + i] *= unit1

    def moved(self, unit0: float, unit1: float) -> float:
        """Size of the corrections relative to the accelerations that they lead to, or the units."""
        a = self.a
        b = self.b
        r = self.r
        move0 = move1 = most0 = most1 = 0.0
        for i in range(STAGES):
            move0 = max(move0, math.fabs(r[i]))
            move1 = max(move1, math.fabs(r[STAGES + i]))
            most0 = max(most0, math.fabs(a[i] + r[i]))
            most1 = max(most1, math.fabs(b[i] + r[STAGES + i]))
        self.most0 = most0
        self.most1 = most1
        return max(move0 / max(most0, unit0), move1 / max(most1, unit1))

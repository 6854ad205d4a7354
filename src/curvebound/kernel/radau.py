"""One step of the seven-stage Radau IIA method, order 13, for motion that is stiff.

L-stable collocation (Hairer, Wanner 1996, sec. IV.5) at the right Radau points, the accelerations
K_i of the stages being the unknowns:

    V_i = v + h sum_j A_ij K_j,    Q_i = q + c_i h v + h^2 sum_j B_ij K_j,    B = A A

They are found by Newton's method with the model's Jacobian at every stage, so that the damping
limits no step. The matrix is kept while the iteration converges well. The last two Legendre
coefficients of the polynomial through the K_i measure the error.
"""

from __future__ import annotations

import math
from typing import Annotated, Final

from .base import Model
from .elimination import Exchanges, Matrix, Vector, factorised, substitute
from .radau_tables import HIGHEST, NEXT, NODES, STAGES, A, B
from .rounding import NEGLIGIBLE, Rounding

__all__ = ["Radau"]

#: Newton corrections below this, relative, are rounding
ROUNDING: Final = 1e-14
#: corrections below this that shrink no more are the noise of the model's own arithmetic
NOISE: Final = 1e-8
EPSILON: Final = 2.220446049250313e-16
#: how far corrections can be above the rounding of the accelerations
SPREAD: Final = 8.0
#: the contraction beyond which the matrix is made anew, and the most that is made of it
SLOW: Final = 0.05
MOST_ITERATIONS: Final = 15
LARGEST: Final = 1e300
TINY: Final = 1e-300


class Radau:
    """The step, and room for it to work in: it remembers nothing."""

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
        #: residuals, then corrections
        self.r: Vector = [0.0] * (2 * STAGES)
        #: the factorised Newton matrix by rows, and its row exchanges
        self.m: Matrix = [0.0] * (4 * STAGES * STAGES)
        self.rows: Exchanges = [0] * (2 * STAGES)
        #: largest slopes of both accelerations by q0, q1, v0, v1
        self.slopes: Annotated[list[float], 8] = [0.0] * 8
        #: what the rounding of coordinates and rates makes of the accelerations
        self.noise0: float = 0.0
        self.noise1: float = 0.0

    def step(self, model: Model, rounding: Rounding, t: float, h: float, bound: float) -> float:
        """Try a step of h s from time t.

        Returns the size of the polynomial's tail relative to the rates: up to `bound` the model's
        state and work have been advanced, else they are as before. Infinite: no convergence.
        """
        a = self.a
        b = self.b
        v0, v1 = model.v0, model.v1
        for i in range(STAGES):
            a[i] = b[i] = 0.0
        if not self.solve(model, rounding, t, h):
            return math.inf
        w0 = self.w0
        w1 = self.w1
        # sizes of the rates: what they are or become
        s0 = max(math.fabs(v0), math.fabs(w0[STAGES - 1]))
        s0 = max(s0, NEGLIGIBLE * rounding.size0 / h + TINY)
        s1 = max(math.fabs(v1), math.fabs(w1[STAGES - 1]))
        s1 = max(s1, NEGLIGIBLE * rounding.size1 / h + TINY)
        high0 = next0 = high1 = next1 = 0.0
        for i in range(STAGES):
            high0 += HIGHEST[i] * a[i]
            next0 += NEXT[i] * a[i]
            high1 += HIGHEST[i] * b[i]
            next1 += NEXT[i] * b[i]
        # as far as it is no rounding, whose size tells nothing of shorter steps
        tail0 = h * max(0.0, max(math.fabs(high0), math.fabs(next0)) - self.noise0)
        tail1 = h * max(0.0, max(math.fabs(high1), math.fabs(next1)) - self.noise1)
        size = max(tail0 / s0, tail1 / s1)
        if not size <= bound:
            return size if size <= LARGEST else math.inf
        if model.works:
            work = 0.0
            last = STAGES * (STAGES - 1)
            for i in range(STAGES):
                power = model.power(
                    t + NODES[i] * h, self.x0[i], self.x1[i], w0[i], w1[i], a[i], b[i]
                )
                work += A[last + i] * power
            model.work += h * work
        model.q0 = self.x0[STAGES - 1]
        model.q1 = self.x1[STAGES - 1]
        model.v0 = w0[STAGES - 1]
        model.v1 = w1[STAGES - 1]
        return size

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
        fresh = False
        before = math.inf
        least = math.inf
        stalls = 0
        # corrections are measured by what moves the rates by as much as they are
        unit0 = math.fabs(model.v0) / h
        unit1 = math.fabs(model.v1) / h
        # the equations are scaled by what their corrections begin with, if that is more
        scale0 = scale1 = 0.0
        for _ in range(MOST_ITERATIONS):
            self.place(model, h)
            left0 = left1 = 0.0
            for i in range(STAGES):
                model.acceleration(t + NODES[i] * h, self.x0[i], self.x1[i], self.w0[i], self.w1[i])
                f0 = model.a0 - a[i]
                f1 = model.a1 - b[i]
                left0 = max(left0, math.fabs(f0))
                left1 = max(left1, math.fabs(f1))
                r[i] = f0
                r[STAGES + i] = f1
            self.evaluations += STAGES
            if unit0 == 0.0 or unit1 == 0.0:
                # from rest: by the accelerations
                unit0 = unit0 or left0
                unit1 = unit1 or left1
                unit0 = unit0 or unit1 or 1.0
                unit1 = unit1 or unit0
            if scale0 == 0.0:
                scale0 = max(unit0, left0)
                scale1 = max(unit1, left1)
            if not fresh:
                if not self.factorise(model, t, h, scale0, scale1):
                    return False
                fresh = True
            self.correct(scale0, scale1)
            move0 = move1 = most0 = most1 = 0.0
            for i in range(STAGES):
                a[i] += r[i]
                b[i] += r[STAGES + i]
                move0 = max(move0, math.fabs(r[i]))
                move1 = max(move1, math.fabs(r[STAGES + i]))
                most0 = max(most0, math.fabs(a[i]))
                most1 = max(most1, math.fabs(b[i]))
            size = max(move0 / max(most0, unit0), move1 / max(most1, unit1))
            if not size + most0 + most1 <= LARGEST:
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

    def round_off(self, rounding: Rounding) -> None:
        """Find what rounding makes of the accelerations of the present stages."""
        x0 = rounding.size0
        x1 = rounding.size1
        w0 = w1 = 0.0
        for i in range(STAGES):
            x0 = max(x0, math.fabs(self.x0[i]))
            x1 = max(x1, math.fabs(self.x1[i]))
            w0 = max(w0, math.fabs(self.w0[i]))
            w1 = max(w1, math.fabs(self.w1[i]))
        s = self.slopes
        noise0 = (s[0] * x0 + s[1] * x1) + (s[2] * w0 + s[3] * w1)
        noise1 = (s[4] * x0 + s[5] * x1) + (s[6] * w0 + s[7] * w1)
        # at twice as many points as those at which it was looked at, or more
        self.noise0 = max(SPREAD * EPSILON * noise0, 2.0 * rounding.scatter0)
        self.noise1 = max(SPREAD * EPSILON * noise1, 2.0 * rounding.scatter1)

    def factorise(self, model: Model, t: float, h: float, unit0: float, unit1: float) -> bool:
        """The Newton matrix I - h^2 B dK/dq - h A dK/dv, in the units, and its triangles."""
        m = self.m
        n = 2 * STAGES
        hh = h * h
        ratio = unit1 / unit0
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

    def correct(self, unit0: float, unit1: float) -> None:
        """Turn the residuals into corrections."""
        r = self.r
        for i in range(STAGES):
            r[i] /= unit0
            r[STAGES + i] /= unit1
        substitute(self.m, self.rows, r, 2 * STAGES)
        for i in range(STAGES):
            r[i] *= unit0
            r[STAGES + i] *= unit1

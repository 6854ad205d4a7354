"""One step of the seven-stage Radau IIA method, order 13, for motion that is stiff.

L-stable collocation (Hairer, Wanner 1996, sec. IV.5) at the right Radau points, the accelerations
K_i of the stages being the unknowns:

    V_i = v + h sum_j A_ij K_j,    Q_i = q + c_i h v + h^2 sum_j B_ij K_j,    B = A A

The last two Legendre coefficients of the polynomial through the K_i measure the error.
"""

from __future__ import annotations

import math
from typing import Final

from .base import Model
from .radau_stages import Stages
from .radau_tables import HIGHEST, NEXT, NODES, STAGES, A
from .rounding import NEGLIGIBLE, Rounding

__all__ = ["Radau"]

LARGEST: Final = 1e300
TINY: Final = 1e-300


class Radau(Stages):
    """The step: it remembers nothing."""

    # fmt: off
    def step(
        self, model: Model, rounding: Rounding, t: float, h: float, share: float, bound: float
    ) -> float:
        """Try a step of h s from time t.

        Returns the size of the polynomial's tail relative to the rates: up to `bound` the model's
        state and work have been advanced, else they are as before. Infinite: no convergence.
        share: the error of a step that is allowed, relative to the rates.
        """
        # fmt: on
        a = self.a
        b = self.b
        v0, v1 = model.v0, model.v1
        for i in range(STAGES):
            a[i] = b[i] = 0.0
        self.off0 = self.off1 = 0.0
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
        tail0 = max(math.fabs(high0), math.fabs(next0))
        tail1 = max(math.fabs(high1), math.fabs(next1))
        # as far as it is no rounding, whose size tells nothing of shorter steps
        size = h * max((tail0 - self.noise0) / s0, (tail1 - self.noise1) / s1)
        looked = size <= bound and (
            counts(h, min(tail0, self.noise0), share, s0, rounding.fast0, rounding.size0)
            or counts(h, min(tail1, self.noise1), share, s1, rounding.fast1, rounding.size1)
        )
        if looked:
            # the most that rounding can make of accelerations would hide errors
            self.look(model, rounding, t, h)
            size = h * max((tail0 - self.noise0) / s0, (tail1 - self.noise1) / s1)
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


def counts(h: float, error: float, share: float, rate: float, fast: float, size: float) -> bool:
    """Whether an error of the acceleration counts in a step of h s, of which `share` is allowed.

    Beside the rate, and beside the largest rate or coordinate so far: what has come to rest
    trembles.
    """
    error *= h
    return error > share * rate and (error > share * fast or h * error > share * size)

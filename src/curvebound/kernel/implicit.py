"""The two-stage Gauss-Legendre method (Kuntzmann 1961, Butcher 1964).

Order 4, A-stable, symplectic and symmetric (Hairer, Lubich, Wanner 2006, sec. II.1.3). Because
q' = v the unknowns are the accelerations K1, K2 of the stages alone; with s = sqrt(3)/6,
c = 1/2 -+ s

    V_i = v + h sum_j A_ij K_j              A   = (1/4        1/4 - s )
                                                  (1/4 + s    1/4     )
    Q_i = q + h c_i v + h^2 sum_j B_ij K_j  B = A^2 = (1/24       1/8 - s/2)
                                                      (1/8 + s/2  1/24     )

and K_i = acceleration(t + c_i h, Q_i, V_i) is solved by Newton's method with the model's Jacobian
at both stages, to rounding level.

A step that resolves nothing has solutions far off beside the right one. Steps that break the
balance of energy grossly (or at all, where the model says that violent motion can come) are
therefore halved, like those at which the iteration fails. Of what is less energy.residual tells.
"""

from __future__ import annotations

import math
from typing import Final

from .base import Model
from .blocks import block, solved
from .method import DONE, NOT_CONVERGED, NOT_FINITE, TOO_MANY_STEPS, Method

__all__ = ["Implicit"]

C1: Final = 0.2113248654051871
C2: Final = 0.7886751345948129
A12: Final = -0.03867513459481288
A21: Final = 0.5386751345948129
B11: Final = 0.041666666666666664
B12: Final = -0.01933756729740644
B21: Final = 0.26933756729740643
#: weights of K1, K2 in h^2 (...) of the new q; those of the new v are 1/2
W1: Final = 0.39433756729740643
W2: Final = 0.10566243270259355
#: 1 / (C2 - C1), to extrapolate the accelerations
SPREAD: Final = 1.7320508075688772

#: corrections below this, relative to the acceleration, are rounding
ROUNDING: Final = 2.3e-16
#: corrections below this that shrink no more are the noise of the model's own arithmetic
NOISE: Final = 1e-7
#: what lies above, or is no number, has left the finite numbers; cheaper than math.isfinite here
LARGEST: Final = 1e300
MOST_ITERATIONS: Final = 25
#: damping rate in units of 1/h from which on a step begins with accelerations of zero
STIFF: Final = 1.0
#: magnification of errors from which on steps are held to the balance of energy, and how closely,
#: relative to the energies at stake
VIOLENT: Final = 10.0
IMBALANCE: Final = 1e-9
#: and that of any other motion, of which energy.residual tells the rest
FAR_OFF: Final = 0.1
#: a step is halved at most this often (to 1e-12 of itself)
DEEPEST: Final = 40


class Implicit(Method):
    """Two evaluations and two Jacobians per Newton iteration, 2 or 3 iterations per step."""

    ORDER = 4

    def __init__(self) -> None:
        super().__init__()
        # accelerations at the stages of the last step, from which the next are guessed
        self.k10: float = 0.0
        self.k11: float = 0.0
        self.k20: float = 0.0
        self.k21: float = 0.0
        #: s, size of the last step; 0: there was none
        self.last: float = 0.0
        #: J, balance of energy at the present state and the size of its parts, while `weighed`
        self.energy: float = 0.0
        self.stake: float = 0.0
        self.weighed: bool = False
        self.tries: int = 0

    def reset(self) -> None:
        super().reset()
        self.set_state([0.0] * 5)

    def get_state(self) -> list[float]:
        return [self.k10, self.k11, self.k20, self.k21, self.last]

    def set_state(self, state: list[float]) -> None:
        self.k10, self.k11, self.k20, self.k21, self.last = state

    def advance(
        self, model: Model, duration: float, count: int, tolerance: float, max_steps: int
    ) -> int:
        h = duration / count
        if count > max_steps:
            self.reached = h
            return TOO_MANY_STEPS
        before = self.get_state()
        self.tries = 0
        self.weighed = False
        for i in range(count):
            outcome = self.step(model, i * h, h, 0, max_steps)
            if outcome != DONE:
                self.set_state(before)
                return outcome
        return DONE

    def step(self, model: Model, t: float, h: float, depth: int, max_steps: int) -> int:
        """One step of h s from time t, halved as often as the iteration needs (at most DEEPEST)."""
        self.tries += 1
        if self.tries > max_steps:
            self.reached = h
            return TOO_MANY_STEPS
        if self.holds(model, t, h):
            if model.settles:
                model.settle(h)
                self.weighed = False
            self.steps += 1
            return DONE
        if not math.isfinite(model.q0 + model.q1 + model.v0 + model.v1):
            self.reached = h
            return NOT_FINITE
        if depth >= DEEPEST:
            self.reached = h
            return NOT_CONVERGED
        half = 0.5 * h
        outcome = self.step(model, t, half, depth + 1, max_steps)
        if outcome != DONE:
            return outcome
        return self.step(model, t + half, half, depth + 1, max_steps)

    def holds(self, model: Model, t: float, h: float) -> bool:
        """Take one step that converges and keeps the balance of energy; False: as before."""
        # The equations of too large a step have other solutions too, far off, that the iteration
        # finds. For motion that can become violent at once no fixed step is right.
        allowed = IMBALANCE if model.magnification > VIOLENT else FAR_OFF
        q0, q1, v0, v1, work = model.q0, model.q1, model.v0, model.v1, model.work
        k10, k11, k20, k21, last = self.k10, self.k11, self.k20, self.k21, self.last
        if not self.weighed:
            model.balance(t)
            self.energy = model.balance_energy
            self.stake = model.balance_size
            self.weighed = True
        for extrapolate in (True, False):
            if extrapolate and last <= 0.0:
                continue
            if self.attempt(model, t, h, extrapolate):
                model.balance(t + h)
                gone = math.fabs(model.balance_energy - self.energy)
                if gone <= allowed * max(model.balance_size, self.stake):
                    self.energy = model.balance_energy
                    self.stake = model.balance_size
                    return True
                model.q0, model.q1, model.v0, model.v1, model.work = q0, q1, v0, v1, work
                self.k10, self.k11, self.k20, self.k21, self.last = k10, k11, k20, k21, last
        return False

    def attempt(self, model: Model, t: float, h: float, extrapolate: bool) -> bool:
        """Solve and take one step; False, with the model unchanged, where that fails."""
        try:
            return self.solve(model, t, h, extrapolate)
        except (ArithmeticError, ValueError):
            # an iterate left the model's domain: a failure of the iteration like any other
            return False

    def solve(self, model: Model, t: float, h: float, extrapolate: bool) -> bool:
        """Newton's method for K1, K2 and, once converged, the step itself."""
        q0, q1, v0, v1 = model.q0, model.q1, model.v0, model.v1
        hh = h * h
        t1 = t + C1 * h
        t2 = t + C2 * h
        if extrapolate:
            ratio = h / self.last
            slope0 = SPREAD * (self.k20 - self.k10)
            slope1 = SPREAD * (self.k21 - self.k11)
            ahead1 = 1.0 + ratio * C1 - C1
            ahead2 = 1.0 + ratio * C2 - C1
            x10 = self.k10 + ahead1 * slope0
            x11 = self.k11 + ahead1 * slope1
            x20 = self.k10 + ahead2 * slope0
            x21 = self.k11 + ahead2 * slope1
        else:
            model.jacobian(t, q0, q1, v0, v1)
            if h * (math.fabs(model.a0_v0) + math.fabs(model.a1_v1)) > STIFF:
                x10 = x11 = 0.0
            else:
                model.acceleration(t, q0, q1, v0, v1)
                x10 = model.a0
                x11 = model.a1
                self.evaluations += 1
            x20 = x10
            x21 = x11
        floor0 = math.fabs(v0) / h
        floor1 = math.fabs(v1) / h
        before = math.inf
        damping = 0.0
        for _ in range(MOST_ITERATIONS):
            qa0 = q0 + h * C1 * v0 + hh * (B11 * x10 + B12 * x20)
            qa1 = q1 + h * C1 * v1 + hh * (B11 * x11 + B12 * x21)
            va0 = v0 + h * (0.25 * x10 + A12 * x20)
            va1 = v1 + h * (0.25 * x11 + A12 * x21)
            qb0 = q0 + h * C2 * v0 + hh * (B21 * x10 + B11 * x20)
            qb1 = q1 + h * C2 * v1 + hh * (B21 * x11 + B11 * x21)
            vb0 = v0 + h * (A21 * x10 + 0.25 * x20)
            vb1 = v1 + h * (A21 * x11 + 0.25 * x21)
            model.acceleration(t1, qa0, qa1, va0, va1)
            f10 = model.a0
            f11 = model.a1
            model.acceleration(t2, qb0, qb1, vb0, vb1)
            f20 = model.a0
            f21 = model.a1
            self.evaluations += 2
            model.jacobian(t1, qa0, qa1, va0, va1)
            damping = h * (math.fabs(model.a0_v0) + math.fabs(model.a1_v1))
            p = block(1.0, hh * B11, h * 0.25, model)
            q = block(0.0, hh * B12, h * A12, model)
            model.jacobian(t2, qb0, qb1, vb0, vb1)
            r = block(0.0, hh * B21, h * A21, model)
            s = block(1.0, hh * B11, h * 0.25, model)
            d10, d11, d20, d21 = solved(p, q, r, s, (f10 - x10, f11 - x11), (f20 - x20, f21 - x21))
            if not math.fabs(d10 + d11 + d20 + d21) <= LARGEST:
                return False
            x10 += d10
            x11 += d11
            x20 += d20
            x21 += d21
            size = 0.0
            move0 = max(math.fabs(d10), math.fabs(d20))
            move1 = max(math.fabs(d11), math.fabs(d21))
            if move0 != 0.0:
                size = move0 / max(max(math.fabs(x10), math.fabs(x20)), floor0)
            if move1 != 0.0:
                size = max(size, move1 / max(max(math.fabs(x11), math.fabs(x21)), floor1))
            # Quadratic convergence: the next correction would be about size^3 / before^2.
            small = size <= NOISE
            if size <= ROUNDING or (
                small
                and (size >= 0.5 * before or (size / before) * (size / before) * size <= ROUNDING)
            ):
                break
            before = size
        else:
            return False
        if model.works:
            model.work += (0.5 * h) * (
                model.power(
                    t1,
                    q0 + h * C1 * v0 + hh * (B11 * x10 + B12 * x20),
                    q1 + h * C1 * v1 + hh * (B11 * x11 + B12 * x21),
                    v0 + h * (0.25 * x10 + A12 * x20),
                    v1 + h * (0.25 * x11 + A12 * x21),
                    x10,
                    x11,
                )
                + model.power(
                    t2,
                    q0 + h * C2 * v0 + hh * (B21 * x10 + B11 * x20),
                    q1 + h * C2 * v1 + hh * (B21 * x11 + B11 * x21),
                    v0 + h * (A21 * x10 + 0.25 * x20),
                    v1 + h * (A21 * x11 + 0.25 * x21),
                    x20,
                    x21,
                )
            )
        model.q0 = q0 + (h * v0 + hh * (W1 * x10 + W2 * x20))
        model.q1 = q1 + (h * v1 + hh * (W1 * x11 + W2 * x21))
        model.v0 = v0 + (0.5 * h) * (x10 + x20)
        model.v1 = v1 + (0.5 * h) * (x11 + x21)
        if damping > STIFF:
            # of what damping does at once there is nothing to extrapolate, and the speeds that
            # follow from it lead the next iteration to solutions far off
            x10 = x11 = x20 = x21 = 0.0
        self.k10, self.k11, self.k20, self.k21, self.last = x10, x11, x20, x21, h
        return True

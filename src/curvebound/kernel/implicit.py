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
from typing import Annotated, Final

from .base import Model
from .blocks import block, solved
from .method import DONE, NOT_CONVERGED, NOT_FINITE, TOO_MANY_STEPS, Method

__all__ = ["Implicit"]

STAGES: Final = 2
Stages = Annotated[list[float], STAGES]
C: Final[list[float]] = [0.2113248654051871, 0.7886751345948129]
#: A and B by rows
A: Final[list[float]] = [0.25, -0.03867513459481288, 0.5386751345948129, 0.25]
# fmt: off
B: Final[list[float]] = [
    0.041666666666666664, -0.01933756729740644, 0.26933756729740643, 0.041666666666666664,
]
# fmt: on
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
        self.kept: tuple[float, float, float, float, float] = (0.0, 0.0, 0.0, 0.0, 0.0)
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

    def keep(self) -> None:
        self.kept = (self.k10, self.k11, self.k20, self.k21, self.last)

    def undo(self) -> None:
        self.k10, self.k11, self.k20, self.k21, self.last = self.kept

    def advance(
        self, model: Model, duration: float, count: int, tolerance: float, max_steps: int
    ) -> int:
        h = duration / count
        if count > max_steps:
            self.reached = h
            return TOO_MANY_STEPS
        self.tries = 0
        self.weighed = False
        for i in range(count):
            outcome = self.step(model, i * h, h, 0, max_steps)
            if outcome != DONE:
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
        # times of the stages, accelerations of both coordinates there, the coordinates, their rates
        at: Stages = [0.0] * STAGES
        k0: Stages = [0.0] * STAGES
        k1: Stages = [0.0] * STAGES
        x0: Stages = [0.0] * STAGES
        x1: Stages = [0.0] * STAGES
        w0: Stages = [0.0] * STAGES
        w1: Stages = [0.0] * STAGES
        f0: Stages = [0.0] * STAGES
        f1: Stages = [0.0] * STAGES
        find_times(t, h, at)
        if extrapolate:
            ratio = h / self.last
            ahead(self.k10, self.k20, ratio, k0)
            ahead(self.k11, self.k21, ratio, k1)
        else:
            model.jacobian(t, q0, q1, v0, v1)
            if h * (math.fabs(model.a0_v0) + math.fabs(model.a1_v1)) <= STIFF:
                model.acceleration(t, q0, q1, v0, v1)
                k0[0] = k0[1] = model.a0
                k1[0] = k1[1] = model.a1
                self.evaluations += 1
        floor0 = math.fabs(v0) / h
        floor1 = math.fabs(v1) / h
        before = math.inf
        damping = 0.0
        for _ in range(MOST_ITERATIONS):
            place(q0, v0, h, k0, x0, w0)
            place(q1, v1, h, k1, x1, w1)
            evaluate(model, at, x0, x1, w0, w1, f0, f1)
            self.evaluations += STAGES
            model.jacobian(at[0], x0[0], x1[0], w0[0], w1[0])
            damping = h * (math.fabs(model.a0_v0) + math.fabs(model.a1_v1))
            p = block(1.0, hh * B[0], h * A[0], model)
            q = block(0.0, hh * B[1], h * A[1], model)
            model.jacobian(at[1], x0[1], x1[1], w0[1], w1[1])
            r = block(0.0, hh * B[2], h * A[2], model)
            s = block(1.0, hh * B[3], h * A[3], model)
            d10, d11, d20, d21 = solved(
                p, q, r, s, (f0[0] - k0[0], f1[0] - k1[0]), (f0[1] - k0[1], f1[1] - k1[1])
            )
            if not math.fabs(d10 + d11 + d20 + d21) <= LARGEST:
                return False
            k0[0] += d10
            k1[0] += d11
            k0[1] += d20
            k1[1] += d21
            size = 0.0
            move0 = max(math.fabs(d10), math.fabs(d20))
            move1 = max(math.fabs(d11), math.fabs(d21))
            if move0 != 0.0:
                size = move0 / max(max(math.fabs(k0[0]), math.fabs(k0[1])), floor0)
            if move1 != 0.0:
                size = max(size, move1 / max(max(math.fabs(k1[0]), math.fabs(k1[1])), floor1))
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
            place(q0, v0, h, k0, x0, w0)
            place(q1, v1, h, k1, x1, w1)
            find_powers(model, at, x0, x1, w0, w1, k0, k1, f0)
            model.work += (0.5 * h) * (f0[0] + f0[1])
        model.q0 = q0 + (h * v0 + hh * (W1 * k0[0] + W2 * k0[1]))
        model.q1 = q1 + (h * v1 + hh * (W1 * k1[0] + W2 * k1[1]))
        model.v0 = v0 + (0.5 * h) * (k0[0] + k0[1])
        model.v1 = v1 + (0.5 * h) * (k1[0] + k1[1])
        self.k10, self.k11, self.k20, self.k21, self.last = k0[0], k1[0], k0[1], k1[1], h
        if damping > STIFF:
            # of what damping does at once there is nothing to extrapolate, and the speeds that
            # follow from it lead the next iteration to solutions far off
            self.k10 = self.k11 = self.k20 = self.k21 = 0.0
        return True


# -- over the stages: written out where they are called when compiled (runtime.WRITTEN_OUT) --------
def find_times(t: float, h: float, at: Stages) -> None:
    """Set `at` to the times of the stages."""
    for i in range(STAGES):
        at[i] = t + C[i] * h


def ahead(first: float, second: float, ratio: float, k: Stages) -> None:
    """Extrapolate the accelerations of the last step's stages to one `ratio` times as long."""
    for i in range(STAGES):
        k[i] = first + (1.0 + ratio * C[i] - C[0]) * (SPREAD * (second - first))


def place(q: float, v: float, h: float, k: Stages, x: Stages, w: Stages) -> None:
    """Set the stages x and w of a coordinate with the accelerations k."""
    for i in range(STAGES):
        x[i] = q + h * C[i] * v + h * h * (B[2 * i] * k[0] + B[2 * i + 1] * k[1])
        w[i] = v + h * (A[2 * i] * k[0] + A[2 * i + 1] * k[1])


# fmt: off
def evaluate(
    model: Model, at: Stages, x0: Stages, x1: Stages, w0: Stages, w1: Stages,
    f0: Stages, f1: Stages,
) -> None:
    """Set f0 and f1 to the accelerations that the equations of motion have at the stages."""
    for i in range(STAGES):
        model.acceleration(at[i], x0[i], x1[i], w0[i], w1[i])
        f0[i] = model.a0
        f1[i] = model.a1


def find_powers(
    model: Model, at: Stages, x0: Stages, x1: Stages, w0: Stages, w1: Stages,
    k0: Stages, k1: Stages, p: Stages,
) -> None:
    """Set p to the power at the stages."""
    for i in range(STAGES):
        p[i] = model.power(at[i], x0[i], x1[i], w0[i], w1[i], k0[i], k1[i])
# fmt: on

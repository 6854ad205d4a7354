"""How long ten characteristic times are, and the exact motion over them.

A characteristic time is the reciprocal of the fastest rate at which the undamped motion changes:
the root of the spectral radius of d(acceleration)/d(coordinates), the angular velocity, and the
rate at which the slider's velocity turns the slope of the parabola. It is taken where the motion
is, not at its start alone: a run lasts until the integral of that rate is `count`, so that what
happens fast counts as the many times it lasts. Damping is left out: what it makes fast dies out.
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np

from ...errors import CurveboundError
from ...models.base import Model
from ..collocation import Trajectory
from ..equations import Array
from . import motion
from .kernels import kernel_of
from .motion import Values
from .precise import RESTING, TAIL, Precise, solve

__all__ = ["LONGEST", "Exact", "exact"]

#: s, end of a motion that hardly changes
LONGEST = 1e6
#: Boole's rule over a step of the reference
_WEIGHTS = (7.0, 32.0, 12.0, 32.0, 7.0)


class Exact(NamedTuple):
    """The exact motion: its end (s), the steps it took, and states at equidistant times.

    states: (q0, q1, v0, v1) of the system in extended precision, shape (4, parts + 1); q0 is the
    angle of the bead, which has no q1.
    """

    end: float
    steps: int
    states: Array


def exact(system: str, values: Values, *, count: float = 10.0, parts: int = 20) -> Exact:
    """The motion of a point of the sample over `count` characteristic times, at `parts` times.

    Raises CurveboundError where the reference cannot be computed.
    """
    real = {k: float(v) for k, v in values.items() if not isinstance(v, str)}
    if system == "bead":
        accelerations = motion.bead(values)
        start = (real["bead.angle_start"], 0.0, real["bead.angular_velocity_start"], 0.0)
        length = 1.0
    else:
        accelerations = motion.pendulum(values)
        start = (
            real["slider.u_start"],
            real["pendulum.angle_start"],
            real["slider.u_rate_start"],
            real["pendulum.angular_velocity_start"],
        )
        length = real["pendulum.length"]
    kernel = kernel_of(system, values)

    def found_with(tail: float, resting: float) -> Precise:
        clock = _Clock(system, values, count)
        return solve(
            accelerations,
            kernel,
            start,
            until=clock.end,
            pace=lambda: clock.pace,
            longest=LONGEST,
            length=length,
            tail=tail,
            resting=resting,
        )

    try:
        found = found_with(TAIL, RESTING)
    except CurveboundError:
        # forces that all but cancel leave no more digits: still far below what is to be judged
        found = found_with(1e-6, 1e-8)
    end = float(found.end)
    times = [end * i / parts for i in range(parts + 1)]
    return Exact(end, found.steps, found.trajectory.states(times)[:, :, 0])


class _Clock:
    """Counts characteristic times along a trajectory."""

    def __init__(self, system: str, values: Values, count: float) -> None:
        self._kernel: Model = kernel_of(system, values, damped=False)
        self._rate = self._bead if system == "bead" else self._pendulum
        real = {k: float(v) for k, v in values.items() if not isinstance(v, str)}
        self._real = real
        self._linear = values.get("model.fidelity") == "linear"
        self._count = count
        #: s, half a characteristic time at the last look
        self.pace = math.inf
        self._done = 0.0
        self._time = 0.0
        if system == "bead":
            # in a constant field the slopes at two angles a quarter turn apart tell the largest
            slopes = [self._kernel.jacobian(0.0, x, 0.0, 0.0, 0.0)[0] for x in (0.0, math.pi / 2)]
            self._field = math.sqrt(math.hypot(*slopes))

    def end(self, trajectory: Trajectory) -> float:
        """The time at which the count is reached in the trajectory's last step, or infinity."""
        before, now = self._time, trajectory.end
        times = np.linspace(before, now, len(_WEIGHTS))
        states = trajectory.states(times)[:, :, 0].astype(float)
        rates = [self._rate(t, *states[:, i]) for i, t in enumerate(times.tolist())]
        self.pace = 0.5 / rates[-1] if rates[-1] > 0.0 else math.inf
        passed = (now - before) * sum(w * x for w, x in zip(_WEIGHTS, rates, strict=True)) / 90.0
        if self._done + passed >= self._count:
            return before + (now - before) * (self._count - self._done) / passed
        self._done += passed
        self._time = now
        return math.inf

    def _bead(self, t: float, q0: float, q1: float, v0: float, v1: float) -> float:
        return max(self._field, abs(v0))

    def _pendulum(self, t: float, q0: float, q1: float, v0: float, v1: float) -> float:
        j = self._kernel.jacobian(t, q0, q1, v0, v1)
        half, product = 0.5 * (j[0] + j[3]), j[0] * j[3] - j[1] * j[2]
        inside = half * half - product
        radius = math.sqrt(max(product, 0.0))
        if inside >= 0.0:
            radius = abs(half) + math.sqrt(inside)
        if self._linear:
            return math.sqrt(radius)
        p = self._real
        growth = p["parabola.coefficient_rate_start"]
        growth += 0.5 * t * p["parabola.coefficient_acceleration"]
        a2 = 2.0 * (p["parabola.coefficient_start"] + t * growth)
        turning = abs(a2 * v0) / math.hypot(1.0, a2 * q0)
        return max(math.sqrt(radius), abs(v1), turning)

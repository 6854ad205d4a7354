"""How long ten characteristic times are, and the exact motion over them.

A characteristic time is the reciprocal of the fastest rate at which the undamped motion changes:
the root of the spectral radius of d(acceleration)/d(coordinates), and the rate at which the motion
turns the directions in which the masses can move. It is taken where the motion
is, not at its start alone: a run lasts until the integral of that rate is `count`, so that what
happens fast counts as the many times it lasts. Damping is left out: what it makes fast dies out.
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np

from ...errors import CurveboundError
from ...mechanics.derived import Derived
from ..reference.collocation import Trajectory
from ..reference.equations import Array
from ..reference.motion import Motion, Values
from ..reference.radau import RESTING, TAIL, Precise, solve

__all__ = ["LONGEST", "Exact", "exact"]

#: s, end of a motion that hardly changes
LONGEST = 1e6
#: Boole's rule over a step of the reference
_WEIGHTS = (7.0, 32.0, 12.0, 32.0, 7.0)


class Exact(NamedTuple):
    """The exact motion: its end (s), the steps it took, and states at equidistant times.

    states: (q0, q1, v0, v1) of the system in extended precision, shape (4, parts + 1).
    """

    end: float
    steps: int
    states: Array


def exact(
    derived: Derived,
    values: Values,
    *,
    count: float = 10.0,
    parts: int = 20,
    end: float | None = None,
) -> Exact:
    """The motion of a point of the sample over `count` characteristic times, at `parts` times.

    end: s, in place of the count. Raises CurveboundError where the reference cannot be computed.
    """
    motion = Motion(derived, values)

    def found_with(tail: float, resting: float) -> Precise:
        clock = _Clock(Motion(derived, values, damped=False), count if end is None else math.inf)

        def until(trajectory: Trajectory) -> float:
            counted = clock.end(trajectory)
            return counted if end is None else (end if trajectory.end >= end else math.inf)

        return solve(
            motion.accelerations,
            motion.slopes,
            motion.start,
            until=until,
            pace=lambda: clock.pace,
            longest=LONGEST,
            length=float(np.ravel(motion.unit())[0]),
            tail=tail,
            resting=resting,
        )

    with np.errstate(all="ignore"):  # a trial step may leave the numbers: the next is shorter
        try:
            found = found_with(TAIL, RESTING)
        except CurveboundError:
            # forces that all but cancel leave no more digits: still far below what is to be judged
            found = found_with(1e-6, 1e-8)
    last = float(found.end)
    times = [last * i / parts for i in range(parts + 1)]
    return Exact(last, found.steps, found.trajectory.states(times)[:, :, 0])


class _Clock:
    """Counts characteristic times along a trajectory."""

    def __init__(self, motion: Motion, count: float) -> None:
        self._motion = motion
        self._count = count
        start = np.array(motion.start)[:, None]
        rate = float(motion.rates(np.zeros(1), start[:2], start[2:])[0])
        #: s, half a characteristic time at the last look
        self.pace = 0.5 / rate if rate > 0.0 else math.inf
        self._done = 0.0
        self._time = 0.0

    def end(self, trajectory: Trajectory) -> float:
        """The time at which the count is reached in the trajectory's last step, or infinity."""
        before, now = self._time, trajectory.end
        times = np.linspace(before, now, len(_WEIGHTS))
        states = trajectory.states(times)[:, :, 0].astype(float)
        rates = self._motion.rates(times, states[:2], states[2:])
        self.pace = 0.5 / float(rates[-1]) if rates[-1] > 0.0 else math.inf
        passed = (now - before) * float(np.dot(_WEIGHTS, rates)) / 90.0
        if self._done + passed >= self._count:
            return before + (now - before) * (self._count - self._done) / passed
        self._done += passed
        self._time = now
        return math.inf

"""Macro steps chosen by the master: step doubling with rollback, and a PI controller.

Each step is computed twice from a saved state, once whole and once as two halves; the halves are
kept. With p the order of the algorithm, their difference divided by 2^p - 1 estimates the error of
the halves (Schierz, Arnold and Clauss, "Co-simulation with communication step size control in an
FMI compatible master algorithm", Proc. 9th Modelica Conf. (2012) 205; Hairer, Norsett and Wanner,
"Solving Ordinary Differential Equations I", section II.4). It is bounded per unit of time, so that
the error of the result is proportional to the tolerance (Shampine, ACM Trans. Math. Softw. 3
(1977) 44). The step follows a proportional-integral controller (Gustafsson, ACM Trans. Math. Softw.
17 (1991) 533), whose memory keeps it from swinging about.

What is compared are outputs that are functions of the FMUs' states: those that drive inputs, those
that are recorded, and those with a given scale. An error that shows in none of them is not seen:
where positions are exchanged, record the velocities too. Functions that drive inputs are seen at
communication points only: bound the step (largest) by what they do between.
"""

from __future__ import annotations

import math
from collections.abc import Iterator

import numpy as np

from .algorithms import advance_of
from .counters import Counters
from .instance import DISCARD, CallFailed
from .scene_parts import ALGORITHMS
from .schedule import Schedule
from .system import System

__all__ = ["adaptive_steps"]

_SAFETY = 0.9
_SHRINK, _GROW = 0.2, 2.5  # bounds of the change of the step at once
_DEPTH = 1024  # default of step / smallest


def adaptive_steps(
    schedule: Schedule, begin: float, end: float, first: float, counters: Counters
) -> Iterator[float]:
    """Advance from `begin` to `end`; yields each new communication point, evaluated.

    first: size of the first step, in s. Communication points are multiples of one small quantum:
    half steps are exact, and rounding does not pile up. The times at which inputs are known to
    jump are such points as they are: a step that ends later, however little, is led astray by a
    slope that reaches over the jump. A step that is at its lower bound is taken whatever its error,
    and counted: across a jump that is not known the error per unit of time does not go to zero
    with the step.
    """
    system = schedule.system
    settings = system.scene.adaptive
    assert settings is not None
    order = ALGORITHMS[system.scene.algorithm].order
    span = end - begin
    smallest = min(settings.smallest or first / _DEPTH, first, span)
    largest = max(min(settings.largest or span / 4.0, span), smallest)
    quanta = 2 * math.ceil(span / smallest)  # in the whole run: a smallest step is two of them
    quantum = span / quanta
    places = np.array([schedule.exchange.place[port] for port in system.controlled])
    scales = np.array(list(system.controlled.values()))
    values = schedule.exchange.reals
    advance = advance_of(schedule)
    divisor = scales * (2.0**order - 1.0) * settings.tolerance

    stops = _stops(system, begin, end, quantum)
    most = max(2, int(largest / quantum))
    size = min(max(2, round(first / quantum)), most)
    at = 0
    controller = _Controller(order)
    while at < quanta:
        limit = min((stop for stop in stops if stop > at + 1), default=quanta) - at
        size = min(size, limit)
        if limit - size == 1:
            size += 1  # never leave less than a smallest step
        at_bound = size <= 3  # quanta: the smallest step, or that and what it may not leave
        left, right = at + size // 2, at + size
        t, middle = stops.get(at, begin + at * quantum), begin + left * quantum
        reached = end if right == quanta else stops.get(right, begin + right * quantum)
        if at in stops or right in stops:
            middle = t + 0.5 * (reached - t)
        saved = schedule.save()
        counters.trials += 3
        try:
            advance(t, reached - t)
            whole = values[places]
            schedule.restore(saved)
            advance(t, middle - t)
            schedule.evaluate(middle)
            advance(middle, reached - middle)
            error = float(np.max(np.abs(values[places] - whole) / divisor)) / (reached - t)
        except CallFailed as failed:
            if failed.status != DISCARD or at_bound:
                raise
            error = math.inf  # a component that cannot make a step of this size
        forced = at_bound and not error <= 1.0
        if error <= 1.0 or (forced and math.isfinite(error)):
            schedule.evaluate(reached)
            counters.steps += 2
            if forced:
                counters.forced += 1
                counters.excess = max(counters.excess, error)
            at = right
            factor = controller.taken(error)
            yield reached
        else:
            schedule.restore(saved)
            counters.rejected += 1
            factor = controller.rejected(error)
            if at_bound:
                raise FloatingPointError(
                    f"a controlled output is not finite at t = {reached:.6g} s"
                )
        size = min(most, max(2, int(size * max(_SHRINK, factor))))


class _Controller:
    """By what the next step is larger, from the errors of those before, over what is allowed.

    order: of the error per unit of time.
    """

    def __init__(self, order: int) -> None:
        self._order = order
        self._before = 1.0
        self._rejected = False

    def taken(self, error: float) -> float:
        """After a step that is kept: proportional and integral, 0.7 and 0.4 of 1 / order."""
        error = max(error, 1e-8)
        factor: float = (
            _SAFETY * error ** (-0.7 / self._order) * self._before ** (0.4 / self._order)
        )
        factor = min(factor, 1.0 if self._rejected else _GROW)
        self._before, self._rejected = error, False
        return factor

    def rejected(self, error: float) -> float:
        """After one that is not."""
        self._rejected = True
        factor: float = _SAFETY * error ** (-1.0 / self._order) if math.isfinite(error) else _SHRINK
        return min(factor, 0.9)


def _stops(system: System, begin: float, end: float, quantum: float) -> dict[int, float]:
    """Where steps end, in quanta and s: a step across a known jump sees it late or not at all."""
    return {
        math.ceil((time - begin) / quantum * (1.0 - 1e-12)): time
        for time in system.stops
        if begin < time < end
    }

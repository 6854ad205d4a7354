"""Communication steps: whether one can begin, and how it is cut into internal steps."""

from __future__ import annotations

import math

from .table import EPSILON, LARGEST

__all__ = ["begins", "near", "refusal", "substeps"]


def near(time: float, now: float, step: float) -> bool:
    """Whether a communication point is the present time but for adding up or for rounding.

    A host may add steps up, or round times to microseconds or to single precision: that is taken
    for the present time where it is little beside the step (s).
    """
    rounding = 1e-6 + 2.4e-7 * abs(now)
    if rounding > 0.01 * step:
        rounding = 0.01 * step
    difference = abs(time - now)
    return difference <= rounding or difference <= 1e-6 * step + 16.0 * EPSILON * abs(now)


def begins(start: float, step: float, now: float) -> bool:
    """Whether a communication step of `step` from `start` can begin when it is `now`; all in s."""
    return (
        0.0 < step <= LARGEST and (start == now or near(start, now, step)) and start + step > start
    )


def refusal(start: float, step: float, now: float) -> str:
    """Why one cannot begin."""
    if not 0.0 < step <= LARGEST:
        return (
            f"communicationStepSize = {step!r} s cannot be used: give a finite step size above zero"
        )
    if start != now and not near(start, now, step):
        return (
            f"currentCommunicationPoint = {start!r} s is not the present time {now!r} s: "
            "continue from there, or restore a state saved at the wanted time"
        )
    return (
        f"communicationStepSize = {step!r} s vanishes beside the present time {now!r} s: "
        "give a larger step"
    )


def substeps(duration: float, step: float, time: float) -> float:
    """Fewest internal steps not larger than `step` in a communication step of `duration` at `time`.

    The caller's duration is a difference of times and so uncertain by a few ulp of the time; that
    uncertainty adds no step. Returned as a float because it may exceed every int of interest.
    """
    slack = 4.0 * EPSILON * (abs(time) + duration)
    ratio = (duration - slack) / step
    if ratio <= 1.0:
        return 1.0
    if ratio >= 1e18:
        return ratio
    return float(math.ceil(ratio))

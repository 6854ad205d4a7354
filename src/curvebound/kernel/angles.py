"""Angles that run on for many turns without losing digits.

A state angle is kept within a turn and whole turns are counted apart: sin and cos then see a small
argument, and adding an increment to it rounds at 1e-16 rad however far the body has turned.
"""

from __future__ import annotations

import math
from typing import Final

__all__ = ["TURN", "TURN_REST", "nearest_whole", "reduce_angle", "unwind"]

#: 2 pi to 107 bits: TURN is the nearest float, TURN_REST what it lacks
TURN: Final = 6.283185307179586
TURN_REST: Final = 2.4492935982947064e-16


def nearest_whole(x: float) -> float:
    """x rounded to either side alike: halves, or where none are told apart, away from zero."""
    whole = float(math.floor(math.fabs(x) + 0.5))
    return -whole if x < 0.0 else whole


def reduce_angle(angle: float) -> tuple[float, float]:
    """(rest, turns) with angle = rest + 2 pi turns, turns whole, rest in about [-pi, pi] (rad)."""
    rest = math.remainder(angle, TURN)  # exact: no rounding in it
    turns = nearest_whole((angle - rest) / TURN)
    return rest - turns * TURN_REST, turns


def unwind(rest: float, turns: float) -> float:
    """The continuous angle (rad) that reduce_angle() took apart."""
    return turns * TURN + (turns * TURN_REST + rest)

"""Angles that run on for many turns without losing digits.

A state angle is kept within a turn and whole turns are counted apart: sin and cos then see a small
argument, and adding an increment to it rounds at 1e-16 rad however far the body has turned.
"""

from __future__ import annotations

import math
from typing import Final

__all__ = ["TURN", "TURN_REST", "reduce_angle", "unwind"]

#: 2 pi to 107 bits: TURN is the nearest float, TURN_REST what it lacks
TURN: Final = 6.283185307179586
TURN_REST: Final = 2.4492935982947064e-16


def reduce_angle(angle: float) -> tuple[float, float]:
    """(rest, turns) with angle = rest + 2 pi turns, turns whole, rest in about [-pi, pi] (rad)."""
    rest = math.remainder(angle, TURN)  # exact: no rounding in it
    ahead = (angle - rest) / TURN
    # to either side alike, also where halves are no longer told apart
    turns = float(math.floor(math.fabs(ahead) + 0.5))
    if ahead < 0.0:
        turns = -turns
    return rest - turns * TURN_REST, turns


def unwind(rest: float, turns: float) -> float:
    """The continuous angle (rad) that reduce_angle() took apart."""
    return turns * TURN + (turns * TURN_REST + rest)

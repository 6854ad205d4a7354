"""Sine and chirp."""

from __future__ import annotations

import math
from typing import Final

__all__ = ["WHOLE", "chirp_cycles", "chirp_frequency", "wave", "wave_rate"]

TURN: Final = 6.283185307179586

#: 2^53: from here on every float is whole
WHOLE: Final = 9007199254740992.0


def wave(cycles: float, phase: float) -> float:
    """The sine of a number of cycles and a phase (rad)."""
    return math.sin(TURN * part_of(cycles) + phase)


def wave_rate(cycles: float, phase: float, frequency: float) -> float:
    """Its time derivative (1/s) where the cycles grow by a frequency (Hz)."""
    return TURN * frequency * math.cos(TURN * part_of(cycles) + phase)


def part_of(cycles: float) -> float:
    """Without whole cycles: the sine then sees a small argument."""
    return cycles - float(int(cycles)) if math.fabs(cycles) < WHOLE else 0.0


def chirp_cycles(elapsed: float, frequency: float, end_frequency: float, duration: float) -> float:
    """Cycles of a chirp: linear in frequency over `duration` (s), from then on at the end's."""
    if elapsed < duration:
        return elapsed * (frequency + 0.5 * (end_frequency - frequency) * (elapsed / duration))
    return 0.5 * (frequency + end_frequency) * duration + end_frequency * (elapsed - duration)


def chirp_frequency(
    elapsed: float, frequency: float, end_frequency: float, duration: float
) -> float:
    """Frequency of the same (Hz)."""
    return frequency + min(1.0, elapsed / duration) * (end_frequency - frequency)

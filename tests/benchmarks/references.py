"""What the exact solutions are after 10 s at the default parameters, undamped and undriven.

45-digit Taylor series and closed forms (Jacobi elliptic functions for the bead), 15 digits kept.
"""

from __future__ import annotations

import math

__all__ = ["DURATION", "REFERENCES", "error_of", "on_wire"]

#: s
DURATION = 10.0

#: bead x, y (m), vx, vy (m/s); pendulum and linear u (m), angle (rad) and their rates
REFERENCES: dict[str, tuple[float, float, float, float]] = {
    "bead": (0.275087462576117, -0.961419205099125, -4.17559810095173, -1.19474905456048),
    "pendulum": (-0.112074121556804, -0.295201431642521, 1.11389439174177, 1.11460636851215),
    "linear": (0.187964711805705, 0.215396108598008, 0.527241555358503, 1.90816142341263),
}


def on_wire(angle: float, rate: float) -> tuple[float, float, float, float]:
    """x, y, vx, vy of a bead on a wire of radius 1 m from its angle (rad) and rate (rad/s)."""
    x, down = math.sin(angle), math.cos(angle)
    return (x, -down, rate * down, rate * x)


def error_of(system: str, state: tuple[float, float, float, float]) -> float:
    """Largest difference of a component (SI units) from the reference."""
    pairs = zip(state, REFERENCES[system], strict=True)
    return max(abs(value - exact) for value, exact in pairs)

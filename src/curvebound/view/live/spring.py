"""The spring by which a hand pulls a body, or the frame, through the inputs of its FMU."""

from __future__ import annotations

import math

from .controls import Grip

__all__ = ["Spring"]

_RATE = 2.0 * math.pi  # rad/s: a free body follows the hand within half a second
_DAMPING = 0.6  # of the critical
_MOST = 50.0  # m/s2 that a hand gives to a free body, however far it is
_STILL = 0.05  # m/s: a frame slower than that is stopped within one macro step


class Spring:
    """From a body to a point of the plane, `target`, in m.

    What it does is computed from the state at one communication point and acts from the next on; so
    it is softer where the macro step, in s, is long.
    """

    def __init__(self, grip: Grip, step: float) -> None:
        self.grip = grip
        self.held = True
        self.target = (0.0, 0.0)
        self.acting = (0.0, 0.0)  # N or m/s2, from the present communication point on
        self._speed = (0.0, 0.0)  # m/s that it has given to a frame
        self._rate = min(_RATE, 0.3 / step)
        self._last = False

    def let_go(self) -> None:
        """Pull no more; a frame is first brought to rest, as nothing else would."""
        self.held = False

    @property
    def over(self) -> bool:
        """Whether it was let go and does nothing any more."""
        return not self.held and self.acting == (0.0, 0.0) == self._speed

    def advance(
        self, position: tuple[float, float], velocity: tuple[float, float], size: float
    ) -> tuple[float, float]:
        """What acts from the next communication point on, in `size` s, for a body there now."""
        if not self.grip.force:
            vx, vy = self._speed
            self._speed = (vx + size * self.acting[0], vy + size * self.acting[1])
        if self.held:
            self._last = False
            mass, rate = self.grip.mass, self._rate
            x, y = (
                mass * (rate**2 * (to - at) - 2.0 * _DAMPING * rate * v)
                for to, at, v in zip(self.target, position, velocity, strict=True)
            )
            share = min(1.0, mass * _MOST / max(math.hypot(x, y), 1e-300))
            self.acting = (share * x, share * y)
        elif self.grip.force or self._last:
            self.acting = self._speed = (0.0, 0.0)
        else:
            self._brake(size)
        return self.acting

    def _brake(self, size: float) -> None:
        """Take the frame's speed, in one step where it is slow: what it has of others stays."""
        self._last = math.hypot(*self._speed) < _STILL
        rate = 1.0 / size if self._last else self._rate
        self.acting = (-rate * self._speed[0], -rate * self._speed[1])

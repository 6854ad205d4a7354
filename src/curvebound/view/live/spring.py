"""The springs by which a hand pulls a body, or the frame, through the inputs of its FMU."""

from __future__ import annotations

import math
from copy import copy

from ...cosim.stepwise import Stepwise
from .controls import Grip

__all__ = ["Hand", "Spring"]

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


class Hand:
    """Pulls at one grip at a time; a frame that it has let go is still brought to rest.

    step: the macro step in s.
    """

    def __init__(self, step: float) -> None:
        self._step = step
        self._springs: list[Spring] = []

    def holds(self, grip: Grip) -> bool:
        """Whether it pulls there."""
        return any(spring.held and spring.grip is grip for spring in self._springs)

    def pull(self, grip: Grip, target: tuple[float, float]) -> None:
        """Pull there, towards a point in m, and nowhere else."""
        self.release()
        spring = next((one for one in self._springs if one.grip is grip), None)
        if spring is None:
            spring = Spring(grip, self._step)
            self._springs.append(spring)
        spring.held = True
        spring.target = target

    def release(self) -> None:
        """Pull no more."""
        for spring in self._springs:
            spring.let_go()

    def copy(self) -> Hand:
        """An independent one that does the same."""
        other = Hand(self._step)
        other._springs = [copy(spring) for spring in self._springs]
        return other

    def forces(self, stepped: Stepwise) -> dict[str, float]:
        """What it adds to inputs, by path, from the next communication point of a run on."""
        added: dict[str, float] = {}
        for spring in self._springs:
            grip = spring.grip
            position = _now(stepped, grip.component, grip.position)
            velocity = _now(stepped, grip.component, grip.velocity) if grip.velocity else (0.0, 0.0)
            strained = spring.advance(position, velocity, stepped.size)
            for name, value in zip(grip.inputs, strained, strict=True):
                path = f"{grip.component}.{name}"
                added[path] = added.get(path, 0.0) + value
        self._springs = [one for one in self._springs if not one.over]
        return added


def _now(stepped: Stepwise, component: str, names: tuple[str, str]) -> tuple[float, float]:
    """Two outputs of a component at the present communication point."""
    row = stepped.row()
    x, y = (row[1 + stepped.columns.index(f"{component}.{name}")] for name in names)
    return float(x), float(y)

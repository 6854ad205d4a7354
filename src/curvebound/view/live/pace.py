"""Which time of a scene belongs to which time of the wall: as fast as asked for, if that can be."""

from __future__ import annotations

__all__ = ["SPEEDS", "Pace"]

SPEEDS = (0.1, 10.0)
_LATE = 0.1  # s of wall time that the scene may lag behind before it counts as too slow
_BETWEEN = 0.5  # s of wall time between two measurements


class Pace:
    """Goes on from where it was last begun. Times of the wall, `now`, and of the scene are in s."""

    def __init__(self) -> None:
        self.speed = 1.0
        #: whether the machine was too slow since the pace was last measured
        self.late = False
        self._begun = (0.0, 0.0)
        self._measured = (0.0, 0.0)

    def begin(self, now: float, time: float) -> None:
        """Let the scene's `time` be now."""
        self._begun = self._measured = (now, time)
        self.late = False

    def set_speed(self, value: float) -> None:
        """Scene's time per wall's, kept within SPEEDS."""
        low, high = SPEEDS
        self.speed = min(max(value, low), high)

    def goal(self, now: float) -> float:
        """The time at which the scene should be."""
        at, time = self._begun
        return time + (now - at) * self.speed

    def keep(self, now: float, reached: float, upcoming: float) -> None:
        """Go slower where the machine does not keep up; upcoming: where its next step ends."""
        if (self.goal(now) - upcoming) / self.speed > _LATE:
            self._begun = (now, reached)
            self.late = True

    def measured(self, now: float, reached: float) -> float | None:
        """The speed since it was last told; None where that is too short ago."""
        since, begun = self._measured
        if now - since < _BETWEEN:
            return None
        self._measured = (now, reached)
        return (reached - begun) / (now - since)

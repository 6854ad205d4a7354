"""What the page drives: a value per input or tunable parameter, changed at communication points."""

from __future__ import annotations

from bisect import bisect_right

from ...cosim.signals import Signal, jumps_of

__all__ = ["Driven"]


class Driven:
    """A function of time in s: what the scene gives, if anything, plus a value that is held.

    begin: start time in s; value: held from there on.
    """

    def __init__(self, value: float, begin: float, given: Signal | None = None) -> None:
        self.given = given
        self.jumps = jumps_of(given) if given is not None else []
        self._times = [begin]
        self._near = [begin - 4e-16 * abs(begin)]  # as the tables of a scene take their times
        self._values = [value]

    def __call__(self, time: float) -> float:
        held = self.held(time)
        return held if self.given is None else self.given(time) + held

    def held(self, time: float) -> float:
        """The held value at a time."""
        if time >= self._near[-1]:
            return self._values[-1]
        return self._values[max(0, bisect_right(self._near, time) - 1)]

    def put(self, time: float, value: float) -> None:
        """Hold `value` from `time` on, which is no earlier than any given before."""
        if value == self._values[-1]:
            return
        if time == self._times[-1]:
            self._values[-1] = value
            return
        self._times.append(time)
        self._near.append(time - 4e-16 * abs(time))
        self._values.append(value)

    def cut(self, time: float) -> None:
        """Forget what was to be held after `time`."""
        keep = max(1, bisect_right(self._times, time))
        del self._times[keep:], self._near[keep:], self._values[keep:]

    def copy(self) -> Driven:
        """An independent one with the same content."""
        other = Driven(self._values[0], self._times[0], self.given)
        other._times = list(self._times)
        other._near = list(self._near)
        other._values = list(self._values)
        return other

    @property
    def changes(self) -> list[float]:
        """The times at which the held value changes, s."""
        return self._times[1:]

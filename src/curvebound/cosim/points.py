"""Communication points of a run with a fixed macro step: its multiples, and the jumps of inputs."""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from typing import NamedTuple

__all__ = ["MacroStep", "communication_times", "count_steps", "macro_steps"]

#: parts of a macro step nearer than this to each other are one point: rounding
NEAR = 1e-9


class MacroStep(NamedTuple):
    """From `time` by `size` to `reached`, in s; `whole`: no jump cuts it off before its end."""

    time: float
    size: float
    reached: float
    whole: bool


def count_steps(start: float, stop: float, step: float) -> tuple[int, float]:
    """Number of whole macro steps from start to stop, and the length of a last shorter one (or 0).

    A rest below 1e-9 steps is rounding, and the last step then ends at `stop` all the same. A run
    shorter than that is still one step.
    """
    exact = (stop - start) / step
    count = math.floor(exact + NEAR * max(1.0, exact))
    rest = stop - (start + count * step)
    if count and rest <= NEAR * step * max(1.0, exact):
        rest = 0.0
    return count, rest


def macro_steps(
    start: float, stop: float, step: float, jumps: Sequence[float] = (), done: int = 0
) -> Iterator[MacroStep]:
    """The macro steps of a run: from one multiple of `step` to the next, cut where inputs jump.

    jumps: times in s, in order. A point that is a jump but for rounding has the jump's time, at
    which the input has its new value.
    done: whole macro steps that are over; theirs are left out.
    """
    count, rest = count_steps(start, stop, step)
    total = count + (rest > 0.0)
    near = NEAR * min(step, stop - start)
    time = start + done * step if done else start
    ahead = iter([jump for jump in jumps if time < jump < stop])
    jump = next(ahead, math.inf)
    for n in range(done + 1, total + 1):
        # multiples, never sums: rounding does not pile up
        end = stop if n == total else start + n * step
        while jump < end - near:
            if jump > time + near:
                yield MacroStep(time, jump - time, jump, False)
                time = jump
            jump = next(ahead, math.inf)
        if jump <= end + near:
            end = end if n == total else jump
            jump = next(ahead, math.inf)
        uncut = time == start + (n - 1) * step and n <= count
        yield MacroStep(time, step if uncut else end - time, end, True)
        time = end


def communication_times(
    start: float, stop: float, step: float, jumps: Sequence[float] = ()
) -> list[float]:
    """The communication points of `macro_steps`, the initial one too."""
    return [start, *(one.reached for one in macro_steps(start, stop, step, jumps))]

"""Inputs that functions of time drive, linear in time over each macro step.

A line leads an input from where it is to the function's value just before the end of the step, so
that a jump at a communication point is met where it is and nothing overshoots. Where FMUs keep
their inputs where slopes have led them, the input is set only where the function has left the line.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from functools import partial

from .exchange import Call, Exchange
from .instance import Instance
from .signals import Signal, unusable
from .system import Port, System, path_of

__all__ = ["Line", "lines_of"]

#: of a step before its end, at which a function is asked for the value at the end
EARLY = 1e-6
AHEAD = 1.0 - EARLY


class Line:
    """One input: the function that drives it, its path, the place of what it is set to in `values`.

    set_input: sets the input to that; None where others set it at every communication point.
    """

    def __init__(
        self,
        function: Signal,
        path: str,
        values: memoryview[float],
        place: int,
        set_input: Callable[[], None] | None,
    ) -> None:
        self.function = function
        self.path = path
        self.values = values
        self.place = place
        self.set_input = set_input
        # The last EARLY of a line is extrapolated: a smooth function bends away from it by half of
        # EARLY times the step times the change of its slope over a step; a table does not bend.
        self.bend = 0.0 if hasattr(function, "jumps") else EARLY
        if set_input is None:
            self.bend = math.nan
        #: where the input is, and the slope that has led it there
        self.at = self.slope = math.nan
        #: by how much the function may be off it without a jump; NaN where it must be set
        self.within = math.nan

    def forget(self) -> None:
        """The FMU begins anew: where the input is, is not known."""
        self.slope = self.within = math.nan

    @property
    def state(self) -> tuple[float, float]:
        """What `resume` takes."""
        return self.at, self.slope

    def resume(self, state: tuple[float, float]) -> None:
        """Go on from a communication point where the line had that state."""
        self.at, self.slope = state
        self.within = math.nan
        self.values[self.place] = self.at
        if self.set_input is not None:
            self.set_input()

    def meet(self, time: float) -> None:
        """Be at the function's value at a communication point, in s."""
        try:
            value = float(self.function(time))
        except Exception as error:
            raise unusable(self.path, time, error) from error
        if not abs(value - self.at) <= self.within:
            self.values[self.place] = self.at = value
            if self.set_input is not None:
                self.set_input()

    def leading(self, slopes: memoryview[float], place: int) -> Callable[[float, float], None]:
        """What puts the slope over a step, of its time and size in s, into its place."""
        function, path, bend = self.function, self.path, self.bend

        def lead(time: float, size: float) -> None:
            ahead = AHEAD * size
            try:
                value = float(function(time + ahead))
            except Exception as error:
                raise unusable(path, time + ahead, error) from error
            at = self.at
            slope = (value - at) / ahead
            self.at = at + slope * size
            self.within = bend * abs(slope - self.slope) * size
            self.slope = slopes[place] = slope

        return lead


def lines_of(
    system: System,
    exchange: Exchange,
    instances: dict[str, Instance],
    run: Callable[[list[Call]], None],
) -> dict[Port, Line]:
    """A line for each input of a scene that a function can lead; `run` makes calls.

    They set the inputs of components that are `led`, and read what may depend on them.
    """
    lines = {}
    values: memoryview[float] = memoryview(exchange.reals)  # type: ignore[arg-type]
    for port, function in system.signals.items():
        if system.takes_slope(port):
            set_input = None
            if port[0] in system.led:
                instance = instances[port[0]]
                calls = [exchange.setting(instance, port), *exchange.read(instance, 0)]
                set_input = partial(run, calls)
            place = exchange.input_place(port)
            lines[port] = Line(function, path_of(port), values, place, set_input)
    return lines

"""A scene stepped by its caller: one communication step at a time, by the master that runs it.

It takes the points, calls and bits of `Prepared.run` with a fixed macro step; the end is open, and
the caller may save states and return to them.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from itertools import count, dropwhile
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from ..errors import CurveboundError
from .algorithms import advance_of
from .fmu import Value
from .instance import CallFailed, Ended
from .loops import LoopFailed
from .points import MacroStep, macro_steps
from .prepared import Prepared
from .scene_data import SceneData
from .schedule import TRIAL, Values

__all__ = ["Moment", "Stepwise"]

_OPEN_END = 1e9  # s after the start: what FMUs are told as stop time


class Moment(NamedTuple):
    """A communication point whose state was saved: macro steps done, time in s."""

    number: int
    time: float
    place: int
    values: Values


class Stepwise(Prepared):
    """The FMUs of a scene at a communication point.

    time: s; number: whole macro steps done; upcoming: s, where the next step ends.
    alive: whether it can be stepped; after a failure only `begin` helps.
    Raises CurveboundError where the scene is wrong, chooses its macro steps, or an FMU fails.
    """

    def __init__(self, scene: SceneData) -> None:
        if scene.adaptive is not None:
            raise CurveboundError(
                f"The scene {scene.name} chooses its macro steps, which cannot be stepped one by "
                "one: set adaptive to None."
            )
        self._kept: set[int] = set()
        self._places = count(TRIAL + 1)
        super().__init__(scene)
        self._points: Iterator[MacroStep] = iter(())
        self._next = MacroStep(scene.start_time, scene.step, scene.start_time + scene.step, True)
        self.alive = False
        self.time = scene.start_time
        self.number = 0
        recorded = self.system.recorded
        real = [self.system.variable(port).kind == "Real" for port in recorded]
        self.columns = [".".join(port) for port in recorded]
        self._row = np.zeros(1 + len(recorded))
        at = [self.exchange.place[port] for port in recorded]
        self._reals = np.array([[1 + i, at[i]] for i in range(len(at)) if real[i]], dtype=np.intp)
        self._others = np.array(
            [[1 + i, at[i]] for i in range(len(at)) if not real[i]], dtype=np.intp
        )

    @property
    def can_go_back(self) -> bool:
        """Whether every FMU saves its state."""
        return all(node.fmu.can_roll_back for node in self.system.nodes.values())

    @property
    def upcoming(self) -> float:
        """Where the next step ends, s."""
        return self._next.reached

    @property
    def size(self) -> float:
        """The size of the next step, s."""
        return self._next.size

    def begin(self, start: Mapping[str, Value] | None = None) -> None:
        """To the start time, with start values by path on top of the scene's."""
        begin = self.scene.start_time
        values = self._start_values(start or {})
        self.alive = False
        self.log.clear()
        self.time, self.number = begin, 0
        with self._failing():
            schedule = self._ready(values, begin, begin + _OPEN_END)
            self._advance = advance_of(schedule)
        self._seek()
        self.alive = True

    def step(self) -> float:
        """One communication step; the time reached, s."""
        schedule = self._schedule
        if not self.alive or schedule is None:
            raise CurveboundError(f"The scene {self.scene.name} has failed: begin anew.")
        step = self._next
        with self._failing():
            self._advance(step.time, step.size)
            schedule.evaluate(step.reached)
        self.time = step.reached
        self.number += step.whole
        self._next = next(self._points)
        return self.time

    def row(self) -> NDArray[np.float64]:
        """Time and the recorded outputs, in the order of `columns`; valid until the next call."""
        row = self._row
        row[0] = self.time
        for indices, values in (
            (self._reals, self.exchange.reals),
            (self._others, self.exchange.others),
        ):
            if indices.size:
                row[indices[:, 0]] = values[indices[:, 1]]
        return row

    def warnings(self) -> list[str]:
        """What the FMUs warned of since `begin`, one line each."""
        return self.log.warnings()

    # states

    def save(self) -> Moment:
        """Save the present state within the FMUs, beside those saved before."""
        assert self._schedule is not None
        place = next(self._places)
        with self._failing():
            values = self._schedule.save(place)
        self._kept.add(place)
        return Moment(self.number, self.time, place, values)

    def has(self, moment: Moment) -> bool:
        """Whether a saved state is there yet: a failure loses all of them."""
        return self.alive and moment.place in self._kept

    def restore(self, moment: Moment) -> None:
        """Back to a saved state, which stays saved."""
        assert self._schedule is not None
        with self._failing():
            self._schedule.restore(moment.values, moment.place)
        self.time, self.number = moment.time, moment.number
        self._seek()

    def drop(self, moment: Moment) -> None:
        """Free a saved state."""
        self._kept.discard(moment.place)
        for instance in self._instances.values():
            instance.drop(moment.place)

    def _seek(self) -> None:
        """Have the next steps follow the present point, wherever jumps cut the steps before."""
        begin = self.scene.start_time
        steps = macro_steps(
            begin,
            begin + _OPEN_END,
            self.scene.step,
            self.system.stops,
            done=max(0, self.number - 1),
        )
        self._points = dropwhile(lambda one: one.reached <= self.time, steps)
        self._next = next(self._points)

    @contextmanager
    def _failing(self) -> Iterator[None]:
        """Free everything after a failure, and say which component it was, when and why."""
        try:
            yield
        except Ended as ending:
            self._end()
            said = f": {ending.said}" if ending.said else ""
            raise CurveboundError(f"The component {ending}{said}.") from ending
        except (CallFailed, LoopFailed, FloatingPointError) as error:
            self._end()
            cause = f"component {error}" if isinstance(error, CallFailed) else str(error)
            raise CurveboundError(
                f"The scene {self.scene.name} failed at t = {self.time:.6g} s: {cause}"
            ) from error
        except BaseException:
            self._end()
            raise

    def _end(self) -> None:
        self.alive = False
        self._free()

    def _free(self) -> None:
        self._kept.clear()
        super()._free()

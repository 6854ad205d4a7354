"""The runs of one page side by side: begun, saved and taken back together."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from itertools import count

import numpy as np
from numpy.typing import NDArray

from ...cosim.fmu import Value
from ...cosim.stepwise import Moment, Stepwise
from .driven import Driven
from .plan import Plan

__all__ = ["Run", "Runs"]


@dataclass
class Run:
    """A scene that is stepped, with what drives it; settings: what differs from it as given."""

    key: int  # no other run of the page has it
    label: str
    settings: dict[str, Value]
    stepped: Stepwise
    driven: dict[str, Driven]  # by path


class Runs:
    """The first one, which the page pulls at, and perhaps another beside it.

    every: both, in this order. rows: what each has come to since they were last sent, by number.
    """

    def __init__(self, plan: Plan) -> None:
        self.plan = plan
        self.every: list[Run] = []
        self.rows: dict[int, list[NDArray[np.float64]]] = {}
        self._keys = count()

    @property
    def first(self) -> Run:
        """The run that the page pulls at."""
        return self.every[0]

    @property
    def beside(self) -> Run | None:
        """The run beside it."""
        return self.every[1] if len(self.every) > 1 else None

    def close(self) -> None:
        """Free the FMUs."""
        self._keep(0)

    def begin(self, settings: Mapping[str, Value], values: Mapping[str, float]) -> None:
        """Both from the start, the first with other settings and with controls held at values.

        Where that fails all stays as it is.
        """
        made = [self._made(self.plan.scene.name, settings, self.plan.driven(values))]
        beside = self.beside
        try:
            if beside is not None:
                made.append(self._made(beside.label, beside.settings, made[0].driven))
        except BaseException:
            made[0].stepped.close()
            raise
        self.close()
        self.every = made

    def put_beside(self, label: str, settings: Mapping[str, Value]) -> None:
        """Another run with the inputs of the first, from the start."""
        made = self._made(label, settings, self.first.driven)
        self.leave_alone()
        self.every.append(made)

    def leave_alone(self) -> None:
        """No run beside the first any more."""
        self._keep(1)

    def _keep(self, count: int) -> None:
        for run in self.every[count:]:
            run.stepped.close()
        del self.every[count:]

    def _made(self, label: str, settings: Mapping[str, Value], driven: dict[str, Driven]) -> Run:
        scene, own = self.plan.stepped(settings, driven)
        stepped = Stepwise(scene)
        try:
            stepped.begin()
        except BaseException:
            stepped.close()
            raise
        return Run(next(self._keys), label, dict(settings), stepped, own)

    def lag(self, time: float) -> bool:
        """Whether one of them is a step or more behind a time."""
        every = (run.stepped for run in self.every)
        return any(stepped.alive and stepped.upcoming <= time for stepped in every)

    def show(self, number: int) -> None:
        """Add where a run is to its rows: time, outputs, and controls that are drawn."""
        run = self.every[number]
        drawn = [run.driven[path](run.stepped.time) for path in self.plan.shown]
        self.rows.setdefault(number, []).append(np.concatenate([run.stepped.row(), drawn]))

    # states, by the key of the run

    def save(self) -> dict[int, Moment]:
        """Save the states of those that have one."""
        return {run.key: run.stepped.save() for run in self.every if run.stepped.alive}

    def drop(self, moments: Mapping[int, Moment]) -> None:
        """Free saved states."""
        for run in self.every:
            if run.key in moments:
                run.stepped.drop(moments[run.key])

    def go_back(self, time: float, moments: Mapping[int, Moment]) -> Iterator[tuple[int, float]]:
        """Return to the states saved at a time; gives number and time of each run that has.

        A run that has no state of that time begins anew.
        """
        self.rows.clear()
        for driven in {id(one): one for run in self.every for one in run.driven.values()}.values():
            driven.cut(time)
        for number, run in enumerate(self.every):
            moment = moments.get(run.key)
            if moment is not None and run.stepped.has(moment):
                run.stepped.restore(moment)
            else:
                run.stepped.begin()
            yield number, run.stepped.time

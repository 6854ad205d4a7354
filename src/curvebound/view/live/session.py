"""One page's scene: stepped in real time, changed, taken back, and put beside another."""

from __future__ import annotations

import time as clock
from collections.abc import Callable
from copy import copy
from dataclasses import dataclass
from itertools import count
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ...cosim.fmu import Value
from ...cosim.stepwise import Moment, Stepwise
from ...errors import CurveboundError
from .driven import Driven
from .messages import MOST_PAST, MOST_ROWS, samples, text
from .model import actors_of
from .plan import Plan
from .protocol import Malformed, parse
from .spring import Spring

__all__ = ["TICK", "Session"]

TICK = 1.0 / 60.0  # s between two pictures
_BUDGET = 0.8 * TICK  # s of it for the FMUs
_LATE = 0.1  # s of wall time that the scene may lag behind before it counts as too slow
_MOST_UNDONE = 20
_ONE_CHANGE = 0.7  # s: what is changed again within that is undone at once
SPEEDS = (0.1, 10.0)


@dataclass
class _Run:
    """One of the scenes side by side."""

    key: int  # no other run of the session has it
    label: str
    settings: dict[str, Value]
    stepped: Stepwise
    driven: dict[str, Driven]


@dataclass
class Kept:
    """A point to return to."""

    time: float
    moments: dict[int, Moment]  # by key of the run
    values: dict[str, float]
    springs: list[Spring]


class Session:
    """Of one page, from `open` to `close`.

    The page's commands go to `receive`; `tick` steps the scene and gives the messages to send.
    """

    def __init__(self, plan: Plan) -> None:
        self.plan = plan
        self.values = {path: float(one.value) for path, one in plan.controls.items()}
        self.playing = False
        self.speed = 1.0
        self.reached = plan.scene.start_time  # s: where the page stands
        self._keys = count()
        self._runs: list[_Run] = []
        self._springs: list[Spring] = []
        self._undo: list[Kept] = []
        self._mark: Kept | None = None
        self._said: list[str | bytes] = []
        self._rows: dict[int, list[NDArray[np.float64]]] = {}
        self._anchor = (clock.perf_counter(), self.reached)
        self._changed_at = ("", 0.0)
        self._late = False
        self._paced = (0.0, self.reached)
        self._warned: set[str] = set()
        self.on_record: Callable[[], None] | None = None
        self._restart({})

    # life

    def close(self) -> None:
        """Free the FMUs."""
        for run in self._runs:
            run.stepped.close()
        self._runs.clear()

    @property
    def first(self) -> Stepwise:
        """The run that the page pulls at."""
        return self._runs[0].stepped

    @property
    def settings(self) -> dict[str, Value]:
        """What differs from the scene as given, by path."""
        return self._runs[0].settings

    @property
    def beside(self) -> tuple[str, dict[str, Value]] | None:
        """Label and settings of the run beside the first."""
        return (self._runs[1].label, self._runs[1].settings) if len(self._runs) > 1 else None

    @property
    def driven(self) -> dict[str, Driven]:
        """What drives the first run, by path."""
        return self._runs[0].driven

    def say(self, event: str, **fields: Any) -> None:
        """Queue a message."""
        self._said.append(text(event, **fields))

    # commands

    def receive(self, message: str | bytes, *, silent: bool = False) -> bool:
        """Do what the page asks; False where that is malformed, which is said unless `silent`.

        What cannot be done is said.
        """
        name = ""
        try:
            name, fields = parse(message)
            getattr(self, f"do_{name}")(**fields)
        except Malformed as error:
            if not silent:
                self.say("refused", text=str(error))
            return False
        except (CurveboundError, ValueError) as error:
            self._trouble(error)
        if name != "pull":
            self._state()
        return True

    def do_play(self) -> None:
        self.playing = self.first.alive
        self._anew()

    def do_pause(self) -> None:
        self.playing = False

    def do_step(self) -> None:
        self.playing = False
        if not self._lagging():
            self._advance()

    def do_speed(self, value: float) -> None:
        low, high = SPEEDS
        self.speed = min(max(float(value), low), high)
        self._anew()

    def do_reset(self) -> None:
        self._restart(self.settings)

    def do_restart(self, settings: dict[str, Value]) -> None:
        self._restart(settings)

    def do_set(self, path: str, value: Any) -> None:
        control = self.plan.controls.get(path)
        if control is None:
            raise Malformed(f"{path:.60} is nothing that can be changed while the scene runs")
        taken = control.take(value)
        self._keep(f"set {path}")
        self.values[path] = taken

    def _restart(self, settings: dict[str, Value]) -> None:
        """From the start, with other settings; where that fails all stays as it is."""
        driven = self.plan.driven(self.values)
        fresh = self._made(self.plan.scene.name, settings, driven)
        beside = self.beside
        try:
            others = [self._made(*beside, fresh.driven)] if beside else []
        except BaseException:
            fresh.stepped.close()
            raise
        self.close()
        self._runs = [fresh, *others]
        self._undo.clear()
        self._mark = None
        self._springs.clear()
        self.reached = self.plan.scene.start_time
        self._warned.clear()
        self._show_runs()

    def _made(self, label: str, settings: dict[str, Value], driven: dict[str, Driven]) -> _Run:
        scene, own = self.plan.stepped(settings, driven)
        stepped = Stepwise(scene)
        try:
            stepped.begin()
        except BaseException:
            stepped.close()
            raise
        return _Run(next(self._keys), label, dict(settings), stepped, own)

    def do_original(self) -> None:
        """As the scene is given, sliders too."""
        before = self.values
        self.values = {path: float(one.value) for path, one in self.plan.controls.items()}
        try:
            self._restart({})
        except BaseException:
            self.values = before
            raise

    def do_variant(self, name: str) -> None:
        self.do_beside(name, {**self.settings, **self.plan.variant(name)})

    def do_beside(self, label: str, settings: dict[str, Value]) -> None:
        """Another run with the inputs of the first, from the start to where that one is."""
        made = self._made(label or "beside", settings, self.driven)
        for run in self._runs[1:]:
            run.stepped.close()
        self._runs[1:] = [made]
        self._show_runs(kept=True)

    def do_alone(self) -> None:
        for run in self._runs[1:]:
            run.stepped.close()
        del self._runs[1:]
        self._show_runs(kept=True)

    def do_pull(self, grip: float, x: float, y: float) -> None:
        if not (0 <= grip < len(self.plan.grips) and float(grip).is_integer()):
            raise Malformed(f"there is no grip {grip!r}")
        wanted = self.plan.grips[int(grip)]
        spring = next((one for one in self._springs if one.grip is wanted), None)
        if spring is None or not spring.held:
            self._keep("pull")
            for other in self._springs:
                other.let_go()
            if spring is None:
                spring = Spring(wanted, self.plan.scene.step)
                self._springs.append(spring)
        spring.held = True
        spring.target = (float(x), float(y))

    def do_release(self) -> None:
        for spring in self._springs:
            spring.let_go()

    def do_record(self) -> None:
        if self.on_record is not None:
            self.on_record()

    # going back

    def _keep(self, what: str) -> None:
        """Save the state before a change, unless that goes on with the last one."""
        now = clock.perf_counter()
        name, at = self._changed_at
        self._changed_at = (what, now)
        if (name == what and now - at < _ONE_CHANGE) or not self.plan.can_go_back:
            return
        self._undo.append(self._here())
        self._state()
        if len(self._undo) > _MOST_UNDONE:
            self._drop(self._undo.pop(0))

    def _here(self) -> Kept:
        moments = {run.key: run.stepped.save() for run in self._runs if run.stepped.alive}
        springs = [copy(one) for one in self._springs]
        return Kept(self.reached, moments, dict(self.values), springs)

    def _drop(self, kept: Kept) -> None:
        for run in self._runs:
            if run.key in kept.moments:
                run.stepped.drop(kept.moments[run.key])

    def do_undo(self) -> None:
        if self._undo:
            kept = self._undo.pop()
            self._go_to(kept)
            self._drop(kept)
        self._changed_at = ("", 0.0)

    def do_mark(self) -> None:
        if not self.plan.can_go_back:
            raise CurveboundError(
                "An FMU of this scene cannot save its state, so nor can the page."
            )
        if self._mark is not None:
            self._drop(self._mark)
        self._mark = self._here()

    def do_back(self) -> None:
        if self._mark is None:
            raise CurveboundError("No state is marked: mark one first.")
        later = [one for one in self._undo if one.time > self._mark.time]
        for kept in later:
            self._drop(kept)
            self._undo.remove(kept)
        self._go_to(self._mark)

    def _go_to(self, kept: Kept) -> None:
        """Return to a state; a run that has none of that time computes its way there anew."""
        for driven in {id(one): one for run in self._runs for one in run.driven.values()}.values():
            driven.cut(kept.time)
        for number, run in enumerate(self._runs):
            moment = kept.moments.get(run.key)
            if moment is not None and run.stepped.has(moment):
                run.stepped.restore(moment)
            else:
                run.stepped.begin()
            self.say("cut", run=number, time=run.stepped.time)
        self.values = dict(kept.values)
        self._springs = [copy(one) for one in kept.springs]
        self.do_release()
        self.reached = kept.time
        self._rows.clear()
        self._anew()

    # stepping

    def tick(self) -> list[str | bytes]:
        """Step as far as the time has come; the messages for the page."""
        now = clock.perf_counter()
        deadline = now + _BUDGET
        at, begun = self._anchor
        goal = begun + (now - at) * self.speed
        most = MOST_PAST if self._lagging() else MOST_ROWS
        try:
            self._catch_up(deadline)
            if self._lagging():
                self._anew()
            elif self.playing:
                while self.first.upcoming <= goal and clock.perf_counter() < deadline:
                    self._advance()
                self._measure(now, goal)
        except CurveboundError as error:
            self._trouble(error)
        said, self._said = self._said, []
        for number, rows in sorted(self._rows.items()):
            said.append(samples(number, goal if self.playing else self.reached, rows, most))
        self._rows.clear()
        return said

    def _advance(self) -> None:
        """One step of the first run, and of the one beside as many as take it there."""
        self._drive()
        self.reached = self.first.step()
        self._show(0)
        for number in range(1, len(self._runs)):
            self._follow(number)

    def _follow(self, number: int) -> None:
        stepped = self._runs[number].stepped
        near = self.reached + 1e-9 * stepped.scene.step
        while stepped.alive and stepped.upcoming <= near:
            try:
                stepped.step()
            except CurveboundError as error:  # the first one goes on alone
                self.say("error", text=f"{self._runs[number].label}: {error}")
            else:
                self._show(number)

    def _lagging(self) -> bool:
        return any(run.stepped.alive and run.stepped.upcoming <= self.reached for run in self._runs)

    def _catch_up(self, deadline: float) -> None:
        """Bring runs that begin anew to where the page stands."""
        for number, run in enumerate(self._runs):
            stepped = run.stepped
            behind = False
            while stepped.alive and stepped.upcoming <= self.reached:
                behind = True
                if clock.perf_counter() > deadline:
                    return
                stepped.step()
                self._show(number)
            if behind:
                self._state()

    def _drive(self) -> None:
        """Fix what acts from the next communication point on: sliders and springs."""
        first, driven = self.first, self.driven
        if not first.alive or self._lagging():
            return
        added: dict[str, float] = {}
        for spring in self._springs:
            for name, value in zip(spring.grip.inputs, self._strained(spring), strict=True):
                path = f"{spring.grip.component}.{name}"
                added[path] = added.get(path, 0.0) + value
        self._springs = [one for one in self._springs if not one.over]
        for path, value in self.values.items():
            driven[path].put(first.upcoming, value + added.get(path, 0.0))

    def _strained(self, spring: Spring) -> tuple[float, float]:
        """What a spring does next, from where its body is."""
        grip, row = spring.grip, self.first.row()

        def of(name: str) -> float:
            return float(row[1 + self.first.columns.index(f"{grip.component}.{name}")])

        x, y = grip.position
        velocity = (of(grip.velocity[0]), of(grip.velocity[1])) if grip.velocity else (0.0, 0.0)
        return spring.advance((of(x), of(y)), velocity, self.first.size)

    def _anew(self) -> None:
        """Let the clock go on from here."""
        self._anchor = (clock.perf_counter(), self.reached)
        self._paced = self._anchor
        self._late = False

    def _measure(self, now: float, goal: float) -> None:
        """See whether the machine keeps up; where it does not, time goes slower."""
        late = (goal - self.first.upcoming) / self.speed > _LATE
        if late:
            self._anchor = (now, self.reached)
            self._late = True
        since, begun = self._paced
        if now - since >= 0.5:
            pace = (self.reached - begun) / (now - since)
            self.say("pace", speed=pace, late=self._late)
            self._paced = (now, self.reached)
            self._late = False
            for warning in self.first.warnings():
                if warning not in self._warned:
                    self._warned.add(warning)
                    self.say("note", text=warning)

    # what the page is told

    def _show(self, number: int) -> None:
        run = self._runs[number]
        drawn = [run.driven[path](run.stepped.time) for path in self.plan.shown]
        self._rows.setdefault(number, []).append(np.concatenate([run.stepped.row(), drawn]))

    def _show_runs(self, *, kept: bool = False) -> None:
        """Tell which runs there are; unless `kept`, the page begins anew."""
        self._rows.clear()
        self.say(
            "runs",
            kept=kept,
            runs=[
                {
                    "label": run.label,
                    "settings": run.settings,
                    "actors": actors_of(self.plan, run.stepped.system),
                }
                for run in self._runs
            ],
        )
        for number in range(1 if kept else 0, len(self._runs)):
            self._show(number)
        self._anew()
        self._state()

    def _state(self) -> None:
        self.say(
            "state",
            playing=self.playing,
            speed=self.speed,
            time=self.reached,
            alive=self.first.alive,
            undo=len(self._undo),
            mark=self._mark.time if self._mark is not None else None,
            values=self.values,
            catching_up=self._lagging(),
        )

    def _trouble(self, error: Exception) -> None:
        """Say what failed; a run that failed stands still until it is taken back or reset."""
        self.say("error", text=str(error))
        if self._runs and not self.first.alive:
            self.playing = False
        self._state()

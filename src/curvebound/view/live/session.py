"""One page's scene: stepped in real time, changed, taken back, and put beside another."""

from __future__ import annotations

import time as clock
from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

from ...cosim.fmu import Value
from ...cosim.stepwise import Moment, Stepwise
from ...errors import CurveboundError
from .messages import MOST_PAST, MOST_ROWS, samples, text
from .model import actors_of
from .pace import Pace
from .plan import Plan
from .protocol import Malformed, parse
from .runs import Run, Runs
from .spring import Hand

__all__ = ["TICK", "Session"]

TICK = 1.0 / 60.0  # s between two pictures
_BUDGET = 0.8 * TICK  # s of it for the FMUs
_MOST_UNDONE = 20
_ONE_CHANGE = 0.7  # s: what is changed again within that is undone at once


@dataclass
class Kept:
    """A point to return to."""

    time: float
    moments: dict[int, Moment]  # by key of the run
    values: dict[str, float]
    hand: Hand


class Session:
    """Of one page, from `open` to `close`.

    The page's commands go to `receive`; `tick` steps the scene and gives the messages to send.
    """

    def __init__(self, plan: Plan) -> None:
        self.plan = plan
        self.values = {path: float(one.value) for path, one in plan.controls.items()}
        self.playing = False
        self.reached = plan.scene.start_time  # s: where the page stands
        self.runs = Runs(plan)
        self.pace = Pace()
        self._hand = Hand(plan.scene.step)
        self._undo: list[Kept] = []
        self._mark: Kept | None = None
        self._said: list[str | bytes] = []
        self._changed_at = ("", 0.0)
        self._warned: set[str] = set()
        self.on_record: Callable[[], None] | None = None
        self._restart({})

    # life

    def close(self) -> None:
        """Free the FMUs."""
        self.runs.close()

    @property
    def first(self) -> Stepwise:
        """The run that the page pulls at."""
        return self.runs.first.stepped

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
        if not self.runs.lag(self.reached):
            self._advance()

    def do_speed(self, value: float) -> None:
        self.pace.set_speed(value)
        self._anew()

    def do_reset(self) -> None:
        self._restart(self.runs.first.settings)

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
        self.runs.begin(settings, self.values)
        self._undo.clear()
        self._mark = None
        self._hand = Hand(self.plan.scene.step)
        self.reached = self.plan.scene.start_time
        self._warned.clear()
        self._show_runs()

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
        self.do_beside(name, {**self.runs.first.settings, **self.plan.variant(name)})

    def do_beside(self, label: str, settings: dict[str, Value]) -> None:
        """Another run with the inputs of the first, from the start to where that one is."""
        self.runs.put_beside(label or "beside", settings)
        self._show_runs(kept=True)

    def do_alone(self) -> None:
        self.runs.leave_alone()
        self._show_runs(kept=True)

    def do_pull(self, grip: float, x: float, y: float) -> None:
        if not (0 <= grip < len(self.plan.grips) and float(grip).is_integer()):
            raise Malformed(f"there is no grip {grip!r}")
        wanted = self.plan.grips[int(grip)]
        if not self._hand.holds(wanted):
            self._keep("pull")
        self._hand.pull(wanted, (float(x), float(y)))

    def do_release(self) -> None:
        self._hand.release()

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
            self.runs.drop(self._undo.pop(0).moments)

    def _here(self) -> Kept:
        return Kept(self.reached, self.runs.save(), dict(self.values), self._hand.copy())

    def do_undo(self) -> None:
        if self._undo:
            kept = self._undo.pop()
            self._go_to(kept)
            self.runs.drop(kept.moments)
        self._changed_at = ("", 0.0)

    def do_mark(self) -> None:
        if not self.plan.can_go_back:
            raise CurveboundError(
                "An FMU of this scene cannot save its state, so nor can the page."
            )
        if self._mark is not None:
            self.runs.drop(self._mark.moments)
        self._mark = self._here()

    def do_back(self) -> None:
        if self._mark is None:
            raise CurveboundError("No state is marked: mark one first.")
        later = [one for one in self._undo if one.time > self._mark.time]
        for kept in later:
            self.runs.drop(kept.moments)
            self._undo.remove(kept)
        self._go_to(self._mark)

    def _go_to(self, kept: Kept) -> None:
        """Return to a state; a run that has none of that time computes its way there anew."""
        for number, time in self.runs.go_back(kept.time, kept.moments):
            self.say("cut", run=number, time=time)
        self.values = dict(kept.values)
        self._hand = kept.hand.copy()
        self._hand.release()
        self.reached = kept.time
        self._anew()

    # stepping

    def tick(self) -> list[str | bytes]:
        """Step as far as the time has come; the messages for the page."""
        now = clock.perf_counter()
        deadline = now + _BUDGET
        goal = self.pace.goal(now)
        most = MOST_PAST if self.runs.lag(self.reached) else MOST_ROWS
        try:
            self._catch_up(deadline)
            if self.runs.lag(self.reached):
                self._anew()
            elif self.playing:
                while self.first.upcoming <= goal and clock.perf_counter() < deadline:
                    self._advance()
                self._measure(now)
        except CurveboundError as error:
            self._trouble(error)
        said, self._said = self._said, []
        for number, rows in sorted(self.runs.rows.items()):
            said.append(samples(number, goal if self.playing else self.reached, rows, most))
        self.runs.rows.clear()
        return said

    def _advance(self) -> None:
        """One step of the first run, and of the one beside as many as take it there."""
        self._drive()
        self.reached = self.first.step()
        self.runs.show(0)
        if self.runs.beside is not None:
            self._follow(self.runs.beside)

    def _follow(self, beside: Run) -> None:
        stepped = beside.stepped
        near = self.reached + 1e-9 * stepped.scene.step
        while stepped.alive and stepped.upcoming <= near:
            try:
                stepped.step()
            except CurveboundError as error:  # the first one goes on alone
                self.say("error", text=f"{beside.label}: {error}")
            else:
                self.runs.show(1)

    def _catch_up(self, deadline: float) -> None:
        """Bring runs that begin anew to where the page stands."""
        for number, run in enumerate(self.runs.every):
            stepped = run.stepped
            behind = False
            while stepped.alive and stepped.upcoming <= self.reached:
                behind = True
                if clock.perf_counter() > deadline:
                    return
                stepped.step()
                self.runs.show(number)
            if behind:
                self._state()

    def _drive(self) -> None:
        """Fix what acts from the next communication point on: sliders and the hand."""
        first = self.first
        if not first.alive or self.runs.lag(self.reached):
            return
        added = self._hand.forces(first)
        for path, value in self.values.items():
            self.runs.first.driven[path].put(first.upcoming, value + added.get(path, 0.0))

    def _anew(self) -> None:
        """Let the clock go on from here."""
        self.pace.begin(clock.perf_counter(), self.reached)

    def _measure(self, now: float) -> None:
        """See whether the machine keeps up, and tell now and then, with what FMUs warn of."""
        self.pace.keep(now, self.reached, self.first.upcoming)
        told = self.pace.measured(now, self.reached)
        if told is None:
            return
        self.say("pace", speed=told, late=self.pace.late)
        self.pace.late = False
        for warning in self.first.warnings():
            if warning not in self._warned:
                self._warned.add(warning)
                self.say("note", text=warning)

    # what the page is told

    def _show_runs(self, *, kept: bool = False) -> None:
        """Tell which runs there are; unless `kept`, the page begins anew."""
        self.runs.rows.clear()
        self.say(
            "runs",
            kept=kept,
            runs=[
                {
                    "label": run.label,
                    "settings": run.settings,
                    "actors": actors_of(self.plan, run.stepped.system),
                }
                for run in self.runs.every
            ],
        )
        for number in range(1 if kept else 0, len(self.runs.every)):
            self.runs.show(number)
        self._anew()
        self._state()

    def _state(self) -> None:
        self.say(
            "state",
            playing=self.playing,
            speed=self.pace.speed,
            time=self.reached,
            alive=self.first.alive,
            undo=len(self._undo),
            mark=self._mark.time if self._mark is not None else None,
            values=self.values,
            catching_up=self.runs.lag(self.reached),
        )

    def _trouble(self, error: Exception) -> None:
        """Say what failed; a run that failed stands still until it is taken back or reset."""
        self.say("error", text=str(error))
        if self.runs.every and not self.first.alive:
            self.playing = False
        self._state()

"""The sequence of prepared calls that evaluates a communication point, and that steps.

Which inputs are out of date is known when the sequence is made: a call is in it only where it is
needed, so that running it is a loop over calls without any decision.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Sequence
from ctypes import c_double

import numpy as np
from numpy.typing import NDArray

from .exchange import Call, Exchange
from .graph import Loop
from .instance import Instance
from .lines import Line, lines_of
from .loop_changes import changes_of
from .loops import LoopSolver
from .slopes import Slopes
from .system import Port, System

__all__ = ["TRIAL", "Clock", "Schedule"]

Values = tuple[NDArray[np.float64], NDArray[np.int32], list[tuple[float, float]]]
TRIAL = 1  # where a state is saved while another is


class Clock:
    """Time and size of a step, as the prepared fmi2DoStep calls read them, in s.

    leads: called with both before a step.
    """

    def __init__(self) -> None:
        self.time = c_double()
        self.size = c_double()
        self.leads: list[Callable[[float, float], None]] = []

    def set(self, time: float, size: float) -> None:
        """The step about to be taken begins at `time` and is `size` long."""
        self.time.value = time
        self.size.value = size
        for lead in self.leads:
            lead(time, size)


class Schedule:
    """Everything that the algorithms call."""

    def __init__(self, system: System, exchange: Exchange, instances: dict[str, Instance]) -> None:
        self.system = system
        self.exchange = exchange
        self.instances = instances
        self._lines: dict[Port, Line] = {}
        if system.scene.hold == "first":
            self._lines = lines_of(system, exchange, instances, self.run)
        meeting = {port: line.meet for port, line in self._lines.items()}
        self._signals = list({**exchange.signal_setters(), **meeting}.values())
        self.advance: Callable[[float, float], None] | None = None  # made by algorithms.advance_of
        self._states = {
            name: exchange.read(instances[name], 0) for name in system.nodes
        }  # outputs that are functions of the state alone
        self._users: dict[str, dict[int, list[str]]] = {}  # component -> level -> whom it feeds
        for name, feeders in exchange.feeders.items():
            for source, of in feeders.items():
                level = system.levels[source]
                self._users.setdefault(of, {}).setdefault(level, []).append(name)
        self._with_signals = {port[0] for port in system.signals}
        self._stale: set[str] = set()
        self._solvers: list[LoopSolver] = []
        self.evaluation = self._evaluation(system.levels, system.loops)

    # making sequences

    def _freshen(self, name: str) -> list[Call]:
        if name not in self._stale:
            return []
        self._stale.discard(name)
        return self.exchange.write(self.instances[name])

    def _changed(self, name: str, level: int) -> None:
        self._stale.update(self._users.get(name, {}).get(level, ()))

    def _evaluation(self, levels: dict[Port, int], loops: Sequence[Loop[Port]]) -> list[Call]:
        """Calls that bring the outputs with direct feedthrough up to date, in dependency order."""
        self._stale = {name for name in self.system.nodes if self.exchange.feeders[name]}
        self._stale |= self._with_signals
        by_level: dict[int, dict[str, None]] = {}
        for port, level in levels.items():
            by_level.setdefault(level, {})[port[0]] = None
        calls: list[Call] = []
        for level in sorted(by_level.keys() - {0}):
            for name in by_level[level]:
                calls += self._freshen(name)
                calls += self.exchange.read(self.instances[name], level)
            for name in by_level[level]:
                self._changed(name, level)
            self._solvers += [
                self._solver(loop.members, [level])
                for loop in loops
                if levels[loop.members[0]] == level
            ]
            calls += [solver for solver in self._solvers if solver not in calls]
        self._after_evaluation = set(self._stale)
        return calls

    def _solver(self, members: Sequence[Port], levels: Sequence[int]) -> LoopSolver:
        names = list(dict.fromkeys(port[0] for port in members))
        ports = [port for port in members if self.system.variable(port).kind == "Real"]
        evaluation = [call for name in names for call in self.exchange.write(self.instances[name])]
        for name in names:
            for level in levels:
                evaluation += self.exchange.read(self.instances[name], level)
        return LoopSolver(
            places=[self.exchange.place[port] for port in ports],
            names=[".".join(port) for port in ports],
            scales=[self.system.variable(port).nominal or 1.0 for port in ports],
            values=self.exchange.reals,
            evaluation=evaluation,
            run=self.run,
            tolerance=self.system.scene.loop_tolerance or 1e-9,
            changes=changes_of(self.system, self.exchange, self.instances, members, self.run),
        )

    def initialize(self, time: float) -> None:
        """Propagate outputs to inputs in initialization mode, by the dependencies declared for it.

        Slow and simple: it runs once.
        """
        system, exchange = self.system, self.exchange
        every = sorted(set(system.levels.values()))
        for solver in self._solvers:
            solver.begin()
        for line in self._lines.values():
            line.forget()
        for put in self._signals:
            put(time)
        for level in sorted(set(system.initial_levels.values())):
            ports = [port for port, at in system.initial_levels.items() if at == level]
            for name in dict.fromkeys(port[0] for port in ports):
                if level > 0:
                    self.run(exchange.write(self.instances[name]))
                for of in every:
                    self.run(exchange.read(self.instances[name], of))
            for loop in system.initial_loops:
                if system.initial_levels[loop.members[0]] == level:
                    self._solver(loop.members, every)()
        self.write_all()

    def stepping(self, names: Iterable[str], clock: Clock, *, passing_on: bool) -> list[Call]:
        """Calls that step components and read what their states determine.

        passing_on: new outputs reach the components that step later, as System.passing says
        (Gauss-Seidel); otherwise all of them step from the same values (Jacobi).
        """
        names = list(names)
        self._stale = set(self._after_evaluation)
        calls: list[Call] = []
        reads: list[Call] = []
        setters: dict[str, list[Call]] = {}
        if self.system.scene.hold == "first":
            handed_on = self._handed_on(names) if passing_on else ()
            shared = self.system, self.exchange, self.instances
            slopes = Slopes(*shared, names, handed_on, self._lines)
            clock.leads += slopes.leads
            for name in slopes.sources:
                calls += self._freshen(name)
            calls += slopes.reads
            setters = slopes.setters
        for name in names:
            calls += self._freshen(name)
            calls += setters.get(name, [])
            calls.append(self.exchange.do_step(self.instances[name], clock.time, clock.size))
            if passing_on and name in self.system.passing:
                calls += self._states[name]
                self._changed(name, 0)
            else:
                reads += self._states[name]
        return calls + reads

    def _handed_on(self, names: Sequence[str]) -> list[Port]:
        """Inputs that take new outputs of components that step before theirs."""
        rank = {name: i for i, name in enumerate(names)}
        return [
            link.target
            for link in self.system.links
            if link.source[0] in self.system.passing
            and self.system.levels[link.source] == 0
            and rank.get(link.source[0], len(names)) < rank.get(link.target[0], -1)
        ]

    # running them

    def run(self, calls: Iterable[Call]) -> None:
        """Make prepared calls; CallFailed when one fails."""
        for call in calls:
            status = call()
            if status and status > 1:
                component, function = self.exchange.origin(call)
                self.instances[component].fail(function, status)

    def read_states(self) -> None:
        """Read all outputs that are functions of the state alone."""
        for calls in self._states.values():
            self.run(calls)

    def read_all(self, name: str) -> None:
        """Read every output of one component as it is, its inputs left as they are."""
        for level in sorted(set(self.system.levels.values())):
            self.run(self.exchange.read(self.instances[name], level))

    def evaluate(self, time: float) -> None:
        """Inputs and outputs of the communication point `time`, consistent with one another."""
        for put in self._signals:
            put(time)
        self.run(self.evaluation)

    def write_all(self) -> None:
        """Set every driven input of every component from the buffers."""
        for name in self.system.nodes:
            self.run(self.exchange.write(self.instances[name]))

    # rollback

    def save(self, place: int = 0) -> Values:
        """Save all states within the FMUs; returns the buffers, to be given to `restore`.

        place: 0, or TRIAL for a state saved while another is.
        """
        for instance in self.instances.values():
            instance.save(place)
        return self.values()

    def restore(self, saved: Values, place: int = 0) -> None:
        """Back to where `save` was called, the inputs included."""
        for instance in self.instances.values():
            instance.restore(place)
        self.hold(saved)

    def values(self) -> Values:
        """A copy of the buffers."""
        states = [line.state for line in self._lines.values()]
        return self.exchange.reals.copy(), self.exchange.others.copy(), states

    def hold(self, values: Values) -> None:
        """Set the buffers, and every driven input from them."""
        self.exchange.reals[:], self.exchange.others[:], states = values
        self.write_all()
        for line, state in zip(self._lines.values(), states, strict=True):
            line.resume(state)

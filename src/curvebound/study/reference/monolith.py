"""A scene as one system of equations: what it would do if nothing but its own rules cost accuracy.

Two readings. As the scene stands, a component without state (a control law) acts, and an input
function is applied, at the scene's communication points, and what it says is held until the next:
a sampled loop, which an exact integration of the rest reproduces. Taken as `continuous`, both act
all the time: the limit of small macro steps. A law with a sample period of its own keeps it either
way. Components with a state exchange values continuously.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

from ...cosim.points import communication_times
from ...cosim.system import port_of
from ...errors import CurveboundError
from .equations import Array, Equations, Witness, system_of

if TYPE_CHECKING:
    from ...cosim.system import Node, Port, System

__all__ = ["Monolith", "equations_of"]

Number = np.longdouble
Value = Any  # a number, an enumeration item's name, or an array over the members


def equations_of(node: Node, changes: Mapping[str, Value]) -> Equations:
    """The equations of a component with its parameters; `changes` by variable name on top."""
    parameters: dict[str, Any] = {}
    for variable in node.fmu.variables.values():
        if variable.causality != "parameter" or variable.kind == "String":
            continue
        value: Value = node.start.get(variable.name, variable.start or 0)
        value = changes.get(variable.name, value)
        if variable.items is not None:
            number = variable.value(value)
            value = next(name for name, item in variable.items.items() if item == number)
        else:
            # scalars stay scalars: a single start is then computed five times as fast
            array = np.asarray(value, dtype=np.float64).astype(Number)
            value = array if array.size > 1 else array.reshape(-1)[0]
        parameters[variable.name] = value
    return system_of(node.fmu).equations(parameters)


@dataclass
class _Part:
    name: str
    equations: Equations
    witness: Witness | None
    place: slice
    sources: dict[str, Port | None]  # input -> what drives it: an output, itself if a signal, None


class Monolith:
    """The equations of all components of a scene that was checked.

    changes: parameter values by path, on top of the scene's: numbers, items, or arrays over the
        members of an ensemble.
    witness: whether components are integrated in their second coordinates.
    """

    def __init__(
        self,
        system: System,
        changes: Mapping[str, Value] | None = None,
        *,
        continuous: bool = False,
        witness: bool = False,
    ) -> None:
        self.system = system
        self.continuous = continuous
        self.links = {link.target: link for link in system.links}
        self.parts: dict[str, _Part] = {}
        self.held: dict[Port, Array] = {}
        self.history: list[tuple[float, dict[Port, Array]]] = []
        self._constants: dict[Port, Array] = {}
        changed = {port_of(path): value for path, value in (changes or {}).items()}
        at = 0
        for name, node in system.nodes.items():
            own = {variable: value for (of, variable), value in changed.items() if of == name}
            equations = equations_of(node, own)
            second = system_of(node.fmu).witness if witness else None
            form = second(equations) if second is not None else None
            count = len((form or equations).start())
            sources = {i: self._source(node, i) for i in node.fmu.inputs}
            self.parts[name] = _Part(name, equations, form, slice(at, at + count), sources)
            at += count
        self.size = at
        columns = [np.atleast_1d(x) for p in self.parts.values() for x in self._start(p)]
        self.members = max((c.shape[-1] for c in columns), default=1)
        for value in (changes or {}).values():
            self.members = max(self.members, np.size(value) if not isinstance(value, str) else 1)
        self.laws = [p for p in self.parts.values() if p.place.start == p.place.stop]
        self.periods = {p.name: self._period(p) for p in self.laws}

    def _source(self, node: Node, name: str) -> Port | None:
        port = (node.name, name)
        if port in self.links:
            return self.links[port].source
        if port in self.system.signals:
            return port
        variable = node.fmu.variables[name]
        value = float(variable.value(node.start.get(name, variable.start or 0.0)))
        self._constants[port] = Number(value)
        return None

    @staticmethod
    def _start(part: _Part) -> list[Array]:
        return (part.witness or part.equations).start()

    def _period(self, part: _Part) -> float:
        """s between the actions of a law, 0 for one that acts all the time."""
        own = part.equations.period()
        if self.continuous:
            return own
        step = self.system.scene.step
        share = own / step if own > step else step / (own or step)
        if abs(share - round(share)) > 1e-9 * share:
            raise CurveboundError(
                f"There is no reference for component {part.name}: its sample.period, {own} s, and "
                f"the scene's step, {step} s, do not divide one another; make one a multiple of "
                "the other."
            )
        return max(own, step)

    def start(self) -> Array:
        """The initial state, shape (n, members)."""
        state = np.zeros((self.size, self.members), dtype=Number)
        for part in self.parts.values():
            for i, value in enumerate(self._start(part)):
                state[part.place.start + i] = value
        return state

    # evaluation

    def _value(self, part: _Part, name: str, time: Array, state: Array) -> Array:
        """An input at a time, from held values, constants, links and signals."""
        source = part.sources[name]
        if source is None:
            return self._constants[(part.name, name)]
        held: Array | None = self.held.get(source)
        if source == (part.name, name):  # a signal
            return held if held is not None else self._signal(source, time)
        if held is None:
            of = self.parts[source[0]]
            inputs = _Inputs(self, of, time, state)
            held = of.equations.outputs([source[1]], time, self._common(of, state), inputs)[
                source[1]
            ]
        link = self.links[(part.name, name)]
        if link.factor != 1.0 or link.offset != 0.0:
            held = np.asarray(held) * Number(link.factor) + Number(link.offset)
        return held

    def _signal(self, port: Port, time: Array) -> Array:
        function = self.system.signals[port]
        values = np.array([function(float(t)) for t in np.ravel(time)], dtype=np.float64)
        shaped: Array = values.astype(Number).reshape(np.shape(time))[()]
        return shaped

    def _common(self, part: _Part, state: Array) -> Sequence[Array]:
        own = list(state[part.place])
        return own if part.witness is None else part.witness.common(own)

    def rates(self, time: Array, state: Array) -> Array:
        """Rates of the state, both of shape (n, ...), at times that broadcast to the rest."""
        result = np.empty(state.shape, dtype=Number)
        for part in self.parts.values():
            if part.place.start == part.place.stop:
                continue
            inputs = _Inputs(self, part, time, state)
            form = part.witness or part.equations
            for i, rate in enumerate(form.rates(time, list(state[part.place]), inputs)):
                result[part.place.start + i] = rate
        return result

    # sampling

    def events(self, stop: float) -> Iterator[float]:
        """Times after the start, up to `stop`, at which the rates may jump or bend."""
        scene = self.system.scene
        if self.is_sampled:
            yield from communication_times(scene.start_time, stop, scene.step, self.system.stops)[
                1:
            ]
            return
        found = {stop}
        for part in self.laws:
            found.update(part.equations.breaks())
            period = self.periods[part.name]
            if period:
                count = int((stop - scene.start_time) / period + 1e-9)
                found.update(scene.start_time + n * period for n in range(1, count + 1))
        for function in self.system.signals.values():
            found.update(_jumps(function, scene.start_time, stop))
        yield from sorted(t for t in found if scene.start_time < t <= stop)

    @property
    def is_sampled(self) -> bool:
        """Whether anything is held from one communication point to the next."""
        return not self.continuous and bool(self.laws or self.system.signals)

    def sample(self, time: float, state: Array) -> None:
        """Let what acts at `time` act; state (n, members)."""
        due = [part for part in self.laws if self._is_due(part, time)]
        signals = [] if self.continuous else list(self.system.signals)
        if not due and not signals:
            return
        at = Number(time)
        state = state if self.members > 1 else state[:, 0]
        for port in [*((p.name, o) for p in due for o in self._outputs(p)), *signals]:
            self.held.pop(port, None)
        fresh: dict[Port, Array] = {port: self._signal(port, at) for port in signals}
        self.held.update(fresh)
        for part in due:
            inputs = _Inputs(self, part, at, state)
            out = part.equations.outputs(self._outputs(part), at, [], inputs)
            fresh |= {(part.name, name): value for name, value in out.items()}
        self.held.update(fresh)
        self.history.append((time, dict(self.held)))

    def _outputs(self, part: _Part) -> list[str]:
        return self.system.nodes[part.name].fmu.outputs

    def _is_due(self, part: _Part, time: float) -> bool:
        period = self.periods[part.name]
        if not period:
            return False
        begin = self.system.scene.start_time
        n = (time - begin) / period
        return abs(n - round(n)) < 1e-6

    # observation

    def observe(self, paths: Sequence[str], times: Array, states: Array) -> dict[str, Array]:
        """Outputs by path, shape (k, members), at times (k,) from states (n, k, members)."""
        times = np.asarray(times, dtype=np.float64)
        kept = self.held
        if self.history:
            starts = np.array([t for t, _ in self.history])
            slack = 1e-12 * np.maximum(1.0, np.abs(times))
            index = np.clip(np.searchsorted(starts, times + slack, "right") - 1, 0, None)
            self.held = {
                port: np.stack([np.broadcast_to(self.history[i][1][port], (self.members,))
                                for i in index])
                for port in self.history[0][1]
            }  # fmt: skip
        at = times.astype(Number)[:, None]
        result = {}
        try:
            for path in paths:
                port = name, variable = port_of(path)
                part = self.parts[name]
                if port in self.held:
                    value = self.held[port]
                else:
                    inputs = _Inputs(self, part, at, states)
                    found = part.equations.outputs(
                        [variable], at, self._common(part, states), inputs
                    )
                    value = found[variable]
                result[path] = np.broadcast_to(value, (len(times), self.members))
        except KeyError as error:
            known = [
                f"{part.name}.{variable}"
                for part in self.parts.values()
                for variable in system_of(self.system.nodes[part.name].fmu).main
            ]
            raise CurveboundError(
                f"There is no reference for the output {path}: the equations do not define it. "
                f"They define, among others, {', '.join(known)}."
            ) from error
        finally:
            self.held = kept
        return result


class _Inputs(Mapping[str, Array]):
    """The inputs of a part, evaluated when asked for."""

    def __init__(self, monolith: Monolith, part: _Part, time: Array, state: Array) -> None:
        self._monolith = monolith
        self._part = part
        self._time = time
        self._state = state
        self._known: dict[str, Array] = {}

    def __getitem__(self, name: str) -> Array:
        value = self._known.get(name)
        if value is None:
            value = self._monolith._value(self._part, name, self._time, self._state)
            self._known[name] = value
        return value

    def __iter__(self) -> Iterator[str]:
        return iter(self._part.sources)

    def __len__(self) -> int:
        return len(self._part.sources)


def _jumps(function: Any, begin: float, end: float, pieces: int = 4000) -> list[float]:
    """Times at which a function of time jumps, found by halving; kinks are left to the steps."""
    times = np.linspace(begin, end, pieces + 1)
    values = np.array([function(float(t)) for t in times])
    size = float(np.ptp(values))
    found = []
    for i in np.flatnonzero(np.abs(np.diff(values)) > 1e-3 * size):
        a, b, at_a, at_b = float(times[i]), float(times[i + 1]), values[i], values[i + 1]
        whole = abs(at_b - at_a)
        while abs(at_b - at_a) > 0.3 * whole:
            middle = 0.5 * (a + b)
            if not a < middle < b:
                found.append(b)  # as near as numbers get, and still a difference
                break
            at = function(middle)
            if abs(at - at_a) > abs(at_b - at):
                b, at_b = middle, at
            else:
                a, at_a = middle, at
    return found

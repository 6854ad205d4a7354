"""Values between FMUs: buffers laid out once, and the FMI calls on them prepared once.

All Real values of a scene lie in one array, all others in another. An output's place is chosen so
that what one call reads is contiguous, and inputs that all come from one component, in a row, are
written from where they were read: most scenes copy nothing.
"""

from __future__ import annotations

from collections.abc import Callable
from ctypes import Array, byref, c_double, c_int, c_size_t, c_uint, c_void_p
from functools import partial
from typing import Any

import numpy as np
from numpy.typing import NDArray

from .instance import Instance
from .signals import Signal, value_of
from .system import Link, Port, System, path_of

__all__ = ["Call", "Exchange"]

Call = Callable[[], Any]  # an FMI call that returns its status, or a copy that returns None
KINDS = ("Real", "Integer", "Boolean")
_FEW = 4  # runs of values up to which slices are copied one by one


class Exchange:
    """The buffers of a scene, and for each component the prepared calls.

    reals, others: the values, shapes (n,) of float64 and int32.
    place: where each output's value lies in the array of its kind.
    """

    def __init__(self, system: System) -> None:
        self.system = system
        self.place: dict[Port, int] = {}
        self._segments: dict[tuple[str, str, int], tuple[int, list[Port]]] = {}
        self._inputs: dict[tuple[str, str], tuple[int, list[Port]]] = {}
        self._calls: dict[int, tuple[str, str]] = {}
        self._kept: list[Any] = []  # the prepared calls, whose ids are keys above
        self._reads: dict[tuple[str, int], list[Call]] = {}
        self._writes: dict[str, list[Call]] = {}
        self.feeders: dict[str, dict[Port, str]] = {name: {} for name in system.nodes}
        self._link: dict[Port, Link] = {link.target: link for link in system.links}
        self._lay_out()

    # layout

    def _lay_out(self) -> None:
        system = self.system
        users: dict[Port, Port] = {}  # output -> first input it drives
        rank = {
            name: {v: i for i, v in enumerate(node.fmu.variables)}
            for name, node in system.nodes.items()
        }
        for link in system.links:
            self.feeders[link.target[0]][link.source] = link.source[0]
            first = users.setdefault(link.source, link.target)
            if link.target < first:
                users[link.source] = link.target

        def order(port: Port) -> tuple[Any, ...]:
            user = users.get(port)
            if user is None:
                return (1, "", 0, rank[port[0]][port[1]])
            return (0, user[0], rank[user[0]][user[1]], 0)

        groups: dict[tuple[str, str, int], list[Port]] = {}
        for port, level in system.levels.items():
            key = (port[0], system.variable(port).kind, level)
            groups.setdefault(key, []).append(port)
        self._size = {"Real": 0, "Integer": 0}
        for key in sorted(groups, key=lambda k: (k[2], k[0], k[1])):
            ports = sorted(groups[key], key=order)
            at = self._reserve(key[1], len(ports))
            self._segments[key] = (at, ports)
            for i, port in enumerate(ports):
                self.place[port] = at + i
        self.outputs_end = dict(self._size)
        driven: dict[tuple[str, str], list[Port]] = {}
        for target in [*self._link, *system.signals]:
            driven.setdefault((target[0], system.variable(target).kind), []).append(target)
        for group, targets in driven.items():
            self._place_inputs(group, targets)
        self.reals: NDArray[np.float64] = np.zeros(self._size["Real"])
        self.others: NDArray[np.int32] = np.zeros(self._size["Integer"], dtype=np.int32)

    def _reserve(self, kind: str, count: int) -> int:
        array = "Real" if kind == "Real" else "Integer"
        at = self._size[array]
        self._size[array] += count
        return at

    def _place_inputs(self, group: tuple[str, str], targets: list[Port]) -> None:
        def source(target: Port) -> int:
            link = self._link.get(target)
            return -1 if link is None else self.place[link.source]

        targets = sorted(targets, key=source)
        places = [source(t) for t in targets]
        plain = all(
            t in self._link and self._link[t].is_plain and self._is_of(group[1], t) for t in targets
        )
        one = len({self._link[t].source[0] for t in targets if t in self._link}) == 1
        if plain and one and places == list(range(places[0], places[0] + len(places))):
            self._inputs[group] = (places[0], targets)  # written from where they were read
        else:
            self._inputs[group] = (self._reserve(group[1], len(targets)), targets)

    # prepared calls

    def _array(self, kind: str) -> NDArray[Any]:
        return self.reals if kind == "Real" else self.others

    def _transfer(
        self, instance: Instance, what: str, kind: str, at: int, ports: list[Port]
    ) -> Call:
        references = (c_uint * len(ports))(*(self.system.variable(p).reference for p in ports))
        array = self._array(kind)
        values = c_void_p(array.ctypes.data + at * array.itemsize)
        return self.prepare(instance, what + kind, references, c_size_t(len(ports)), values)

    def read(self, instance: Instance, level: int) -> list[Call]:
        """Calls that read this component's outputs of a level; made once."""
        known = self._reads.get((instance.name, level))
        if known is not None:
            return known
        calls = []
        for kind in KINDS:
            at, ports = self._segments.get((instance.name, kind, level), (0, []))
            if ports:
                calls.append(self._transfer(instance, "Get", kind, at, ports))
        self._reads[instance.name, level] = calls
        return calls

    def write(self, instance: Instance) -> list[Call]:
        """Calls that bring this component's driven inputs up to date; none if it is led."""
        known = self._writes.get(instance.name)
        if known is not None:
            return known
        calls: list[Call] = []
        for kind in KINDS:
            at, targets = self._inputs.get((instance.name, kind), (0, []))
            if targets and instance.name not in self.system.led:
                calls += self._copies(kind, at, targets)
                calls.append(self._transfer(instance, "Set", kind, at, targets))
        self._writes[instance.name] = calls
        return calls

    def _is_of(self, kind: str, target: Port) -> bool:
        """Whether what drives `target` lies in the array of this kind."""
        return (self.system.variable(self._link[target].source).kind == "Real") == (kind == "Real")

    def _copies(self, kind: str, at: int, targets: list[Port]) -> list[Call]:
        joined = [(at + i, self._link[t]) for i, t in enumerate(targets) if t in self._link]
        pairs = [
            (to, self.place[link.source]) for to, link in joined if self._is_of(kind, link.target)
        ]
        calls: list[Call] = []
        if pairs and pairs[0][0] != pairs[0][1]:
            calls += self._moves(kind, pairs)
        others = [
            (to, self.place[link.source])
            for to, link in joined
            if not self._is_of(kind, link.target)
        ]
        array = self._array(kind)
        if others:  # whole numbers into the Real array
            to, source = np.array(others).T
            calls.append(_converting(array, to, self.others, source))
        calls += [_mapping(array, to, link.mapping) for to, link in joined if link.mapping]
        scaled = [(to, link) for to, link in joined if (link.factor, link.offset) != (1.0, 0.0)]
        if scaled:
            calls.append(
                _scaling(
                    array,
                    np.array([to for to, _ in scaled]),
                    np.array([link.factor for _, link in scaled]),
                    np.array([link.offset for _, link in scaled]),
                )
            )
        return calls

    def _moves(self, kind: str, pairs: list[tuple[int, int]]) -> list[Call]:
        """Copies within one array, of (to, from)."""
        array = self._array(kind)
        view = memoryview(array)  # type: ignore[arg-type]
        runs: list[list[int]] = []
        for to, source in pairs:
            if runs and to == runs[-1][0] + runs[-1][2] and source == runs[-1][1] + runs[-1][2]:
                runs[-1][2] += 1
            else:
                runs.append([to, source, 1])
        if len(runs) <= _FEW:
            return [
                partial(view.__setitem__, slice(to, to + n), view[source : source + n])
                for to, source, n in runs
            ]
        return [_gathering(array, [s for _, s in pairs], [to for to, _ in pairs])]

    def do_step(self, instance: Instance, time: c_double, size: c_double) -> Call:
        """The call that steps this component from `time` by `size`, both read when it is made."""
        scene = self.system.scene
        keeps = c_int(not (scene.rolls_back or scene.goes_back))  # no rollback behind this point
        return self.prepare(instance, "DoStep", time, size, keeps)

    def prepare(self, instance: Instance, function: str, *arguments: Any) -> Call:
        """The call of an FMI function of `instance`, which reads arrays and doubles when made."""
        given = (instance.pointer, *arguments)
        call = partial(instance.library.function("fmi2" + function), *map(_converted, given))
        self.register(call, instance.name, function)
        return call

    def register(self, call: Call, component: str, function: str) -> None:
        """Take a call made elsewhere, so that its failure can be told of."""
        self._calls[id(call)] = (component, function)
        self._kept.append(call)

    def setting(self, instance: Instance, target: Port) -> Call:
        """The call that sets one Real input."""
        return self._transfer(instance, "Set", "Real", self.input_place(target), [target])

    def input_place(self, target: Port) -> int:
        """Where the value of a driven input lies in the array of its kind."""
        at, targets = self._inputs[target[0], self.system.variable(target).kind]
        return at + targets.index(target)

    def forget_calls(self) -> None:
        """Drop what belongs to instances that are gone."""
        self._calls.clear()
        self._kept.clear()
        self._reads.clear()
        self._writes.clear()

    def origin(self, call: Call) -> tuple[str, str]:
        """Component and FMI function of a prepared call."""
        return self._calls[id(call)]

    def signal_setters(self) -> dict[Port, Callable[[float], None]]:
        """For each input that a function drives: what puts its value at a time in s into place."""
        setters = {}
        for (_, kind), (at, targets) in self._inputs.items():
            view = memoryview(self._array(kind))  # type: ignore[arg-type]
            for i, target in enumerate(targets):
                if target in self.system.signals:
                    function = self.system.signals[target]
                    whole = kind != "Real"
                    setters[target] = _putting(function, path_of(target), view, at + i, whole)
        return setters


def _putting(
    function: Signal, path: str, values: memoryview, place: int, whole: bool
) -> Callable[[float], None]:
    def put(time: float) -> None:
        value = value_of(function, path, time)
        values[place] = int(value) if whole else value  # type: ignore[assignment]

    return put


def _converted(argument: Any) -> Any:
    """A ctypes object as ctypes hands it on: converted once, not at each call."""
    if isinstance(argument, Array):
        return byref(argument)
    if isinstance(argument, c_double):
        return argument
    return type(argument).from_param(argument.value)


def _gathering(array: NDArray[Any], sources: list[int], to: list[int]) -> Call:
    index = np.array(sources)
    if to != list(range(to[0], to[0] + len(to))):
        return _converting(array, np.array(to), array, index)
    part = array[to[0] : to[0] + len(to)]

    def gather() -> None:
        array.take(index, None, part, "clip")

    return gather


def _converting(
    array: NDArray[Any], to: NDArray[Any], other: NDArray[Any], source: NDArray[Any]
) -> Call:
    def convert() -> None:
        array[to] = other[source]

    return convert


def _mapping(array: NDArray[Any], to: int, mapping: dict[int, int]) -> Call:
    def replace() -> None:
        value = int(array[to])
        array[to] = mapping.get(value, value)

    return replace


def _scaling(
    array: NDArray[Any], index: NDArray[Any], factor: NDArray[Any], offset: NDArray[Any]
) -> Call:
    def scale() -> None:
        array[index] = array[index] * factor + offset

    return scale

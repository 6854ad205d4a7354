"""Inputs linear in time over a macro step, from what drives them (first-order hold).

A function of time is known ahead: its input goes in a straight line from its value at the start of
the step to that just before the end, so that a jump at a communication point is met where it is and
nothing overshoots. An input that another FMU drives is extrapolated with the derivative of that
output at the start of the step. What cannot tell its derivative, or was handed on within the step
(gauss_seidel), is held.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Sequence
from ctypes import c_double, c_int, c_size_t, c_uint
from typing import Any

from .exchange import Call, Exchange
from .instance import Instance
from .lines import Line
from .system import Link, Port, System

__all__ = ["Slopes", "has_slopes"]


def is_sloped(system: System, link: Link) -> bool:
    """Whether source and target of a connection can do what `hold` = first asks."""
    variable = system.variable(link.source)
    return (
        not link.mapping
        and variable.kind == "Real"
        and variable.variability == "continuous"
        and system.nodes[link.source[0]].fmu.gives_rates
        and system.takes_slope(link.target)
    )


def has_slopes(system: System) -> bool:
    """Whether any input of a scene can be linear in time: whether `hold` = first is a choice."""
    return any(system.takes_slope(target) for target in system.signals) or any(
        is_sloped(system, link) for link in system.links
    )


class Slopes:
    """The calls that ask for derivatives of outputs, and set those of inputs, of one step.

    names: components that step. handed_on: inputs that take what their source has reached at the
    end of the step. lines: of the inputs that functions drive.

    leads: find the slopes of these, called with time and size of the step (s) before all others.
    reads: find the derivatives at the start of the step, once inputs are those of its start. An
    output with direct feedthrough rises with the inputs of its component: it is asked after these
    have got the slopes that are known by then; in an algebraic loop those from outside it.
    setters: by component, set what `reads` has not.
    """

    def __init__(
        self,
        system: System,
        exchange: Exchange,
        instances: dict[str, Instance],
        names: Sequence[str],
        handed_on: Iterable[Port],
        lines: dict[Port, Line],
    ) -> None:
        self.system = system
        self.exchange = exchange
        self.instances = instances
        held = set(handed_on)
        self._links = [
            link
            for link in system.links
            if link.target[0] in names and link.target not in held and is_sloped(system, link)
        ]
        self._places: dict[Port, tuple[Any, int]] = {}
        self._led: dict[str, tuple[list[Port], Any]] = {}
        self.leads: list[Callable[[float, float], None]] = []
        for name in names:
            ports = [port for port in lines if port[0] == name]
            if ports:
                led = (c_double * len(ports))()
                self._led[name] = ports, led
                self.leads += [lines[port].leading(_view(led), k) for k, port in enumerate(ports)]
        self.reads: list[Call] = []
        complete: set[str] = set()
        sources: dict[int, dict[str, list[Port]]] = {}
        for port in dict.fromkeys(link.source for link in self._links):
            sources.setdefault(self._level(port), {}).setdefault(port[0], []).append(port)
        for level, of in sorted(sources.items()):
            risen = [name for name in of if level > 0 and name in names]
            self.reads += [call for name in risen for call in self._setter(name)]
            complete |= {name for name in risen if self._is_complete(name)}
            found: dict[Port, tuple[Any, int]] = {}
            for name, ports in of.items():
                buffer = (c_double * len(ports))()
                found |= {port: (buffer, k) for k, port in enumerate(ports)}
                self.reads.append(self._call(name, "GetRealOutputDerivatives", ports, buffer))
            self._places |= found
        self.setters = {name: self._setter(name) for name in names if name not in complete}

    @property
    def sources(self) -> list[str]:
        """Components whose outputs are asked for their derivatives."""
        return list(dict.fromkeys(link.source[0] for link in self._links))

    def _level(self, port: Port) -> int:
        """When an output is asked: with the last of its component unless somebody needs it before.

        One call instead of two then.
        """
        levels = self.system.levels
        users = {link.target[0] for link in self._links if link.source == port}
        asked = {link.source for link in self._links}
        last = max(levels[other] for other in asked if other[0] == port[0])
        needed = any(levels[port] < levels[p] <= last for p in asked if p[0] in users)
        return levels[port] if needed else last

    def _is_complete(self, name: str) -> bool:
        return all(link.source in self._places for link in self._links if link.target[0] == name)

    def _setter(self, name: str) -> list[Call]:
        """The calls that set the slopes known so far, from where they were found if possible."""
        ports, led = self._led.get(name, ([], None))
        known = [(port, 1.0, led, k) for k, port in enumerate(ports)]
        known += [
            (link.target, link.factor, *self._places[link.source])
            for link in self._links
            if link.target[0] == name and link.source in self._places
        ]
        if not known:
            return []
        targets = [target for target, *_ in known]
        places = [(k, *place) for k, (_, *place) in enumerate(known)]
        slopes = known[0][2]
        calls: list[Call] = []
        if not all(f == 1.0 and array is slopes and i == k for k, f, array, i in places):
            slopes = (c_double * len(known))()
            calls.append(_copying(slopes, places))
        return [*calls, self._call(name, "SetRealInputDerivatives", targets, slopes)]

    def _call(self, name: str, function: str, ports: Sequence[Port], values: Any) -> Call:
        references = (c_uint * len(ports))(*(self.system.variable(p).reference for p in ports))
        orders = (c_int * len(ports))(*([1] * len(ports)))
        count = c_size_t(len(ports))
        return self.exchange.prepare(
            self.instances[name], function, references, count, orders, values
        )


def _copying(slopes: Any, rates: Sequence[tuple[int, float, Any, int]]) -> Call:
    """Slopes from others: place, factor, array, place in it."""
    to = _view(slopes)
    steps = [(k, factor, _view(array), i) for k, factor, array, i in rates]

    def copy() -> None:
        for k, factor, view, i in steps:
            to[k] = factor * view[i]

    return copy


def _view(array: Any) -> memoryview[float]:
    """The numbers of a ctypes array: read and written in less time than through it."""
    return memoryview(array).cast("B").cast("d")

"""Inputs linear in time over a macro step, from what drives them (first-order hold).

A function of time is known ahead: its input goes in a straight line from its value at the start of
the step to that just before the end, so that a jump at a communication point is met where it is and
nothing overshoots. An input that another FMU drives is extrapolated with the derivative of that
output at the start of the step. What cannot tell its derivative, or was handed on within the step
(gauss_seidel), is held.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from ctypes import c_double, c_int, c_size_t, c_uint
from typing import Any

from .exchange import Call, Exchange
from .instance import Instance
from .signals import Signal, value_of
from .system import Link, Port, System, path_of

__all__ = ["Slopes", "has_slopes"]

#: of a step before its end, at which a function is asked for the value at the end
EARLY = 1e-6


def takes_slope(system: System, target: Port) -> bool:
    """Whether an input may be linear in time."""
    variable = system.variable(target)
    return (
        variable.kind == "Real"
        and variable.causality == "input"
        and system.nodes[target[0]].fmu.takes_slopes
    )


def is_sloped(system: System, link: Link) -> bool:
    """Whether source and target of a connection can do what `hold` = first asks."""
    variable = system.variable(link.source)
    return (
        not link.mapping
        and variable.kind == "Real"
        and variable.variability == "continuous"
        and system.nodes[link.source[0]].fmu.gives_rates
        and takes_slope(system, link.target)
    )


def has_slopes(system: System) -> bool:
    """Whether any input of a scene can be linear in time: whether `hold` = first is a choice."""
    return any(takes_slope(system, target) for target in system.signals) or any(
        is_sloped(system, link) for link in system.links
    )


class Slopes:
    """The calls that ask for derivatives of outputs, and set those of inputs, of one step.

    names: components that step. handed_on: inputs that take what their source has reached at the
    end of the step. time, size: of the step (s), read when a call is made.

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
        time: c_double,
        size: c_double,
    ) -> None:
        self.system = system
        self.exchange = exchange
        self.instances = instances
        self.time = time
        self.size = size
        held = set(handed_on)
        self._links = [
            link
            for link in system.links
            if link.target[0] in names and link.target not in held and is_sloped(system, link)
        ]
        self._places: dict[Port, tuple[Any, int]] = {}
        self.reads: list[Call] = []
        complete: set[str] = set()
        sources: dict[int, dict[str, list[Port]]] = {}
        for port in dict.fromkeys(link.source for link in self._links):
            sources.setdefault(self._level(port), {}).setdefault(port[0], []).append(port)
        for level, of in sorted(sources.items()):
            risen = [name for name in of if level > 0 and name in names]
            self.reads += [setter for name in risen if (setter := self._setter(name))]
            complete |= {name for name in risen if self._is_complete(name)}
            found: dict[Port, tuple[Any, int]] = {}
            for name, ports in of.items():
                buffer = (c_double * len(ports))()
                found |= {port: (buffer, k) for k, port in enumerate(ports)}
                self.reads.append(self._call(name, "GetRealOutputDerivatives", ports, buffer))
            self._places |= found
        last = {name: self._setter(name) for name in names if name not in complete}
        self.setters = {name: setter for name, setter in last.items() if setter}

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

    def _setter(self, name: str) -> Call | None:
        """The call that sets the slopes known so far; None if there are none."""
        joined = [
            link for link in self._links if link.target[0] == name and link.source in self._places
        ]
        signals = [
            (port, function)
            for port, function in self.system.signals.items()
            if port[0] == name and takes_slope(self.system, port)
        ]
        if not joined and not signals:
            return None
        targets = [port for port, _ in signals] + [link.target for link in joined]
        slopes = (c_double * len(targets))()
        known = [
            (k, function, path_of(port), self.exchange.input_place(port))
            for k, (port, function) in enumerate(signals)
        ]
        copies = [
            (len(signals) + k, *self._places[link.source], link.factor)
            for k, link in enumerate(joined)
        ]
        call = self._call(name, "SetRealInputDerivatives", targets, slopes)
        return self._filled(call, known, copies, slopes)

    def _call(self, name: str, function: str, ports: Sequence[Port], values: Any) -> Call:
        references = (c_uint * len(ports))(*(self.system.variable(p).reference for p in ports))
        orders = (c_int * len(ports))(*([1] * len(ports)))
        count = c_size_t(len(ports))
        return self.exchange.prepare(
            self.instances[name], function, references, count, orders, values
        )

    def _filled(
        self,
        call: Call,
        signals: Sequence[tuple[int, Signal, str, int]],
        copies: Sequence[tuple[int, Any, int, float]],
        slopes: Any,
    ) -> Call:
        """A call with its slopes.

        signals: place, function, path, place of its value; copies: place, rates, place in them,
        factor.
        """
        values = memoryview(self.exchange.reals)  # type: ignore[arg-type]
        found = memoryview(slopes).cast("B").cast("d")
        time, size = self.time, self.size

        def set_slopes() -> Any:
            if signals:
                ahead = size.value * (1.0 - EARLY)
                end = time.value + ahead
                for k, function, path, place in signals:
                    found[k] = (value_of(function, path, end) - values[place]) / ahead
            for k, rates, i, factor in copies:
                found[k] = factor * rates[i]
            return call()

        self.exchange.register(set_slopes, *self.exchange.origin(call))
        return set_slopes

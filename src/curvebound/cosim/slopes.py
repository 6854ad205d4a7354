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
from functools import partial
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
    """The calls that ask for derivatives of outputs, and set those of inputs."""

    def __init__(self, system: System, exchange: Exchange, instances: dict[str, Instance]) -> None:
        self.system = system
        self.exchange = exchange
        self.instances = instances

    def calls(
        self, names: Sequence[str], time: c_double, size: c_double, handed_on: Iterable[Port]
    ) -> tuple[list[Call], dict[str, Call]]:
        """Calls that find derivatives at the start of a step, and by component one that sets them.

        time, size: of the step (s), read when it is made. handed_on: inputs that take what their
        source has reached at the end of the step.
        """
        held = set(handed_on)
        links = [
            link
            for link in self.system.links
            if link.target[0] in names and link.target not in held and is_sloped(self.system, link)
        ]
        reads: list[Call] = []
        places: dict[Port, tuple[Any, int]] = {}
        for name in dict.fromkeys(link.source[0] for link in links):
            ports = list(dict.fromkeys(link.source for link in links if link.source[0] == name))
            buffer = (c_double * len(ports))()
            places |= {port: (buffer, k) for k, port in enumerate(ports)}
            reads.append(self._call(name, "GetRealOutputDerivatives", ports, buffer))
        setters: dict[str, Call] = {}
        for name in names:
            joined = [link for link in links if link.target[0] == name]
            signals = [(p, f) for p, f in self.system.signals.items() if p[0] == name]
            signals = [(p, f) for p, f in signals if takes_slope(self.system, p)]
            if joined or signals:
                targets = [p for p, _ in signals] + [link.target for link in joined]
                slopes = (c_double * len(targets))()
                known = [(f, path_of(p), self.exchange.input_place(p)) for p, f in signals]
                copies = [
                    (len(signals) + k, *places[link.source], link.factor)
                    for k, link in enumerate(joined)
                ]
                call = self._call(name, "SetRealInputDerivatives", targets, slopes)
                setters[name] = self._setter(call, known, copies, slopes, time, size)
        return reads, setters

    def _call(self, name: str, function: str, ports: Sequence[Port], values: Any) -> Call:
        instance = self.instances[name]
        references = (c_uint * len(ports))(*(self.system.variable(p).reference for p in ports))
        orders = (c_int * len(ports))(*([1] * len(ports)))
        call = partial(
            instance.library.function("fmi2" + function),
            instance.pointer,
            references,
            c_size_t(len(ports)),
            orders,
            values,
        )
        self.exchange.register(call, name, function)
        return call

    def _setter(
        self,
        call: Call,
        signals: Sequence[tuple[Signal, str, int]],
        copies: Sequence[tuple[int, Any, int, float]],
        slopes: Any,
        time: c_double,
        size: c_double,
    ) -> Call:
        """signals: function, path, place of its value; copies: place, rates, place in them, factor.

        Slopes are those of the signals, then of the copies.
        """
        values = memoryview(self.exchange.reals)  # type: ignore[arg-type]

        numbered = [(k, *known) for k, known in enumerate(signals)]

        def set_slopes() -> Any:
            if numbered:
                ahead = size.value * (1.0 - EARLY)
                end = time.value + ahead
                for k, function, path, place in numbered:
                    slopes[k] = (value_of(function, path, end) - values[place]) / ahead
            for k, rates, i, factor in copies:
                slopes[k] = factor * rates[i]
            return call()

        self.exchange.register(set_slopes, *self.exchange.origin(call))
        return set_slopes

"""How the outputs of an algebraic loop change with one another, from directional derivatives."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from ctypes import c_double, c_size_t, c_uint, c_void_p

import numpy as np
from numpy.typing import NDArray

from .exchange import Call, Exchange
from .instance import Instance
from .system import Link, Port, System

__all__ = ["LoopChanges", "changes_of"]


def changes_of(
    system: System,
    exchange: Exchange,
    instances: dict[str, Instance],
    members: Sequence[Port],
    run: Callable[[Sequence[Call]], None],
) -> LoopChanges | None:
    """Those of a loop; None where a component of it has no directional derivatives."""
    inside = set(members)
    links = [
        link
        for link in system.links
        if link.source in inside and link.target[0] in {name for name, _ in members}
    ]
    known = all(
        system.nodes[name].fmu.gives_changes and system.variable((name, output)).kind == "Real"
        for name, output in members
    ) and all(
        system.variable(link.target).kind == "Real"
        and system.variable(link.target).causality == "input"
        for link in links
    )
    return LoopChanges(system, exchange, instances, members, links, run) if known else None


class LoopChanges:
    """dg/dx of a loop x = g(x): each output of a component by the members that drive its inputs."""

    def __init__(
        self,
        system: System,
        exchange: Exchange,
        instances: dict[str, Instance],
        members: Sequence[Port],
        links: Sequence[Link],
        run: Callable[[Sequence[Call]], None],
    ) -> None:
        self._run = run
        self._calls: list[Call] = []
        #: for each call: what it writes, the rows and the column that this adds to
        self._parts: list[tuple[NDArray[np.float64], list[int], int]] = []
        self._matrix = np.zeros((len(members), len(members)))
        for link in links:
            name = link.target[0]
            rows = [i for i, port in enumerate(members) if port[0] == name]
            unknowns = (c_uint * len(rows))(*(system.variable(members[i]).reference for i in rows))
            found = np.zeros(len(rows))
            call = exchange.prepare(
                instances[name],
                "GetDirectionalDerivative",
                unknowns,
                c_size_t(len(rows)),
                (c_uint * 1)(system.variable(link.target).reference),
                c_size_t(1),
                (c_double * 1)(link.factor),
                c_void_p(found.ctypes.data),
            )
            self._calls.append(call)
            self._parts.append((found, rows, members.index(link.source)))

    def __call__(self) -> NDArray[np.float64]:
        """dg/dx where the components are now; valid until the next call."""
        self._run(self._calls)
        self._matrix[:] = 0.0
        for values, rows, column in self._parts:
            self._matrix[rows, column] += values
        return self._matrix

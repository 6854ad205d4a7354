"""Recorded communication points, kept in arrays that grow."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from .exchange import Exchange
from .system import System

__all__ = ["Recording"]


class Recording:
    """Rows of all values that are read, or of the recorded ones where those are few."""

    def __init__(self, system: System, exchange: Exchange, rows: int) -> None:
        self._system = system
        self._exchange = exchange
        self._count = 0
        self._times = np.zeros(rows)
        self._parts = [
            _Part(exchange.reals, self._places("Real"), exchange.outputs_end["Real"], rows),
            _Part(exchange.others, self._places("Other"), exchange.outputs_end["Integer"], rows),
        ]
        self._parts = [part for part in self._parts if part.wanted.size]

    def _places(self, kind: str) -> list[int]:
        real = kind == "Real"
        return [
            self._exchange.place[port]
            for port in self._system.recorded
            if (self._system.variable(port).kind == "Real") == real
        ]

    def keep(self, time: float) -> None:
        """Record the present values as those of `time`."""
        row = self._count
        if row == len(self._times):
            self._times = _longer(self._times)
            for part in self._parts:
                part.grow()
        self._times[row] = time
        for part in self._parts:
            part.keep(row)
        self._count = row + 1

    def table(self) -> NDArray[Any]:
        """Structured array of what was recorded: time, then the outputs in the order asked for."""
        table = np.zeros(self._count, dtype=self._system.row_type(self._system.recorded))
        table["time"] = self._times[: self._count]
        for port in self._system.recorded:
            part = self._parts[0 if self._system.variable(port).kind == "Real" else -1]
            table[".".join(port)] = part.column(self._exchange.place[port])[: self._count]
        return table


class _Part:
    """The recorded values of one array."""

    def __init__(self, values: NDArray[Any], places: list[int], end: int, rows: int) -> None:
        self.wanted = np.array(sorted(places), dtype=np.intp)
        self._values = values
        # copying a short row whole is quicker than picking from it
        self._all = end <= max(32, 2 * len(places))
        self._source = values[:end]
        self._where = {int(p): (int(p) if self._all else i) for i, p in enumerate(self.wanted)}
        self._rows = np.zeros((rows, end if self._all else len(places)), dtype=values.dtype)

    def keep(self, row: int) -> None:
        if self._all:
            self._rows[row] = self._source
        else:
            self._values.take(self.wanted, None, self._rows[row], "clip")

    def grow(self) -> None:
        self._rows = _longer(self._rows)

    def column(self, place: int) -> NDArray[Any]:
        return self._rows[:, self._where[place]]


def _longer(array: NDArray[Any]) -> NDArray[Any]:
    more = np.zeros((max(64, 2 * len(array)), *array.shape[1:]), dtype=array.dtype)
    more[: len(array)] = array
    return more

"""A session whose clock is the test's, and what it tells its page."""

from __future__ import annotations

import json
from collections.abc import Iterator
from contextlib import contextmanager
from typing import Any

import numpy as np

from curvebound.view.live import session as module
from curvebound.view.live.plan import Plan
from curvebound.view.live.session import Session


class Clock:
    """Stands in for the wall's clock in view/live/session.py."""

    def __init__(self) -> None:
        self.now = 1000.0

    def perf_counter(self) -> float:
        return self.now


class Page:
    """What a page would see: events, the rows of each run, and what acts on the first one."""

    def __init__(self, session: Session, clock: Clock) -> None:
        self.session = session
        self.clock = clock
        self.events: list[dict[str, Any]] = []
        self.rows: dict[int, list[np.ndarray]] = {0: [], 1: []}
        self.outputs = 1 + len(session.first.columns)
        self.acting: list[dict[str, float]] = []
        self.pictures()

    def send(self, command: str, **fields: Any) -> bool:
        return self.session.receive(json.dumps({"do": command, **fields}))

    def pictures(self, count: int = 1) -> None:
        for _ in range(count):
            for message in self.session.tick():
                self._hear(message)
            self.clock.now += module.TICK

    def _hear(self, message: str | bytes) -> None:
        if isinstance(message, str):
            event = json.loads(message)
            self.events.append(event)
            if event["event"] == "runs":
                for number in range(1 if event["kept"] else 0, 2):
                    self.rows[number].clear()
            elif event["event"] == "cut":
                kept = [row for row in self.rows[event["run"]] if row[0] <= event["time"]]
                self.rows[event["run"]] = kept
            return
        numbers = np.frombuffer(message)
        shown = self.session.plan.shown
        table = numbers[2:].reshape(-1, self.outputs + len(shown))
        self.rows[int(numbers[0])] += list(table[:, : self.outputs])
        if not numbers[0]:
            drawn = table[:, self.outputs :].tolist()
            self.acting += [dict(zip(shown, row, strict=True)) for row in drawn]

    def value(self, name: str, run: int = 0) -> float:
        return float(self.rows[run][-1][1 + self.session.first.columns.index(name)])

    def said(self, event: str) -> list[str]:
        return [one["text"] for one in self.events if one["event"] == event]

    @property
    def state(self) -> dict[str, Any]:
        return [one for one in self.events if one["event"] == "state"][-1]


@contextmanager
def opened(plan: Plan) -> Iterator[Page]:
    clock = Clock()
    module.clock, before = clock, module.clock  # type: ignore[assignment]
    session = Session(plan)
    try:
        yield Page(session, clock)
    finally:
        session.close()
        module.clock = before

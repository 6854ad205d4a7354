"""The engine of a control law."""

from __future__ import annotations

from collections.abc import Callable

from ..kernel.law import Law
from .derivatives import DerivativeEngine
from .engine import Engine, System
from .table import WARNING, Table

__all__ = ["Controller", "ControllerEngine"]


class ControllerEngine(DerivativeEngine):
    """A control law."""

    def __init__(self, table: Table, guid: str, factory: Callable[[], Law]) -> None:
        self.factory = factory
        self.law: Law = factory()
        super().__init__(table, guid)

    def reset(self) -> None:
        super().reset()
        self.said_late: bool = False

    def start_system(self, reals: dict[str, float], choices: dict[str, int]) -> str:
        law: Law = self.factory()
        law.start(reals, choices, self.time)
        self.law = law
        self.grouped(law.OUTPUTS, law.FEEDTHROUGH)
        return ""

    def take_inputs(self) -> None:
        if self.retuned:
            reals, choices = self.parameters()
            self.law.set_parameters(reals, choices)
            self.retuned = False
        self.law.set_inputs(self.reals, self.table.first_input)

    def observe(self, group: int) -> None:
        self.law.observe(group, self.reals, self.table.first_output)

    def find_rates(self, group: int) -> None:
        self.law.find_rates(group, self.slopes.each, self.rates, self.table.first_output)

    def has_changes(self) -> bool:
        return self.law.HAS_CHANGES

    def output_changes(self, seeds: list[float]) -> list[float]:
        return self.law.output_changes(seeds)

    def advance(self, duration: float) -> str:
        self.law.keep()
        self.kept = True
        if not self.said_late:
            late = self.law.late(self.time, duration)
            if late:
                self.said_late = True
                self.say(WARNING, late)
        self.law.advance(self.time, duration, self.slopes.each)
        # what the slopes have made of the inputs
        self.pending = self.slopes.given
        return ""

    def undo(self) -> None:
        self.law.undo()

    def system_state(self) -> list[list[float]]:
        return [self.law.get_state()]

    def restore_system(self, state: list[list[float]]) -> None:
        if not self.bad_value():
            self.take_inputs()
        self.law.set_state(state[0])


class Controller(System):
    """Engines of a control law."""

    def __init__(self, factory: Callable[[], Law]) -> None:
        self.factory = factory

    def create(self, table: Table, guid: str) -> Engine:
        return ControllerEngine(table, guid, self.factory)

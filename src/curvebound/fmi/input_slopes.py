"""Inputs that are linear in time: their slopes over one communication step."""

from __future__ import annotations

from typing import Final

from ..kernel.base import MOST_INPUTS, Inputs, Values
from .table import LARGEST, Table

__all__ = ["InputSlopes"]

NO_SLOPE: Final = -1


class InputSlopes:
    """Slopes of the inputs over the step to come, in 1/s times their units; then they are none."""

    def __init__(self, table: Table) -> None:
        self.first: int = table.first_input
        self.count: int = min(table.first_output - table.first_input, MOST_INPUTS)
        self.each: Inputs = [0.0] * MOST_INPUTS
        #: whether any is not zero
        self.given: bool = False
        #: inputs and slopes at the start of a step
        self.kept_inputs: Inputs = [0.0] * MOST_INPUTS
        self.kept: Inputs = [0.0] * MOST_INPUTS

    def take(self, vr: int, value: float) -> None:
        """Let an input have a slope."""
        if vr - self.first < self.count:
            self.each[vr - self.first] = value
            self.given = self.given or value != 0.0

    def begin(self, reals: Values, step_size: float) -> int:
        """Remember inputs and slopes; the first input whose slope cannot be used, or NO_SLOPE."""
        for i in range(self.count):
            slope = self.each[i]
            self.kept[i] = slope
            if slope != 0.0:
                x: float = reals[self.first + i]
                self.kept_inputs[i] = x
                if not abs(x + slope * step_size) <= LARGEST or not abs(slope) <= LARGEST:
                    return self.first + i
        return NO_SLOPE

    def end(self, reals: Values, step_size: float) -> None:
        """Leave the inputs where their slopes have brought them."""
        self.given = False
        for i in range(self.count):
            slope = self.each[i]
            if slope != 0.0:
                reals[self.first + i] = self.kept_inputs[i] + slope * step_size
                self.each[i] = 0.0

    def restore(self, reals: Values) -> None:
        """Undo end()."""
        self.given = True
        for i in range(self.count):
            self.each[i] = self.kept[i]
            if self.each[i] != 0.0:
                reals[self.first + i] = self.kept_inputs[i]

    def get_state(self) -> list[float]:
        """The slopes."""
        return [self.each[i] for i in range(self.count)]

    def set_state(self, state: list[float]) -> None:
        """Return to a get_state()."""
        self.given = False
        for i in range(self.count):
            self.each[i] = state[i]
            self.given = self.given or self.each[i] != 0.0

"""What an engine tells of derivatives, and what it takes of them."""

from __future__ import annotations

import math
from typing import Final

from ..kernel.base import MOST_VARIABLES, Values
from .engine import INITIALIZATION, INSTANTIATED, Engine
from .table import COUNT, INPUT, LARGEST, NO_GROUP, OUTPUT, OVERFLOW, RATE, Table

__all__ = ["DerivativeEngine"]

_NO_INPUT: Final = "is no input: fmi2SetRealInputDerivatives sets derivatives of inputs alone"
_NO_OUTPUT: Final = (
    "has no derivative: fmi2GetRealOutputDerivatives gives those of outputs that are no counts"
)
_NO_UNKNOWN: Final = (
    "is no output and cannot be the unknown of a directional derivative: "
    "fmi2GetDirectionalDerivative gives those of outputs by inputs"
)
_NO_KNOWN: Final = (
    "is no input and cannot be the known of a directional derivative: "
    "fmi2GetDirectionalDerivative gives those of outputs by inputs"
)


class DerivativeEngine(Engine):
    """Slopes of inputs, rates of outputs, and changes of outputs with inputs."""

    def __init__(self, table: Table, guid: str) -> None:
        #: time derivatives of the outputs, at their places in `reals`
        self.rates: Values = [0.0] * MOST_VARIABLES
        super().__init__(table, guid)

    # -- what subclasses know ----------------------------------------------------------------------
    def find_rates(self, group: int) -> None:
        """Compute the time derivatives of the outputs of a group into `rates`."""
        raise NotImplementedError

    def output_changes(self, seeds: list[float]) -> list[float]:
        """Derivatives of all outputs along `seeds` of the inputs; infinite where there is none."""
        raise NotImplementedError

    # -- slopes and rates --------------------------------------------------------------------------
    def set_real_input_derivatives(
        self, vrs: list[int], orders: list[int], values: list[float]
    ) -> None:
        """Make inputs linear in time over the next step, and over that step alone.

        Allowed at any time before it; their values are those at its start.
        """
        for i in range(len(vrs)):
            self.take_slope(vrs[i], orders[i], values[i])

    def take_slope(self, vr: int, order: int, value: float) -> None:
        """Make one input linear in time over the next step."""
        if order == 1 and self.is_kind(vr, INPUT):
            self.fresh &= RATE - 1
            self.slopes.take(vr, value)
        elif self.is_one_of(vr, INPUT, INPUT, _NO_INPUT):
            self.fail(
                f"order = {order} of the derivative of {self.table.names[vr]} cannot be used: "
                "inputs are linear in time at most, give the derivative of order 1"
            )

    def get_real_output_derivatives(self, vrs: list[int], orders: list[int]) -> list[float]:
        """Time derivatives of outputs at the present time; 0 with a message where there is none."""
        return [self.rate(vrs[i], orders[i]) for i in range(len(vrs))]

    def rate(self, vr: int, order: int) -> float:
        """The time derivative of one output; found when first asked for after a change."""
        table = self.table
        if order != 1 or not self.is_kind(vr, OUTPUT):
            if self.is_one_of(vr, OUTPUT, OUTPUT, _NO_OUTPUT):
                self.fail(
                    f"order = {order} of the derivative of {table.names[vr]} is not known: ask for "
                    "order 1"
                )
            return 0.0
        if table.rates[vr] != NO_GROUP:
            return self.real(table.rates[vr])
        if not self.ready():
            return 0.0
        group: int = self.layout.groups[vr]
        if not self.fresh & (RATE << group):
            self.refresh_rates(group)
        value: float = self.rates[vr]
        if not -OVERFLOW <= value <= OVERFLOW:
            value = 0.0
            self.fail(
                f"the derivative of {table.names[vr]} does not fit a floating-point number "
                f"at time {self.time!r} s: rescale the parameters"
            )
        return value

    def refresh_rates(self, group: int) -> None:
        """Find the rates of a group of outputs; infinite ones where that is impossible."""
        try:
            self.find_rates(group)
            self.fresh |= RATE << group
        except (ZeroDivisionError, OverflowError, ValueError):
            members: list[int] = self.layout.members[group]
            vr: int
            for vr in members:
                self.rates[vr] = math.inf

    # -- directional derivatives -------------------------------------------------------------------
    def get_directional_derivative(
        self, unknowns: list[int], knowns: list[int], seed: list[float]
    ) -> list[float]:
        """Changes of outputs with inputs of the same instant: J seed; 0 with a message if wrong."""
        table = self.table
        nothing = [0.0] * len(unknowns)
        for vr in unknowns:
            if not self.is_one_of(vr, OUTPUT, COUNT, _NO_UNKNOWN):
                return nothing
        seeds = [0.0] * (table.first_output - table.first_input)
        for i in range(len(knowns)):
            vr = knowns[i]
            if not self.is_one_of(vr, INPUT, INPUT, _NO_KNOWN):
                return nothing
            if not abs(seed[i]) <= LARGEST:
                self.fail(
                    f"the seed {seed[i]!r} of {table.names[vr]} cannot be used: give a finite "
                    f"number, at most {LARGEST!r} in size"
                )
                return nothing
            seeds[vr - table.first_input] += seed[i]
        if not self.has_known_changes():
            return nothing
        changes = self.output_changes(seeds)
        values: list[float] = []
        for vr in unknowns:
            value: float = changes[vr - table.first_output] if vr < table.first_count else 0.0
            if not -OVERFLOW <= value <= OVERFLOW:
                value = 0.0
                self.fail(
                    f"the directional derivative of {table.names[vr]} does not fit a "
                    f"floating-point number at time {self.time!r} s: rescale the parameters"
                )
            values.append(value)
        return values

    # -- what may be asked for ---------------------------------------------------------------------
    def is_kind(self, vr: int, kind: int) -> bool:
        """Whether a value reference is that of a variable of the kind."""
        return 0 <= vr < self.table.size and self.table.kinds[vr] == kind

    def is_one_of(self, vr: int, first: int, last: int, wrong: str) -> bool:
        """Whether a Real variable is of the kinds from first to last; says `wrong` of it if not."""
        table = self.table
        if vr < 0 or vr >= table.size or not table.is_real(vr):
            self.unknown(vr, "Real")
            return False
        kind: int = table.kinds[vr]
        if first <= kind <= last:
            return True
        return self.fail(f"{table.names[vr]} {wrong}")

    def has_known_changes(self) -> bool:
        """Whether the system is there, with its inputs, and knows its changes; says if not."""
        if self.mode == INSTANTIATED:
            return self.out_of_order(
                "fmi2GetDirectionalDerivative", "after fmi2EnterInitializationMode"
            )
        message = self.start() if self.mode == INITIALIZATION and self.stale else ""
        if not message:
            message = self.bad_value()
        if message:
            return self.fail(message)
        if not self.has_changes():
            return self.fail(
                "fmi2GetDirectionalDerivative is not offered by this FMU, as its "
                "modelDescription.xml says"
            )
        return self.ready()

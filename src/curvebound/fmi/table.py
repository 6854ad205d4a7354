"""The variables of an FMU as an engine needs them, and its log messages."""

from __future__ import annotations

import math
from typing import Annotated, Final

from ..kernel.base import MOST_VARIABLES

__all__ = ["ERROR", "WARNING", "Layout", "Message", "Table"]

# fmi2Status
WARNING: Final = 1
ERROR: Final = 3

# kinds of variables, in the order of their value references
PARAMETER: Final = 0
CHOICE: Final = 1
COUNT_PARAMETER: Final = 2
INPUT: Final = 3
OUTPUT: Final = 4
COUNT: Final = 5

#: beyond this a square no longer fits a float: the state counts as having left the finite numbers
LARGEST: Final = 1e150
#: stands in for an output that does not fit a float
OVERFLOW: Final = 1.7976931348623157e308
#: an upper bound of ulp(x) / x
EPSILON: Final = 2.220446049250313e-16
#: markers in the table of output groups
NO_GROUP: Final = -1
NOT_REAL: Final = -2
#: what is up to date: bit k stands for the outputs of group k, bit RATES + k for their rates
RATES: Final = 15
RATE: Final = 1 << RATES  # of the first group

Marks = Annotated[list[int], MOST_VARIABLES]


def rate_of(names: list[str], vr: int) -> int:
    """The variable that is the time derivative of another by its name; NO_GROUP for none."""
    name = names[vr]
    owner, _, last = name.rpartition(".")
    for rate in (
        f"{name}_rate",
        f"{owner}.angular_velocity" if last == "angle" else "",
        f"{owner}.v{last}" if last in ("x", "y") else "",
    ):
        if rate in names:
            return names.index(rate)
    return NO_GROUP


class Message:
    """A log message as PythonFMU's wrapper reads it."""

    def __init__(self, status: int, category: str, msg: str) -> None:
        self.status = status
        self.category = category
        self.msg = msg
        self.debug = False


class Layout:
    """The groups in which a system's outputs are computed; shared by the instances that have it."""

    def __init__(
        self, outputs: dict[str, int], groups: list[int], members: list[list[int]], counts: int
    ) -> None:
        #: the outputs by name, with the group of each
        self.outputs = outputs
        #: group by value reference: NO_GROUP for what needs no computation, else NOT_REAL
        self.groups: Marks = [0] * MOST_VARIABLES
        for vr in range(len(groups)):
            self.groups[vr] = groups[vr]
        #: the outputs of each group
        self.members = members
        #: the group of the counts
        self.counts = counts


class Table:
    """The variables of an FMU by value reference; shared by its instances."""

    def __init__(
        self,
        names: list[str],
        kinds: list[int],
        units: list[str],
        starts: list[float],
        minima: list[float],
        above: list[bool],
        tunable: list[bool],
        items: list[list[str]],
    ) -> None:
        if len(names) > MOST_VARIABLES:
            raise ValueError(f"there are {len(names)} variables: at most {MOST_VARIABLES} can be")
        self.names = names
        self.kinds: Marks = [0] * MOST_VARIABLES
        for vr in range(len(kinds)):
            self.kinds[vr] = kinds[vr]
        self.units = units
        self.starts = starts
        #: least allowed value of a parameter (itself excluded where `above`), -inf without bound
        self.minima = minima
        self.above = above
        self.tunable = tunable
        #: names of the items of a choice
        self.items = items
        self.size: int = len(names)
        self.first_input: int = self._first(INPUT)
        self.first_output: int = self._first(OUTPUT)
        self.first_count: int = self._first(COUNT)
        #: by value reference: the variable that is the rate of another, or NO_GROUP
        self.rates: Marks = [0] * MOST_VARIABLES
        for vr in range(self.size):
            self.rates[vr] = rate_of(names, vr)
        self.by_name = {name: i for i, name in enumerate(names)}
        #: that of an instance without a system, then those of the systems met so far
        self.layouts: list[Layout] = [
            Layout(
                {}, [NO_GROUP if self.is_real(vr) else NOT_REAL for vr in range(self.size)], [], 0
            )
        ]

    def _first(self, kind: int) -> int:
        for i in range(self.size):
            if self.kinds[i] >= kind:
                return i
        return self.size

    def is_real(self, vr: int) -> bool:
        kind: int = self.kinds[vr]
        return kind != CHOICE and kind != COUNT_PARAMETER

    def type_of(self, vr: int) -> str:
        """The FMI type of a variable."""
        if self.kinds[vr] == CHOICE:
            return "Enumeration"
        return "Integer" if self.kinds[vr] == COUNT_PARAMETER else "Real"

    # -- in words ----------------------------------------------------------------------------------
    def shown(self, vr: int, real: float, integer: int) -> str:
        """A variable with its value, which is one of these, and unit."""
        if not self.is_real(vr):
            return self.names[vr] + " = " + str(integer)
        unit = self.units[vr]
        return self.names[vr] + " = " + repr(real) + ("" if unit == "1" else " " + unit)

    def outside_domain(self, vr: int, real: float, integer: int) -> str:
        """The message for a parameter whose value, one of these, is outside its domain, or ''."""
        kind: int = self.kinds[vr]
        if kind == CHOICE:
            items = self.items[vr]
            if integer < 1 or integer > len(items):
                listed = ", ".join([f"{i + 1} {item}" for i, item in enumerate(items)])
                shown = self.shown(vr, real, integer)
                return f"{shown} is no item of its enumeration: choose one of {listed}"
            return ""
        least: float = self.minima[vr]
        if kind == COUNT_PARAMETER:
            if integer < least:
                shown = self.shown(vr, real, integer)
                return f"{shown} is too small: set it to at least {int(least)}"
            return ""
        name = self.names[vr]
        if not math.isfinite(real):
            return f"{self.shown(vr, real, integer)} is not finite: set {name} to a finite number"
        if real < least or (self.above[vr] and real <= least):
            wanted = "above" if self.above[vr] else "not below"
            bound = "zero" if least == 0.0 else repr(least)
            return (
                f"{self.shown(vr, real, integer)} is outside its domain: set {name} to a value "
                f"{wanted} {bound}"
            )
        return ""

    def wrong_type(self, vr: int, type_: str) -> str:
        """The message for a value reference that does not belong to a variable of the type."""
        number = vr if vr >= 0 else vr + 4294967296  # PythonFMU's wrapper passes signed integers
        if number < self.size:
            own = self.type_of(vr)
            function = "Integer" if own == "Enumeration" else own
            return (
                f"value reference {number} is {self.names[vr]} of type {own}, not {type_}: "
                f"use fmi2Get{function} and fmi2Set{function}"
            )
        return (
            f"value reference {number} is not a variable of type {type_}: "
            "use the value references of modelDescription.xml"
        )

    def layout(self, outputs: dict[str, int]) -> Layout:
        """The layout of a system with these outputs, which must be the declared ones."""
        known: Layout
        for known in self.layouts:
            if known.outputs is outputs:
                return known
        declared = self.names[self.first_output : self.first_count]
        if declared != list(outputs):
            raise ValueError(
                f"the outputs are declared as {declared}, but computed as {list(outputs)}"
            )
        first: Layout = self.layouts[0]
        groups = [first.groups[vr] for vr in range(self.size)]
        counts = max(outputs.values()) + 1
        members: list[list[int]] = [[] for _ in range(counts)]
        for name, group in outputs.items():
            vr = self.by_name[name]
            groups[vr] = group
            members[group].append(vr)
        members.append(list(range(self.first_count, self.size)))
        for vr in members[counts]:
            groups[vr] = counts
        found = Layout(outputs, groups, members, counts)
        self.layouts.append(found)
        return found

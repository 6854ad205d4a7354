"""How an FMU's variables are written down: the vocabulary of fmus/NAME/fmu.py.

Value references count the variables of an FMU in the order parameters, choices, integer parameters,
inputs, outputs, integer outputs, whatever the order of their declaration.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, NamedTuple

from .ranges import Explored

if TYPE_CHECKING:
    from .engine import System

__all__ = [
    "CHOICE",
    "COUNT",
    "COUNT_PARAMETER",
    "INPUT",
    "OUTPUT",
    "PARAMETER",
    "Enumeration",
    "Fmu",
    "Variable",
    "choice",
    "count",
    "count_parameter",
    "input_",
    "output",
    "parameter",
]

PARAMETER = "parameter"
CHOICE = "choice"
COUNT_PARAMETER = "count parameter"
INPUT = "input"
OUTPUT = "output"
COUNT = "count"
_ORDER = (PARAMETER, CHOICE, COUNT_PARAMETER, INPUT, OUTPUT, COUNT)


class Enumeration(NamedTuple):
    """An FMI enumeration type; `items` are (name, description), numbered from 1."""

    name: str
    description: str
    items: tuple[tuple[str, str], ...]

    def number(self, item: str) -> int:
        """The number of the item called `item`; ValueError where there is none."""
        return [name for name, _ in self.items].index(item) + 1


class Variable(NamedTuple):
    """One scalar variable: `kind` as above, `minimum` of its domain, itself excluded if `above`."""

    kind: str
    name: str
    unit: str
    start: float
    description: str
    minimum: float | None = None
    above: bool = False
    nominal: float | None = None
    tunable: bool = False
    type: Enumeration | None = None


def parameter(
    name: str,
    unit: str,
    start: float,
    description: str,
    *,
    above: float | None = None,
    at_least: float | None = None,
    nominal: float | None = None,
    tunable: bool = False,
) -> Variable:
    """A Real parameter; its domain is open (`above`) or closed (`at_least`) below."""
    minimum = above if above is not None else at_least
    return Variable(
        PARAMETER, name, unit, start, description, minimum, above is not None, nominal, tunable
    )


def choice(
    name: str, type_: Enumeration, start: str, description: str, *, tunable: bool = False
) -> Variable:
    """An enumeration parameter that starts at the item called `start`."""
    number = type_.number(start)
    return Variable(CHOICE, name, "", number, description, tunable=tunable, type=type_)


def count_parameter(name: str, start: int, description: str, *, at_least: int) -> Variable:
    """An Integer parameter."""
    return Variable(COUNT_PARAMETER, name, "", start, description, at_least)


def input_(name: str, unit: str, description: str, *, nominal: float | None = None) -> Variable:
    """A Real input that starts at zero."""
    return Variable(INPUT, name, unit, 0.0, description, nominal=nominal)


def output(name: str, unit: str, description: str, *, nominal: float | None = None) -> Variable:
    """A Real output."""
    return Variable(OUTPUT, name, unit, 0.0, description, nominal=nominal)


def count(name: str, description: str) -> Variable:
    """A Real output that is a whole number: hosts read every output as a Real."""
    return Variable(COUNT, name, "1", 0.0, description)


class Fmu(NamedTuple):
    """An FMU: its variables, all of them or, beside a mechanics.py, those with something to add.

    `system` is filled in from the kernel: it makes the engines of the FMU's instances.
    `stop_time` and `step_size` (s) are those of DefaultExperiment. It states no tolerance:
    importers would pass it to fmi2SetupExperiment, where it overrides solver.tolerance.
    """

    name: str
    description: str
    variables: tuple[Variable, ...] = ()
    system: System | None = None
    stop_time: float = 10.0
    step_size: float = 0.01
    #: the reference experiment: what inputs and tunable parameters are, constants (enumerations by
    #: item name) or sines (amplitude, Hz), and the outputs to plot
    reference_inputs: dict[str, float | str | tuple[float, float]] = {}
    plotted: tuple[str, ...] = ()
    #: what samples draw, by variable ("gravity": both components), in the order of drawing
    ranges: dict[str, Explored] = {}
    #: the variables that the model description names; none: all. The others keep their start values
    shown: tuple[str, ...] = ()

    def described(self) -> list[tuple[int, Variable]]:
        """The variables that the model description names, each with its value reference."""
        every = enumerate(self.ordered())
        return [(vr, v) for vr, v in every if not self.shown or v.name in self.shown]

    def ordered(self) -> list[Variable]:
        """The variables in the order of their value references."""
        return [v for kind in _ORDER for v in self.variables if v.kind == kind]

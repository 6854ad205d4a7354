"""A scene with every name resolved and everything checked: what the masters work from."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass, field
from functools import cached_property
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ..fmi.drawing import Drawing
from .fmu import Fmu, Value, Variable
from .graph import Loop
from .scene_data import SceneData
from .signals import Signal, value_of

__all__ = ["Link", "Node", "Port", "System", "path_of", "port_of"]

Port = tuple[str, str]  # component, variable


@dataclass
class Node:
    """A component: its FMU, start values in its types, dependencies as the scene takes them."""

    name: str
    fmu: Fmu
    start: dict[str, Value]
    dependencies: dict[str, tuple[str, ...]]
    initial_dependencies: dict[str, tuple[str, ...]]


@dataclass(frozen=True)
class Link:
    """target = factor * source + offset, or what `mapping` makes of a whole number."""

    source: Port
    target: Port
    factor: float = 1.0
    offset: float = 0.0
    mapping: dict[int, int] | None = None

    @property
    def is_plain(self) -> bool:
        """Whether the target's value is the source's."""
        return (self.factor, self.offset) == (1.0, 0.0) and not self.mapping


@dataclass
class System:
    """Everything a master needs. `levels` holds every output that is read at all.

    Those of level 0 are read after a step, those of a higher one once inputs are up to date: an
    output that depends on inputs at once, unless these are `led` and nothing is connected to it.
    order: in which components step; passing: those whose new outputs gauss_seidel hands to the
    components that step later in the same step.
    recorded: outputs to keep, in the order asked for; controlled: outputs whose error the adaptive
    macro step bounds, with their scales.
    stops: times in s at which inputs are known to jump and macro steps end.
    notes: said once to the user, such as inputs that nothing drives.
    """

    scene: SceneData
    nodes: dict[str, Node]
    links: list[Link]
    signals: dict[Port, Signal]
    recorded: list[Port]
    controlled: dict[Port, float]
    levels: dict[Port, int]
    loops: list[Loop[Port]]
    initial_levels: dict[Port, int]
    initial_loops: list[Loop[Port]]
    order: list[str]
    passing: set[str]
    groups: tuple[list[str], list[str]] | None
    stops: list[float] = field(default_factory=list)
    notes: list[str] = field(default_factory=list)

    def variable(self, port: Port) -> Variable:
        """The description of a variable."""
        return self.nodes[port[0]].fmu.variables[port[1]]

    def takes_slope(self, target: Port) -> bool:
        """Whether an input may be linear in time."""
        variable = self.variable(target)
        takes = self.nodes[target[0]].fmu.takes_slopes
        return takes and variable.kind == "Real" and variable.causality == "input"

    @cached_property
    def led(self) -> set[str]:
        """Components that after a step have the inputs of its end, unless a function jumps there.

        Functions drive their inputs, all linear in time, and the FMUs keep these.
        """
        if self.scene.hold != "first":
            return set()
        others = {link.target[0] for link in self.links}
        others |= {port[0] for port in self.signals if not self.takes_slope(port)}
        return {
            port[0]
            for port in self.signals
            if port[0] not in others and self.nodes[port[0]].fmu.keeps_inputs
        }

    def row_type(self, ports: Iterable[Port]) -> list[tuple[str, Any]]:
        """Fields of a result's structured array: time (s), then these outputs by path."""
        kinds = {"Real": np.float64, "Integer": np.int32, "Boolean": np.bool_}
        return [("time", np.float64), *((path_of(p), kinds[self.variable(p).kind]) for p in ports)]

    def units(self, ports: Iterable[Port]) -> dict[str, str]:
        """Unit by path, of those that have one."""
        found = {path_of(port): self.variable(port).unit for port in ports}
        return {path: unit for path, unit in found.items() if unit is not None}

    def drawings(self) -> dict[str, Drawing]:
        """The drawing of each component that has one, with the values of this scene."""
        found = {}
        for node in self.nodes.values():
            drawing = node.fmu.drawing
            if drawing is not None:
                own = {n: float(v) for n, v in node.start.items() if n in drawing.values}
                found[node.name] = drawing._replace(values={**drawing.values, **own}, known=True)
        return found

    def acting(self, data: NDArray[Any]) -> dict[str, NDArray[np.float64]]:
        """Inputs and tunable parameters that drawings show as arrows, by path, shape (points,).

        data: a result of the scene. At each of its points that which is held from there on; an
        input is left out where the output that drives it is not in `data`.
        """
        found = {}
        for node in self.nodes.values():
            for name in sorted(
                node.fmu.drawing.of_arrows() if node.fmu.drawing is not None else ()
            ):
                variable = node.fmu.variables.get(name)
                if variable is None:  # an FMU that was built for one scene has it as a constant
                    continue
                if variable.causality == "input" or variable.variability == "tunable":
                    values = self._input((node.name, name), data)
                    if values is not None:
                        found[f"{node.name}.{name}"] = values
        return found

    def _input(self, port: Port, data: NDArray[Any]) -> NDArray[np.float64] | None:
        """The values of one input at the points of a result; None where they are not known."""
        path, node = path_of(port), self.nodes[port[0]]
        if port in self.signals:
            function = self.signals[port]
            return np.array([value_of(function, path, float(t)) for t in data["time"]])
        link = next((one for one in self.links if one.target == port), None)
        if link is None:
            start = node.start.get(port[1], node.fmu.variables[port[1]].start)
            return np.full(len(data), float(start or 0.0))
        source = path_of(link.source)
        if source not in (data.dtype.names or ()) or link.mapping:
            return None
        return np.asarray(link.factor * data[source] + link.offset, dtype=np.float64)


def path_of(port: Port) -> str:
    """component.variable"""
    return f"{port[0]}.{port[1]}"


def port_of(path: str) -> Port:
    """The component and the variable of a path."""
    component, _, variable = path.partition(".")
    return component, variable

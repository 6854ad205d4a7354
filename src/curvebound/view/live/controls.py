"""What can be changed in a scene: sliders while it runs, settings with a restart, grips to pull."""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import dataclass
from typing import Any

from ...cosim.fmu import Value, Variable
from ...cosim.scene_parts import ALGORITHMS
from ...cosim.system import Node, Port, System, path_of
from ...fmi.drawing import FRAME

__all__ = [
    "OWN_SETTINGS",
    "Control",
    "Grip",
    "controls_of",
    "grips_of",
    "own_settings",
    "settings_of",
]

#: settings of the scene itself that a restart may change
OWN_SETTINGS = ("step", "algorithm")


@dataclass(frozen=True)
class Control:
    """A variable as the page offers it.

    value: at the start. low, high: ends of its slider, from what its FMU declares: minimum and
        maximum, or else as far to either side as its nominal or start value suggests.
    minimum, maximum: its domain, None where it has no end.
    items: of an enumeration, name to number. added: its value adds to what the scene gives.
    """

    path: str
    kind: str
    unit: str
    description: str
    value: Value
    low: float
    high: float
    minimum: float | None
    maximum: float | None
    items: dict[str, int] | None
    added: bool = False

    def take(self, given: Any) -> float:
        """A value from outside in this variable's type; ValueError, which says why not."""
        if isinstance(given, bool) and self.kind != "Boolean":
            raise ValueError(f"{self.path}: {given!r} is no number")
        if isinstance(given, str) or not isinstance(given, int | float):
            raise ValueError(f"{self.path}: give a number")
        value = float(given)
        if not math.isfinite(value):
            raise ValueError(f"{self.path}: {given!r} is not finite; give a finite number")
        if self.items is not None and value not in self.items.values():
            raise ValueError(f"{self.path}: there is no item {given!r}; choose one of the list")
        if self.kind != "Real" and not (value.is_integer() and abs(value) < 2.0**31):
            raise ValueError(f"{self.path}: {given!r} is no whole number of 32 bits")
        for bound, out, word in (
            (self.minimum, self.minimum is not None and value < self.minimum, "least"),
            (self.maximum, self.maximum is not None and value > self.maximum, "most"),
        ):
            if out:
                raise ValueError(
                    f"{self.path}: {value:g} is outside its domain; at {word} {bound:g}"
                )
        return value


@dataclass(frozen=True)
class Grip:
    """A point that can be pulled: the inputs that move it, and where it is, by variable names.

    force: whether the inputs are forces, of the point's mass in kg, or accelerations of a frame.
    """

    component: str
    point: str
    inputs: tuple[str, str]
    position: tuple[str, str]
    velocity: tuple[str, str] | None
    mass: float
    force: bool


def controls_of(system: System) -> list[Control]:
    """The inputs that nothing connects, and the tunable parameters, in the order of the FMUs."""
    connected = {link.target for link in system.links}
    return [
        _control(node, variable, (node.name, variable.name) in system.signals)
        for node, variable in _variables(system)
        if variable.is_drivable and (node.name, variable.name) not in connected
    ]


def settings_of(system: System) -> list[Control]:
    """The parameters that take effect at the start only."""
    return [
        _control(node, variable, False)
        for node, variable in _variables(system)
        if variable.causality == "parameter"
        and variable.is_settable_start
        and not variable.is_drivable
    ]


def own_settings(system: System) -> list[dict[str, Any]]:
    """The scene's macro step and algorithm, as the page shows settings."""
    scene = system.scene
    words = {"step": "macro step", "algorithm": "how coupled components advance"}
    made: list[dict[str, Any]] = []
    for name in OWN_SETTINGS:
        value = getattr(scene, name)
        items = {word: word for word in ALGORITHMS} if name == "algorithm" else None
        unit = "s" if name == "step" else ""
        made.append(
            {
                "path": name,
                "unit": unit,
                "description": words[name],
                "value": value,
                "items": items,
            }
        )
    return made


def _variables(system: System) -> Iterator[tuple[Node, Variable]]:
    for node in system.nodes.values():
        for variable in node.fmu.variables.values():
            if variable.kind != "String":
                yield node, variable


def _control(node: Node, variable: Variable, added: bool) -> Control:
    start = node.start.get(variable.name, variable.start)
    value = variable.value(start) if start is not None else 0
    if added:
        value = 0.0
    minimum = None if variable.minimum is None else float(variable.minimum)
    maximum = None if variable.maximum is None else float(variable.maximum)
    reach = max(2.0 * abs(float(value)), variable.nominal or 1.0)
    low = minimum if minimum is not None else -reach
    high = maximum if maximum is not None else max(reach, low + reach)
    return Control(
        path=path_of((node.name, variable.name)),
        kind=variable.kind,
        unit=variable.unit or "",
        description=variable.description,
        value=value,
        low=low,
        high=high,
        minimum=minimum,
        maximum=maximum,
        items=variable.items,
        added=added,
    )


def grips_of(system: System) -> list[Grip]:
    """The bodies and frames whose inputs nothing connects.

    A body at (NAME.x, NAME.y) is pulled by NAME.fx and NAME.fy in N, a frame by NAME.ax and NAME.ay
    in m/s2.
    """
    connected: set[Port] = {link.target for link in system.links}
    grips = []
    for node in system.nodes.values():
        drawing = node.fmu.drawing
        if drawing is None:
            continue
        places = [(point.name, point.x, point.y, "f") for point in drawing.points]
        places.append((FRAME, *drawing.frame, "a"))
        for name, x, y, letter in places:
            owner = x.rpartition(".")[0]
            inputs = (f"{owner}.{letter}x", f"{owner}.{letter}y")
            free = all(
                variable in node.fmu.inputs and (node.name, variable) not in connected
                for variable in inputs
            )
            if not owner or (x, y) != (f"{owner}.x", f"{owner}.y") or not free:
                continue
            velocity = (f"{owner}.vx", f"{owner}.vy")
            seen = all(one in node.fmu.outputs for one in velocity)
            grips.append(
                Grip(
                    component=node.name,
                    point=name,
                    inputs=inputs,
                    position=(x, y),
                    velocity=velocity if seen else None,
                    mass=_mass(node, f"{owner}.mass") if letter == "f" else 1.0,
                    force=letter == "f",
                )
            )
    return grips


def _mass(node: Node, name: str) -> float:
    """The mass of a body in kg; 1 where no parameter tells it."""
    variable = node.fmu.variables.get(name)
    if variable is None or variable.unit != "kg":
        return 1.0
    start = node.start.get(name, variable.start)
    mass = float(variable.value(start)) if start is not None else 1.0
    return mass if 0.0 < mass < math.inf else 1.0

"""Names to variables: everything that a scene says, checked against its FMUs."""

from __future__ import annotations

import math
import tempfile
from collections.abc import Callable
from fnmatch import fnmatchcase
from pathlib import Path

from ..errors import CurveboundError, OutsideError, nearest
from .capabilities import described, has_unbuilt, lacking, located, stops
from .fmu import Fmu, Value, Variable, read_fmu
from .ordering import Ordering
from .scene_data import SceneData
from .scene_parts import Component
from .scene_settings import unusable
from .signals import Signal, signal
from .system import Link, Node, Port, System, port_of
from .system import path_of as _path

__all__ = ["resolve"]


def resolve(scene: SceneData) -> System:
    """Check the whole scene; CurveboundError lists all that is wrong in it.

    By descriptions first, where systems would have to be compiled.
    """
    if has_unbuilt(scene):
        with tempfile.TemporaryDirectory(prefix="curvebound-described-") as place:
            _Resolution(scene, Path(place)).run()
    return _Resolution(scene).run()


class _Resolution:
    """Collects problems instead of stopping at the first.

    place: folder for descriptions of FMUs, which then are not built.
    """

    def __init__(self, scene: SceneData, place: Path | None = None) -> None:
        self.scene = scene
        self.place = place
        self.problems: list[str] = []
        self.error = CurveboundError
        self.notes: list[str] = list(scene.notes)
        self.nodes: dict[str, Node] = {}
        self.driven: dict[Port, str] = {}  # input -> what drives it, for messages
        self.links: list[Link] = []
        self.signals: dict[Port, Signal] = {}

    def run(self) -> System:
        self.problems += unusable(self.scene)
        for component in self.scene.components.values():
            self._component(component)
        self._stop()  # names below can only be judged against FMUs that were read
        self._connections()
        self._inputs()
        recorded = self._recorded()
        controlled = self._controlled(recorded)
        self._stop()
        self._unconnected()
        self.problems += lacking(self.scene, self.nodes)
        self._stop()
        ordering = Ordering(self.scene, self.nodes, self.links, self.signals)
        system = ordering.system(recorded, controlled, self.notes)
        self.problems += ordering.problems
        self._stop()
        system.stops, late = stops(self.scene, self.nodes, self.signals)
        system.notes += late
        return system

    def _stop(self) -> None:
        if self.problems:
            lines = "".join(f"\n- {problem}" for problem in self.problems)
            plural = "s" if len(self.problems) > 1 else ""
            raise self.error(
                f"The scene {self.scene.name} has {len(self.problems)} problem{plural}:{lines}"
            )

    def _component(self, component: Component) -> None:
        try:
            where = component.source, self.scene.folder
            fmu = read_fmu(described(*where, self.place) if self.place else located(*where))
        except CurveboundError as error:
            self.problems.append(f"component {component.name}: {error}")
            self.error = OutsideError if isinstance(error, OutsideError) else self.error
            return
        start: dict[str, Value] = {}
        for name, given in component.start.items():
            variable = fmu.variables.get(name)
            path = f"{component.name}.{name}"
            if variable is None:
                settable = [v.name for v in fmu.variables.values() if v.is_settable_start]
                self.problems.append(
                    f"{path}: {fmu.model_name} has no such variable; {nearest(name, settable)}"
                )
            elif not variable.is_settable_start:
                self.problems.append(
                    f"{path} is an FMI {variable.causality} that takes no start value; "
                    "set a parameter or an input"
                )
            else:
                try:
                    start[name] = variable.value(given)
                    if start[name] != start[name]:
                        raise ValueError("nan is no value; give a number")
                except ValueError as error:
                    self.problems.append(f"{path}: {error}")
        dependencies = self._feedthrough(component, fmu, fmu.dependencies)
        initial = self._feedthrough(component, fmu, fmu.initial_dependencies)
        self.nodes[component.name] = Node(component.name, fmu, start, dependencies, initial)

    def _feedthrough(
        self, component: Component, fmu: Fmu, declared: dict[str, tuple[str, ...]]
    ) -> dict[str, tuple[str, ...]]:
        given = component.feedthrough
        if given is None:
            return declared
        if given is True:
            return {output: tuple(fmu.inputs) for output in declared}
        taken: dict[str, tuple[str, ...]] = dict.fromkeys(declared, ())
        if given is False:
            return taken
        for output, inputs in given.items():
            for name, known in [(output, fmu.outputs), *((i, fmu.inputs) for i in inputs)]:
                if name not in known:
                    self.problems.append(
                        f"feedthrough of {component.name} names {name}; {nearest(name, known)}"
                    )
            taken[output] = tuple(inputs)
        return taken

    def _port(self, path: str, what: str, fits: Callable[[Variable], bool]) -> Port | None:
        """The variable at `path` if it is `what`; otherwise None, and a problem is noted."""
        name, variable = port_of(path)
        node = self.nodes.get(name)
        if node is None:
            self.problems.append(
                f"{path}: there is no component {name!r}; {nearest(name, self.nodes)}"
            )
            return None
        known = node.fmu.variables.get(variable)
        if known is None or not fits(known):
            of = [v.name for v in node.fmu.variables.values() if fits(v)]
            is_what = "is no" if known is not None else f"names no variable of {name} that is an"
            self.problems.append(f"{path} {is_what} {what}; {nearest(variable, of)}")
            return None
        return name, variable

    def _drive(self, target: Port, by: str) -> bool:
        """Note what drives an input; False, with a problem, when something does already."""
        first = self.driven.setdefault(target, by)
        if first is not by:
            self.problems.append(
                f"{_path(target)} is driven twice, by {first} and by {by}; keep one"
            )
        return first is by

    def _connections(self) -> None:
        for connection in self.scene.connections:
            source = self._port(connection.source, "output", _is_source)
            target = self._port(connection.target, "input", _is_input)
            if source is not None and target is not None and self._drive(target, _path(source)):
                mapping = dict(connection.mapping) if connection.mapping else None
                self._join(source, target, connection.factor, connection.offset, mapping)
        for a, b in self.scene.matches:
            missing = [name for name in (a, b) if name not in self.nodes]
            for name in missing:
                self.problems.append(
                    f"connect_matching({a!r}, {b!r}): there is no component {name!r}; "
                    + nearest(name, self.nodes)
                )
            if missing:
                continue
            inputs = set(self.nodes[b].fmu.inputs)
            common = [name for name in self.nodes[a].fmu.outputs if name in inputs]
            if not common:
                self.problems.append(
                    f"connect_matching({a!r}, {b!r}): no output of {a} has the name of an input "
                    f"of {b}; it has the inputs {', '.join(self.nodes[b].fmu.inputs) or 'none'}"
                )
            for name in common:
                if self.driven.get((b, name)) != f"{a}.{name}" and self._drive(
                    (b, name), f"{a}.{name}"
                ):
                    self._join((a, name), (b, name), None, 0.0)

    def _join(
        self,
        source: Port,
        target: Port,
        factor: float | None,
        offset: float,
        mapping: dict[int, int] | None = None,
    ) -> None:
        a = self.nodes[source[0]].fmu.variables[source[1]]
        b = self.nodes[target[0]].fmu.variables[target[1]]
        pair = f"{_path(source)} -> {_path(target)}"
        if "String" in (a.kind, b.kind):
            self.problems.append(f"{pair}: strings cannot be connected; use them as parameters")
            return
        if _loses(a, b):
            self.problems.append(
                f"{pair} joins {_kind(a)} to {_kind(b)}, which not all values survive; connect "
                "variables of one type, or whole numbers to Real"
            )
            return
        if b.kind != "Real" and (factor not in (None, 1.0) or offset != 0.0):
            self.problems.append(f"{pair}: only Real inputs take a factor or an offset")
            return
        if mapping and "Real" in (a.kind, b.kind):
            self.problems.append(f"{pair}: a mapping is between whole numbers; use a factor")
            return
        if factor is None and _units_differ(a, b):
            self.problems.append(
                f"{pair} joins {a.unit} to {b.unit}; give the factor (and offset) that converts"
            )
            return
        factor = 1.0 if factor is None else factor
        self.links.append(Link(source, target, factor, offset, mapping))

    def _inputs(self) -> None:
        for path, given in self.scene.inputs.items():
            port = self._port(path, "input or tunable parameter", lambda v: v.is_drivable)
            if port is None or not self._drive(port, "the scene"):
                continue
            node = self.nodes[port[0]]
            variable = node.fmu.variables[port[1]]
            if variable.kind == "String":
                self.problems.append(f"{path}: the scene cannot drive a string")
                continue
            try:
                if isinstance(given, str) and variable.items and given in variable.items:
                    value: float | Signal = float(variable.items[given])
                else:
                    folder = self.scene.folder
                    if isinstance(given, str | Path) and folder is not None:
                        given = folder / given
                    value = signal(given, path, variable.unit)
                if callable(value):
                    self.signals[port] = value
                else:
                    node.start[port[1]] = variable.value(value)
            except (ValueError, CurveboundError) as error:
                self.problems.append(f"{path}: {error}")

    def _recorded(self) -> list[Port]:
        asked = self.scene.recorded or list(self.scene.needs.errors) or ["*.*"]
        ports: dict[Port, None] = {}
        for path in asked:
            if "*" in path:
                found = [
                    (node.name, output)
                    for node in self.nodes.values()
                    for output in node.fmu.outputs
                    if fnmatchcase(f"{node.name}.{output}", path)
                    and node.fmu.variables[output].kind != "String"
                ]
                if not found and self.scene.recorded:
                    self.problems.append(f"record({path!r}) matches no output")
                ports.update(dict.fromkeys(found))
                continue
            port = self._port(path, "output to record", _is_recordable)
            if port is not None:
                ports[port] = None
        for path in self.scene.needs.errors:
            port = self._port(path, "output that the scene could need", _is_recordable)
            if port is not None:
                ports[port] = None
        return list(ports)

    def _controlled(self, recorded: list[Port]) -> dict[Port, float]:
        adaptive = self.scene.adaptive
        if adaptive is None:
            return {}
        controlled: dict[Port, float] = {}
        for path, scale in adaptive.scales.items():
            port = self._port(path, "output with a scale", _is_recordable)
            if port is not None:
                controlled[port] = scale
            if not (scale > 0.0 and math.isfinite(scale)):
                self.problems.append(f"the scale of {path} is {scale}; give a number above zero")
        for port in [*(link.source for link in self.links), *recorded]:
            variable = self.nodes[port[0]].fmu.variables[port[1]]
            if variable.kind == "Real" and variable.variability == "continuous":
                controlled.setdefault(port, variable.nominal or 1.0)
        return controlled

    def _unconnected(self) -> None:
        free = [
            f"{node.name}.{name}"
            for node in self.nodes.values()
            for name in node.fmu.inputs
            if (node.name, name) not in self.driven and name not in node.start
        ]
        if free:
            self.notes.append("Inputs left at their start values: " + ", ".join(free) + ".")


def _units_differ(a: Variable, b: Variable) -> bool:
    if a.unit is None or b.unit is None or a.unit == b.unit:
        return False
    return a.dimension is None or a.dimension != b.dimension


def _kind(variable: Variable) -> str:
    return "Enumeration" if variable.items is not None else variable.kind


def _loses(a: Variable, b: Variable) -> bool:
    """Whether values of `a` may be lost in `b`; enumerations are whole numbers."""
    wide = ("Boolean", "Integer", "Real")
    return wide.index(a.kind) > wide.index(b.kind)


def _is_source(variable: Variable) -> bool:
    return variable.causality in ("output", "calculatedParameter")


def _is_input(variable: Variable) -> bool:
    return variable.causality == "input"


def _is_recordable(variable: Variable) -> bool:
    return variable.causality in ("output", "local", "calculatedParameter") and (
        variable.kind != "String"
    )

"""A scene with every name resolved and everything checked: what the masters work from."""

from __future__ import annotations

import functools
import math
from collections.abc import Callable, Iterable
from dataclasses import dataclass, field
from fnmatch import fnmatchcase
from pathlib import Path

from ..errors import CurveboundError
from .fmu import Fmu, Value, Variable, nearest, read_fmu
from .graph import Loop, components, levels, stepping_order, two_groups
from .scene import ALGORITHMS, Component, Scene
from .signals import Signal, signal

__all__ = ["Link", "Node", "Port", "System", "resolve"]

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
    """target = factor * source + offset; both are variables of one kind."""

    source: Port
    target: Port
    factor: float = 1.0
    offset: float = 0.0


@dataclass
class System:
    """Everything a master needs. `levels` holds every output that is read at all.

    order: in which components step; passing: those whose new outputs gauss_seidel hands to the
    components that step later in the same step.
    recorded: outputs to keep, in the order asked for; controlled: outputs whose error the adaptive
    macro step bounds, with their scales.
    notes: said once to the user, such as inputs that nothing drives.
    """

    scene: Scene
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
    notes: list[str] = field(default_factory=list)

    def variable(self, port: Port) -> Variable:
        """The description of a variable."""
        return self.nodes[port[0]].fmu.variables[port[1]]


def resolve(scene: Scene) -> System:
    """Check the whole scene; CurveboundError lists all that is wrong in it."""
    return _Resolution(scene).run()


class _Resolution:
    """Collects problems instead of stopping at the first."""

    def __init__(self, scene: Scene) -> None:
        self.scene = scene
        self.problems: list[str] = []
        self.notes: list[str] = []
        self.nodes: dict[str, Node] = {}
        self.driven: dict[Port, str] = {}  # input -> what drives it, for messages
        self.links: list[Link] = []
        self.signals: dict[Port, Signal] = {}

    def run(self) -> System:
        self._settings()
        for component in self.scene.components.values():
            self._component(component)
        self._stop()  # names below can only be judged against FMUs that were read
        self._connections()
        self._inputs()
        recorded = self._recorded()
        controlled = self._controlled(recorded)
        self._stop()
        self._unconnected()
        return self._system(recorded, controlled)

    def _stop(self) -> None:
        if self.problems:
            lines = "".join(f"\n- {problem}" for problem in self.problems)
            plural = "s" if len(self.problems) > 1 else ""
            raise CurveboundError(
                f"The scene {self.scene.name} has {len(self.problems)} problem{plural}:{lines}"
            )

    def _settings(self) -> None:
        scene = self.scene
        for name in ("start_time", "stop_time", "step"):
            value = getattr(scene, name)
            if not math.isfinite(value):
                self.problems.append(f"{name} is {value}; give a finite number of seconds")
        if not scene.step > 0.0:
            self.problems.append(f"step is {scene.step} s; give a macro step above zero")
        if not scene.stop_time > scene.start_time:
            self.problems.append(
                f"stop_time is {scene.stop_time} s; give one after start_time, {scene.start_time} s"
            )
        if scene.algorithm not in ALGORITHMS:
            self.problems.append(
                f"algorithm is {scene.algorithm!r}; " + nearest(scene.algorithm, ALGORITHMS)
            )
        if scene.record_every < 1:
            self.problems.append(f"record_every is {scene.record_every}; give 1 or more")
        for name in ("tolerance", "loop_tolerance"):
            value = getattr(scene, name)
            if value is not None and not (value > 0.0 and math.isfinite(value)):
                self.problems.append(f"{name} is {value}; give a number above zero, or None")
        if scene.adaptive is not None and not scene.adaptive.tolerance > 0.0:
            self.problems.append(
                f"adaptive.tolerance is {scene.adaptive.tolerance}; give a number above zero"
            )
        if not scene.components:
            self.problems.append("it has no components; add one with scene.add(name, FMU)")

    def _component(self, component: Component) -> None:
        try:
            fmu = read_fmu(_locate(component.source, self.scene.folder))
        except CurveboundError as error:
            self.problems.append(f"component {component.name}: {error}")
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
        name, _, variable = path.partition(".")
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
            source = self._port(connection.source, "output", _is_output)
            target = self._port(connection.target, "input", _is_input)
            if source is not None and target is not None and self._drive(target, _path(source)):
                self._join(source, target, connection.factor, connection.offset)
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

    def _join(self, source: Port, target: Port, factor: float | None, offset: float) -> None:
        a = self.nodes[source[0]].fmu.variables[source[1]]
        b = self.nodes[target[0]].fmu.variables[target[1]]
        pair = f"{_path(source)} -> {_path(target)}"
        if a.kind != b.kind or (a.items is None) != (b.items is None):
            self.problems.append(
                f"{pair} joins {_kind(a)} to {_kind(b)}; connect variables of one type"
            )
            return
        if a.kind == "String":
            self.problems.append(f"{pair}: strings cannot be connected; use them as parameters")
            return
        if a.kind != "Real" and (factor not in (None, 1.0) or offset != 0.0):
            self.problems.append(f"{pair}: only Real connections take a factor or an offset")
            return
        if factor is None and _units_differ(a, b):
            self.problems.append(
                f"{pair} joins {a.unit} to {b.unit}; give the factor (and offset) that converts"
            )
            return
        self.links.append(Link(source, target, 1.0 if factor is None else factor, offset))

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
                    value = signal(given, path)
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
        for node in self.nodes.values():
            if not node.fmu.can_roll_back:
                self.problems.append(
                    f"component {node.name}: {node.fmu.model_name} cannot be rolled back "
                    "(canGetAndSetFMUstate is false), which adaptive macro steps need; "
                    "run it with a fixed step"
                )
            if not node.fmu.can_vary_step:
                self.problems.append(
                    f"component {node.name}: {node.fmu.model_name} takes one step size only "
                    "(canHandleVariableCommunicationStepSize is false); run it with a fixed step"
                )
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
        once = [n for n in self.nodes.values() if n.fmu.only_once_per_process]
        names = [n.fmu.identifier for n in once]
        for node in once:
            if names.count(node.fmu.identifier) > 1:
                self.problems.append(
                    f"component {node.name}: {node.fmu.model_name} can be instantiated only once "
                    "in a process (canBeInstantiatedOnlyOncePerProcess); use it once"
                )
        scene = self.scene
        count = (scene.stop_time - scene.start_time) / scene.step
        if abs(count - round(count)) > 1e-9 * max(1.0, count):
            for node in self.nodes.values():
                if not node.fmu.can_vary_step:
                    self.problems.append(
                        f"component {node.name}: {node.fmu.model_name} takes one step size only; "
                        f"make stop_time, {scene.stop_time} s, a multiple of step, {scene.step} s"
                    )
        self._stop()

    def _system(self, recorded: list[Port], controlled: dict[Port, float]) -> System:
        read = dict.fromkeys([*(link.source for link in self.links), *recorded, *controlled])
        plain, loops = self._levels(read, initial=False)
        initial, initial_loops = self._levels(read, initial=True)
        names = list(self.nodes)
        edges: dict[str, dict[str, bool]] = {}
        for link in self.links:
            a, b = link.source[0], link.target[0]
            strong = plain[link.source] > 0
            edges.setdefault(a, {})[b] = edges.get(a, {}).get(b, False) or strong
        order = self.scene.order
        if order is None:
            order = stepping_order(names, edges)
        elif sorted(order) != sorted(names):
            self.problems.append(
                f"order must name each component once: {', '.join(names)}; it is {', '.join(order)}"
            )
        groups = self._groups(names, edges) if self.scene.algorithm == "strang" else None
        if self.scene.loop_tolerance is None:
            for loop in loops or initial_loops:
                self.problems.append(self._loop_problem(loop))
        self._stop()
        # a function of the state alone is known without evaluation: it is no error of coupling
        controlled = {port: scale for port, scale in controlled.items() if plain[port] == 0}
        if self.scene.adaptive is not None and not controlled:
            self.problems.append(
                "adaptive macro steps have no output to control: record at least one continuous "
                "Real output that does not depend directly on an input"
            )
            self._stop()
        return System(
            scene=self.scene,
            nodes=self.nodes,
            links=self.links,
            signals=self.signals,
            recorded=recorded,
            controlled=controlled,
            levels=plain,
            loops=loops,
            initial_levels=initial,
            initial_loops=initial_loops,
            order=list(order),
            passing=_passing(order, edges),
            groups=groups,
            notes=self.notes,
        )

    def _levels(
        self, read: Iterable[Port], *, initial: bool
    ) -> tuple[dict[Port, int], list[Loop[Port]]]:
        source_of = {link.target: link.source for link in self.links}
        # what depends on an input at once may depend so on a tunable parameter: FMI does not say
        tuned = {port[0] for port in self.signals if not _is_input(self._variable(port))}
        depends: dict[Port, list[Port]] = {}
        at_least: dict[Port, int] = {}
        for port in read:
            node = self.nodes[port[0]]
            table = node.initial_dependencies if initial else node.dependencies
            targets = [(port[0], name) for name in table.get(port[1], ())]
            depends[port] = [source_of[t] for t in targets if t in source_of]
            driven = any(t in source_of or t in self.signals for t in targets)
            if driven or (targets and node.name in tuned):
                at_least[port] = 1
        return levels(depends, at_least)

    def _variable(self, port: Port) -> Variable:
        return self.nodes[port[0]].fmu.variables[port[1]]

    def _groups(
        self, names: list[str], edges: dict[str, dict[str, bool]]
    ) -> tuple[list[str], list[str]] | None:
        given = self.scene.groups
        if given is None:
            found = two_groups(names, edges)
            if found is None:
                self.problems.append(
                    "strang needs two groups of components with every connection between them, "
                    "and this scene has none; use gauss_seidel"
                )
            return found
        first, second = list(given[0]), list(given[1])
        if sorted([*first, *second]) != sorted(names):
            self.problems.append(
                f"groups must name each component once: {', '.join(names)}; "
                f"they are {', '.join(first)} and {', '.join(second)}"
            )
            return None
        for a, targets in edges.items():
            for b in targets:
                if (a in first) == (b in first):
                    self.problems.append(
                        f"strang is of second order only with every connection between its two "
                        f"groups, and {a} -> {b} stays within one; move {b} to the other group"
                    )
        return first, second

    def _loop_problem(self, loop: Loop[Port]) -> str:
        source_of = {link.target: link.source for link in self.links}
        steps = []
        for here, after in zip(loop.circle, [*loop.circle[1:], loop.circle[0]], strict=True):
            through = next(
                (t for t, s in source_of.items() if s == here and t[0] == after[0]), after
            )
            steps.append(f"{_path(here)} -> {_path(through)}")
        undeclared = sorted(
            {name for name, output in loop.members if output in self.nodes[name].fmu.undeclared}
        )
        message = (
            "there is an algebraic loop: "
            + " => ".join(steps)
            + f" => {_path(loop.circle[0])}; set loop_tolerance to iterate it"
        )
        if undeclared:
            message += (
                f", or, as {', '.join(undeclared)} declares no dependencies of its outputs (each "
                "then counts as depending on all inputs), say what they are with "
                "scene.add(..., feedthrough=...)"
            )
        return message


def _locate(source: str | Path, folder: Path | None) -> Path:
    """The FMU file that a component names; one of ours is built if need be."""
    path = Path(source)
    if isinstance(source, str) and path.suffix.lower() != ".fmu" and path.name == source:
        built = _built(source)
        if not built.is_file():  # the cache was emptied
            _built.cache_clear()
            built = _built(source)
        return built
    if folder is not None and not path.is_absolute():
        path = folder / path
    return path


def _passing(order: list[str], edges: dict[str, dict[str, bool]]) -> set[str]:
    """Components whose outputs go on within the step in gauss_seidel.

    Those that are in a circle with everything they drive later on. What a mere source puts out is
    held from the start of the step, and so is all that a component gives whose outputs follow
    their inputs directly: the values that a component gets from another belong to one time.
    """
    circles = {
        name: i
        for i, group in enumerate(components({name: list(edges.get(name, ())) for name in order}))
        for name in group
    }
    rank = {name: i for i, name in enumerate(order)}
    return {
        name
        for name in order
        if all(
            circles[target] == circles[name] and not strong
            for target, strong in edges.get(name, {}).items()
            if rank[target] > rank[name]
        )
    }


@functools.cache
def _built(name: str) -> Path:
    """One of our FMUs, built; once in a process, as its sources do not change under it."""
    from ..fmi.build import build
    from ..places import cache_directory

    return Path(build(name, cache_directory() / "fmus").path)


def _units_differ(a: Variable, b: Variable) -> bool:
    if a.unit is None or b.unit is None or a.unit == b.unit:
        return False
    return a.dimension is None or b.dimension is None or a.dimension != b.dimension


def _path(port: Port) -> str:
    return f"{port[0]}.{port[1]}"


def _kind(variable: Variable) -> str:
    return "Enumeration" if variable.items is not None else variable.kind


def _is_output(variable: Variable) -> bool:
    return variable.causality == "output"


def _is_input(variable: Variable) -> bool:
    return variable.causality == "input"


def _is_recordable(variable: Variable) -> bool:
    return variable.causality in ("output", "local", "calculatedParameter") and (
        variable.kind != "String"
    )

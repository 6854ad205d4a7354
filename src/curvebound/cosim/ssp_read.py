"""Scenes from SSP 1.0 packages of FMI 2.0 co-simulation FMUs, ours or anybody's.

Read are nested systems (flattened, their names joined by _), connections through the connectors of
systems, transformations and unit conversions, parameter values and mappings, inline and in files,
units, and the default experiment. Values that no variable has the name of are ignored, as the
standard says, with a note. Not read, and refused where they matter: what one component calculates
as a parameter of another, references to other packages, signal dictionaries.

FMUs none of whose outputs declares dependencies count as having no direct feedthrough: taken to
the letter of FMI every coupling of two of them would be an algebraic loop.
"""

from __future__ import annotations

import atexit
import shutil
import tempfile
import zipfile
from dataclasses import replace
from pathlib import Path
from typing import Any, NamedTuple
from urllib.parse import unquote
from xml.etree import ElementTree

from ..errors import CurveboundError, at, reading
from ..units import conversion
from .fmu import Fmu, Value, Variable, extracted, read_fmu
from .scene import Scene
from .ssp import ANNOTATION, NAMESPACES
from .ssp_settings import read_settings
from .ssp_values import Parameter, Transformation, bound_values, number, units_of
from .system import Port
from .tables import read_csv

__all__ = ["read_ssp"]

Element = ElementTree.Element


def read_ssp(path: Path | str) -> Scene:
    """The scene of an SSP package (its SystemStructure.ssd).

    Raises CurveboundError, which names what cannot be read and why.
    """
    path = Path(path)
    if not path.is_file():
        raise CurveboundError(f"There is no SSP package at {path}.")
    with reading(f"{path} cannot be read as an SSP package", "Get it anew, or mend that."):
        folder = _unpack(path)
        ssd = folder / "SystemStructure.ssd"
        if not ssd.is_file():
            raise ValueError("it holds no SystemStructure.ssd")
        with at("SystemStructure.ssd is no XML"):
            root = ElementTree.parse(ssd).getroot()
        system = root.find("ssd:System", NAMESPACES)
        if system is None:
            raise ValueError("SystemStructure.ssd describes no system")
        return _Reader(path, folder, root).scene(system)


_unpacked: dict[tuple[str, int, int], Path] = {}


def _unpack(path: Path) -> Path:
    status = path.stat()
    identity = (str(path.resolve()), status.st_mtime_ns, status.st_size)
    folder = _unpacked.get(identity)
    if folder is None or not folder.is_dir():
        folder = Path(tempfile.mkdtemp(prefix="curvebound_ssp_"))
        atexit.register(shutil.rmtree, folder, ignore_errors=True)
        with zipfile.ZipFile(path) as archive:
            archive.extractall(folder)
        _unpacked[identity] = folder
    return folder


class _Join(NamedTuple):
    """A connection in the direction of its values."""

    source: Port
    target: Port
    change: Transformation
    suppress: bool  # no conversion of units


class _Reader:
    def __init__(self, path: Path, folder: Path, root: Element) -> None:
        self.path = path
        self.folder = folder
        self.root = root
        self.units = units_of(root.find("ssd:Units", NAMESPACES))
        self.fmus: dict[str, Fmu] = {}
        self.start: dict[str, dict[str, Value]] = {}
        # connectors by owner ("" the top system, names joined by _) and name
        self.kinds: dict[tuple[str, str], str] = {}
        self.connector_units: dict[tuple[str, str], str] = {}
        self.links: list[_Join] = []
        self.notes: list[str] = []
        self.bindings: list[tuple[str, Element, bool]] = []
        self.system_inputs: dict[tuple[str, str], list[tuple[str, str]]] = {}

    def scene(self, system: Element) -> Scene:
        self._system(system, "")
        settings = self._settings()
        start, stop = self._times()
        scene = Scene(
            self.root.get("name", self.path.stem),
            self.root.get("description", ""),
            start_time=start,
            stop_time=stop,
            step=float(settings.get("step") or self._step(start, stop)),
            algorithm=settings.get("algorithm", "gauss_seidel"),
            hold=settings.get("hold", "zero"),
            order=settings.get("order"),
            groups=settings.get("groups"),
            loop_tolerance=settings.get("loop_tolerance"),
            tolerance=settings.get("tolerance"),
            record_every=settings.get("record_every", 1),
            adaptive=settings.get("adaptive"),
            needs=settings.get("needs"),
        )
        for name, values in settings.get("variants", {}).items():
            scene.variant(name, values)
        scene.folder = self.folder
        self._parameters()
        feedthrough = settings.get("feedthrough", {})
        for name, fmu in self.fmus.items():
            taken = feedthrough.get(name)
            if taken is None and fmu.outputs and fmu.undeclared.issuperset(fmu.outputs):
                taken = False
            scene.add(name, fmu.path, self.start[name], feedthrough=taken)
        self._connect(scene)
        self._inputs(scene)
        scene.notes = self.notes
        for (owner, name), kind in self.kinds.items():
            if owner in self.fmus and kind == "output":
                scene.record(f"{owner}.{name}")
        return scene

    # structure

    def _system(self, system: Element, owner: str) -> None:
        self._element(system, owner, False)
        for child in system.findall("ssd:Elements/*", NAMESPACES):
            name = child.get("name", "")
            inner = (f"{owner}_{name}" if owner else name).replace(".", "_")
            kind = child.tag.rpartition("}")[2]
            if kind == "System":
                self._system(child, inner)
            elif kind == "Component":
                self._component(child, inner)
            else:
                raise ValueError(
                    f"element {name} is a {kind}, which cannot be read; "
                    "connect the components directly"
                )
        for connection in system.findall("ssd:Connections/ssd:Connection", NAMESPACES):
            self._connection(connection, owner)

    def _element(self, element: Element, owner: str, is_component: bool) -> None:
        for connector in element.findall("ssd:Connectors/ssd:Connector", NAMESPACES):
            port = owner, connector.get("name", "")
            self.kinds[port] = connector.get("kind", "inout")
            real = connector.find("ssc:Real", NAMESPACES)
            if real is not None and real.get("unit"):
                self.connector_units[port] = real.get("unit", "")
        for binding in element.findall("ssd:ParameterBindings/ssd:ParameterBinding", NAMESPACES):
            self.bindings.append((owner, binding, is_component))

    def _component(self, component: Element, name: str) -> None:
        source = unquote(component.get("source", ""))
        kind = component.get("type", "application/x-fmu-sharedlibrary")
        if kind != "application/x-fmu-sharedlibrary":
            raise ValueError(f"component {name} is of type {kind}; only FMUs can be read")
        file = (self.folder / source).resolve()
        if not file.is_relative_to(self.folder.resolve()):
            raise ValueError(f"the source {source} of {name} leaves the package")
        if name in self.fmus:
            raise ValueError(f"two components come to the name {name}")
        if not file.is_file():
            raise ValueError(f"it has no file {source}, the FMU of {name}")
        self.fmus[name] = read_fmu(file)
        self.start[name] = {}
        self._element(component, name, True)

    def _connection(self, connection: Element, owner: str) -> None:
        ends = []
        for end in ("start", "end"):
            element = connection.get(end + "Element")
            inner = owner
            if element is not None:
                inner = (f"{owner}_{element}" if owner else element).replace(".", "_")
            port = (inner, connection.get(end + "Connector", ""))
            if port not in self.kinds:
                raise ValueError(
                    f"a connection names {inner or 'the system'}.{port[1]}, which is no connector"
                )
            # what an inner system or component puts out is a source, what its own system takes in
            gives = self.kinds[port] in ("output", "calculatedParameter")
            ends.append((port, gives if element is not None else not gives))
        (first, first_gives), (second, second_gives) = ends
        if first_gives == second_gives:
            raise ValueError(
                f"the connection of {'.'.join(first)} and {'.'.join(second)} has "
                "no direction: " + ("both give" if first_gives else "both take") + " a value"
            )
        source, target = (first, second) if first_gives else (second, first)
        suppress = connection.get("suppressUnitConversion") in ("true", "1")
        with at(f"the connection from {'.'.join(source)} to {'.'.join(target)}"):
            change = Transformation.of(connection)
        self.links.append(_Join(source, target, change, suppress))

    def _connect(self, scene: Scene) -> None:
        """Follow each component's input through systems to the output that drives it."""
        into = {join.target: join for join in self.links}
        for target in [t for t in into if t[0] in self.fmus]:
            source, factor, offset, suppress = target, 1.0, 0.0, False
            tables: list[Transformation] = []
            seen = {source}
            while source in into:
                join = into[source]
                source, change = join.source, join.change
                _require_new(source, seen)
                factor, offset = change.factor * factor, change.offset * factor + offset
                suppress = suppress or join.suppress
                tables += [change] if change.entries else []
            if source[0] not in self.fmus:
                self.system_inputs.setdefault(source, []).append(target)
                continue
            if self.kinds[target] == "parameter":
                raise ValueError(
                    f"{'.'.join(source)} sets the parameter {'.'.join(target)}; "
                    "what one component calculates cannot be a parameter of another here, "
                    "give the value instead"
                )
            self._join(scene, source, target, factor, offset, suppress, tables)

    def _join(
        self,
        scene: Scene,
        source: Port,
        target: Port,
        factor: float,
        offset: float,
        suppress: bool,
        tables: list[Transformation],
    ) -> None:
        """Connect an output with an input; units are converted before a transformation."""
        a = self.fmus[source[0]].variables.get(source[1])
        b = self.fmus[target[0]].variables.get(target[1])
        given: float | None = factor
        mapping = None
        if a is not None and b is not None:
            if len(tables) > 1:
                raise ValueError(
                    f"the connection from {'.'.join(source)} to {'.'.join(target)} "
                    "is mapped more than once on its way, which cannot be read"
                )
            mapping = tables[0].numbers(a, b) if tables else None
            if a.dimension and b.dimension and not suppress:
                units = conversion(a.dimension, b.dimension)
                if units is not None:
                    factor, offset = factor * units[0], offset + factor * units[1]
                    given = factor
                elif (factor, offset) == (1.0, 0.0):
                    given = None  # let the scene's check complain
        scene.connect(".".join(source), ".".join(target), given, offset, mapping)

    # values

    def _parameters(self) -> None:
        """Apply bindings: inner ones first, so that those of an enclosing system prevail."""
        outward: dict[Port, list[_Join]] = {}
        for join in self.links:
            outward.setdefault(join.source, []).append(join)
        ordered = sorted(self.bindings, key=lambda b: (not b[2], -b[0].count("_") if b[0] else 1))
        for owner, binding, is_component in ordered:
            folder = self.folder
            if binding.get("sourceBase") == "component" and is_component:
                folder = extracted(self.fmus[owner])
            with at(f"parameters of {owner or 'the system'}"):
                for parameter in bound_values(binding, folder):
                    self._apply(owner, parameter, is_component, outward)

    def _apply(
        self, owner: str, parameter: Parameter, is_component: bool, outward: dict[Port, list[_Join]]
    ) -> None:
        """Give a value to all that its name stands for (SSP 1.0, section 5.1.4); or note it."""
        if is_component:
            self._give((owner, parameter.name), parameter)
            return
        port = (owner, parameter.name)
        if port in self.kinds:  # a connector of the system: down to what it is joined to
            unit = parameter.unit or self.connector_units.get(port)
            following = [(port, replace(parameter, unit=unit))]
            seen: set[Port] = set()
            while following:
                port, value = following.pop()
                _require_new(port, seen)
                if port[0] in self.fmus:
                    self._give(port, value)
                for join in outward.get(port, ()):
                    following.append((join.target, self._behind(join, value)))
            return
        prefix = f"{owner}_" if owner else ""
        words = parameter.name.split(".")
        for n in range(1, len(words)):
            name = prefix + "_".join(words[:n])
            if name in self.fmus:
                self._give((name, ".".join(words[n:])), parameter)
                return
            inner = (name, ".".join(words[n:]))
            if inner in self.kinds:
                self._apply(name, replace(parameter, name=inner[1]), False, outward)
                return
        self._ignored(parameter, owner or "the system")

    def _ignored(self, parameter: Parameter, owner: str) -> None:
        self.notes.append(
            f"The parameter {parameter.name} = {parameter.value} of {owner} is ignored: there is "
            "no variable of that name."
        )

    def _behind(self, join: _Join, parameter: Parameter) -> Parameter:
        """A parameter behind a connection: in the unit of its end, then transformed."""
        variable = self._variable(join.target)
        of = None if parameter.unit is None else self._unit(parameter, parameter.unit)
        name = self.connector_units.get(join.target)
        to = self.units.get(name or "")
        if variable is not None and variable.dimension:
            name, to = variable.unit, variable.dimension
        value, unit = parameter.value, parameter.unit
        if of is not None and to is not None and not join.suppress:
            value, unit = self._converted(value, of, to, join.target, parameter.unit, name), name
        elif join.suppress:
            unit = None
        return replace(parameter, value=join.change.applied(value), unit=unit)

    def _variable(self, port: Port) -> Variable | None:
        fmu = self.fmus.get(port[0])
        return None if fmu is None else fmu.variables.get(port[1])

    def _unit(self, parameter: Parameter, name: str) -> tuple[float, ...] | None:
        return parameter.units.get(name) or self.units.get(name)

    def _converted(
        self,
        value: Value,
        of: tuple[float, ...],
        to: tuple[float, ...],
        port: Port,
        unit: str | None,
        own: str | None,
    ) -> Value:
        units = conversion(of, to)
        if units is None:
            raise ValueError(f"{'.'.join(port)} is given in {unit} and has the unit {own}")
        return value if units == (1.0, 0.0) else number(value, ".".join(port)) * units[0] + units[1]

    def _give(self, port: Port, parameter: Parameter) -> None:
        variable = self._variable(port)
        if variable is None:
            self._ignored(parameter, port[0])
            return
        value: Value = parameter.value
        if parameter.unit and variable.dimension and parameter.unit != variable.unit:
            of = self._unit(parameter, parameter.unit)
            if of is not None:
                value = self._converted(
                    value, of, variable.dimension, port, parameter.unit, variable.unit
                )
        self.start[port[0]][port[1]] = value

    def _inputs(self, scene: Scene) -> None:
        table = self.folder / "resources" / "inputs.csv"
        if not table.is_file():
            return
        data = read_csv(table)
        for (_, name), targets in self.system_inputs.items():
            if name in (data.dtype.names or ()):
                for target in targets:
                    scene.input(".".join(target), (data["time"], data[name]))

    # experiment

    def _settings(self) -> dict[str, Any]:
        for annotation in self.root.iter(f"{{{NAMESPACES['ssc']}}}Annotation"):
            if annotation.get("type") == ANNOTATION:
                with at("the annotation Scene"):
                    return read_settings(annotation.findtext("cvb:Scene", "{}", NAMESPACES))
        return {}

    def _times(self) -> tuple[float, float]:
        experiment = self.root.find("ssd:DefaultExperiment", NAMESPACES)
        start = stop = None
        if experiment is not None:
            start, stop = experiment.get("startTime"), experiment.get("stopTime")
        begin = number(start, "startTime of the DefaultExperiment") if start is not None else 0.0
        if stop is not None:
            return begin, number(stop, "stopTime of the DefaultExperiment")
        ends = [fmu.stop_time for fmu in self.fmus.values() if fmu.stop_time is not None]
        return begin, max(ends, default=begin + 1.0)

    def _step(self, start: float, stop: float) -> float:
        fixed = self.root.find(".//osp:FixedStepAlgorithm", NAMESPACES)
        if fixed is not None and fixed.get("baseStepSize"):
            return number(fixed.get("baseStepSize"), "baseStepSize of the FixedStepAlgorithm")
        steps = [fmu.step for fmu in self.fmus.values() if fmu.step]
        return min(steps, default=(stop - start) / 1000.0)


def _require_new(port: Port, seen: set[Port]) -> None:
    if port in seen:
        raise ValueError(f"its connections lead from {'.'.join(port).lstrip('.')} back to it")
    seen.add(port)

"""Scenes written as SSP 1.0 packages: FMUs, structure, parameter values, units, experiment.

Besides what the standard names, the package carries, in annotations, the step and the algorithm:
once as the Open Simulation Platform writes it (libcosim reads that), once with all settings of a
scene of ours. Tools that know neither lose only the defaults of a run.

Enumeration values are written as integers, as several tools take no item names. Each component
has its own parameter file, which the structure binds to it; resources/parameters.ssv holds them
all by path, for fmpy, whose simulate_ssp takes one set for the whole system. Functions and tables
that drive inputs become inputs of the system; resources/inputs.csv holds their values.
"""

from __future__ import annotations

import io
import zipfile
from collections.abc import Iterable
from pathlib import Path
from urllib.parse import quote
from xml.etree import ElementTree

from ..files import inside, write_whole
from ..units import BASE_UNITS
from .fmu import Value, Variable
from .points import communication_times
from .resolution import resolve
from .scene_data import SceneData
from .signals import value_of
from .ssp_settings import write_settings
from .system import Port, System
from .tables import as_csv

__all__ = ["ANNOTATION", "NAMESPACES", "PARAMETERS", "PARAMETER_SET", "in_fmpy", "write_ssp"]

_ROOT = "http://ssp-standard.org/SSP1/SystemStructure"
NAMESPACES = {
    "ssd": _ROOT + "Description",
    "ssc": _ROOT + "Common",
    "ssv": _ROOT + "ParameterValues",
    "ssm": _ROOT + "ParameterMapping",
    "osp": "http://opensimulationplatform.com/SSP/OSPAnnotations",
    "cvb": "urn:curvebound:scene",
}
ANNOTATION = "curvebound.scene"
PARAMETER_SET = "initialValues"  # one name for all: ecos is told the name of the set to apply
PARAMETERS = "resources/parameters.ssv"  # of all components, by path
_EPOCH = (1980, 1, 1, 0, 0, 0)  # no time in the archive: the same scene gives the same bytes

for _prefix, _uri in NAMESPACES.items():
    ElementTree.register_namespace(_prefix, _uri)


def write_ssp(scene: SceneData, path: Path | str) -> Path:
    """Write `scene` as an SSP package; the file appears whole or not at all.

    Raises CurveboundError with all that is wrong in the scene, or where the file cannot be written.
    """
    system = resolve(scene)
    files: dict[str, bytes] = {}
    sources = _pack_fmus(system, files)
    structure = _Structure(system, sources)
    files["SystemStructure.ssd"] = structure.ssd()
    for name, node in system.nodes.items():
        if node.start:
            values = [(key, node.fmu.variables[key], v) for key, v in node.start.items()]
            files[_resource(name, ".ssv")] = _parameter_set(PARAMETER_SET, values)
    every = [
        (f"{name}.{key}", node.fmu.variables[key], value)
        for name, node in system.nodes.items()
        for key, value in node.start.items()
    ]
    files[PARAMETERS] = _parameter_set(PARAMETER_SET, every)
    if system.signals:
        files["resources/inputs.csv"] = _inputs(system)

    def write(to: Path) -> None:
        with zipfile.ZipFile(to, "w") as archive:
            for name in sorted(files, key=lambda n: (n != "SystemStructure.ssd", n)):
                info = zipfile.ZipInfo(name, _EPOCH)
                info.compress_type = zipfile.ZIP_DEFLATED
                info.external_attr = 0o644 << 16
                archive.writestr(info, files[name])

    return write_whole(Path(path), write)


def in_fmpy(scene: SceneData, path: Path) -> str:
    """Python that runs the package in fmpy, whose simulate_ssp applies no parameters by itself."""
    inputs = [".".join(port) for port in resolve(scene).signals]
    lines = [
        "from fmpy.ssp.simulation import simulate_ssp",
        "from fmpy.ssp.ssd import read_ssv",
        f'parameters = read_ssv("{path}", "{PARAMETERS}")',
        f'result = simulate_ssp("{path}", start_time={scene.start_time!r}, '
        f"stop_time={scene.stop_time!r}, step_size={scene.step!r}, "
        f"parameter_set=parameters{', input=inputs' if inputs else ''})",
    ]
    if inputs:
        lines.insert(2, f"inputs = {{...}}  # a function of time for each of {', '.join(inputs)}")
    return "\n".join(lines)


def _pack_fmus(system: System, files: dict[str, bytes]) -> dict[str, str]:
    """Put each FMU in once; returns the source of each component."""
    of_path: dict[Path, str] = {}
    sources = {}
    for name, node in system.nodes.items():
        source = of_path.get(node.fmu.path)
        if source is None:
            source = _resource(node.fmu.model_name, ".fmu")
            number = 1
            while source in files:
                number += 1
                source = _resource(node.fmu.model_name, f"_{number}.fmu")
            of_path[node.fmu.path] = source
            files[source] = node.fmu.path.read_bytes()
        sources[name] = quote(source)
    return sources


def _resource(name: str, ending: str) -> str:
    return inside(Path("resources"), name, ending).as_posix()


def _tag(prefixed: str) -> str:
    prefix, _, name = prefixed.partition(":")
    return f"{{{NAMESPACES[prefix]}}}{name}"


def _add(parent: ElementTree.Element, prefixed: str, **attributes: str) -> ElementTree.Element:
    return ElementTree.SubElement(parent, _tag(prefixed), attributes)


def _document(root: ElementTree.Element) -> bytes:
    ElementTree.indent(root)
    buffer = io.BytesIO()
    ElementTree.ElementTree(root).write(buffer, encoding="UTF-8", xml_declaration=True)
    return buffer.getvalue()


def _parameter_set(name: str, values: Iterable[tuple[str, Variable, Value]]) -> bytes:
    root = ElementTree.Element(_tag("ssv:ParameterSet"), {"version": "1.0", "name": name})
    parameters = _add(root, "ssv:Parameters")
    for path, variable, value in values:
        entry = _add(parameters, "ssv:Parameter", name=path)
        if variable.kind == "Boolean":
            _add(entry, "ssv:Boolean", value="true" if value else "false")
        elif variable.kind == "String":
            _add(entry, "ssv:String", value=str(value))
        else:
            _add(entry, "ssv:" + variable.kind, value=repr(value))
    return _document(root)


def _inputs(system: System) -> bytes:
    """Every scene input at every communication point; before and after where one jumps."""
    scene = system.scene
    just = 1e-9 * scene.step
    times = communication_times(scene.start_time, scene.stop_time, scene.step, system.stops)
    # a time that is written twice is a jump
    rows = [(t, t) for t in times] + [(t, t - just) for t in system.stops]
    rows.sort()
    columns = {"time": [t for t, _ in rows]}
    for port, function in system.signals.items():
        path = ".".join(port)
        columns[path] = [value_of(function, path, at) for _, at in rows]
    return as_csv(columns).encode()


class _Structure:
    """The structure description of a system."""

    def __init__(self, system: System, sources: dict[str, str]) -> None:
        self.system = system
        self.sources = sources
        shown: dict[str, dict[str, str]] = {name: {} for name in system.nodes}
        for link in system.links:
            shown[link.source[0]][link.source[1]] = "output"
            shown[link.target[0]][link.target[1]] = "input"
        for name, variable in system.recorded:
            if system.variable((name, variable)).causality == "output":
                shown[name][variable] = "output"
        for name, variable in system.signals:
            shown[name][variable] = "input"
        self.connectors = shown
        self.enumerations: dict[tuple[tuple[str, int], ...], str] = {}

    def ssd(self) -> bytes:
        """The document."""
        scene = self.system.scene
        root = ElementTree.Element(
            _tag("ssd:SystemStructureDescription"),
            {"version": "1.0", "name": scene.name, "generationTool": "curvebound"},
        )
        if scene.description:
            root.set("description", scene.description)
        top = _add(root, "ssd:System", name=scene.name)
        if self.system.signals:
            connectors = _add(top, "ssd:Connectors")
            for port in self.system.signals:
                self._connector(connectors, ".".join(port), "input", port)
        elements = _add(top, "ssd:Elements")
        for name in self.system.nodes:
            self._component(elements, name)
        self._connections(top)
        if self.enumerations:
            enumerations = _add(root, "ssd:Enumerations")
            for items, name in self.enumerations.items():
                one = _add(enumerations, "ssc:Enumeration", name=name)
                for item, value in items:
                    _add(one, "ssc:Item", name=item, value=str(value))
        self._units(root)
        self._experiment(root)
        return _document(root)

    def _connector(self, parent: ElementTree.Element, name: str, kind: str, port: Port) -> None:
        variable = self.system.variable(port)
        connector = _add(parent, "ssd:Connector", name=name, kind=kind)
        if variable.items is not None:
            _add(connector, "ssc:Enumeration", name=self._enumeration(port, variable.items))
            return
        typed = _add(connector, "ssc:" + variable.kind)
        if variable.kind == "Real" and variable.unit and variable.dimension is not None:
            typed.set("unit", variable.unit)

    def _enumeration(self, port: Port, items: dict[str, int]) -> str:
        """Name of the enumeration with these items: that of the first variable that has it."""
        return self.enumerations.setdefault(tuple(items.items()), ".".join(port))

    def _component(self, elements: ElementTree.Element, name: str) -> None:
        component = _add(
            elements,
            "ssd:Component",
            name=name,
            type="application/x-fmu-sharedlibrary",
            source=self.sources[name],
            implementation="CoSimulation",
        )
        if self.connectors[name]:
            connectors = _add(component, "ssd:Connectors")
            for variable, kind in self.connectors[name].items():
                self._connector(connectors, variable, kind, (name, variable))
        if self.system.nodes[name].start:
            bindings = _add(component, "ssd:ParameterBindings")
            _add(bindings, "ssd:ParameterBinding", source=quote(_resource(name, ".ssv")))

    def _connections(self, top: ElementTree.Element) -> None:
        if not (self.system.links or self.system.signals):
            return
        connections = _add(top, "ssd:Connections")
        for link in self.system.links:
            connection = _add(
                connections,
                "ssd:Connection",
                startElement=link.source[0],
                startConnector=link.source[1],
                endElement=link.target[0],
                endConnector=link.target[1],
            )
            if link.mapping:
                self._table(connection, link.mapping)
            elif (link.factor, link.offset) != (1.0, 0.0):
                connection.set("suppressUnitConversion", "true")
                _add(
                    connection,
                    "ssc:LinearTransformation",
                    factor=repr(link.factor),
                    offset=repr(link.offset),
                )
        for port in self.system.signals:
            _add(
                connections,
                "ssd:Connection",
                startConnector=".".join(port),
                endElement=port[0],
                endConnector=port[1],
            )

    def _table(self, connection: ElementTree.Element, mapping: dict[int, int]) -> None:
        table = _add(connection, "ssc:IntegerMappingTransformation")
        for source, target in mapping.items():
            _add(table, "ssc:MapEntry", source=str(source), target=str(target))

    def _units(self, root: ElementTree.Element) -> None:
        used: dict[str, tuple[float, ...]] = {}
        for name, variables in self.connectors.items():
            for variable in variables:
                known = self.system.variable((name, variable))
                if known.unit and known.dimension is not None:
                    used.setdefault(known.unit, known.dimension)
        if not used:
            return
        units = _add(root, "ssd:Units")
        for unit, dimension in sorted(used.items()):
            base = _add(_add(units, "ssc:Unit", name=unit), "ssc:BaseUnit")
            for name, exponent in zip(BASE_UNITS, dimension, strict=False):
                if exponent:
                    base.set(name, str(int(exponent)))
            for name, value, default in (
                ("factor", dimension[8], 1.0),
                ("offset", dimension[9], 0.0),
            ):
                if value != default:
                    base.set(name, repr(value))

    def _experiment(self, root: ElementTree.Element) -> None:
        scene = self.system.scene
        experiment = _add(
            root,
            "ssd:DefaultExperiment",
            startTime=repr(float(scene.start_time)),
            stopTime=repr(float(scene.stop_time)),
        )
        annotations = _add(experiment, "ssd:Annotations")
        platform = _add(annotations, "ssc:Annotation", type="com.opensimulationplatform")
        algorithm = _add(platform, "osp:Algorithm")
        _add(algorithm, "osp:FixedStepAlgorithm", baseStepSize=repr(float(scene.step)))
        ours = _add(annotations, "ssc:Annotation", type=ANNOTATION)
        _add(ours, "cvb:Scene").text = write_settings(scene)

"""What an SSP package's SystemStructure.ssd describes: components, connectors, connections.

Nested systems are flattened: a component is named after the systems it lies in, joined by _.
"""

from __future__ import annotations

from pathlib import Path
from typing import NamedTuple
from urllib.parse import unquote
from xml.etree import ElementTree

from ..errors import at
from .fmu import Fmu, Variable, read_fmu
from .ssp import NAMESPACES
from .ssp_values import Transformation, units_of
from .system import Port

__all__ = ["Join", "Structure", "require_new"]

Element = ElementTree.Element


class Join(NamedTuple):
    """A connection in the direction of its values."""

    source: Port
    target: Port
    change: Transformation
    suppress: bool  # no conversion of units


class Structure:
    """A package's systems as one.

    Attributes
    ----------
    fmus : dict of str to Fmu
        By component.
    kinds, connector_units : dict of port to str
        Connectors by owner ("" the top system) and name.
    links : list of Join
    bindings : list of (str, Element, bool)
        Parameter bindings: whose, the element, and whether that is a component.
    units : dict of str to tuple of float
        Dimensions of the units that the package defines.
    """

    def __init__(self, folder: Path, root: Element, system: Element) -> None:
        """Read what `root` says of `system`; folder: where the package is unpacked.

        Raises ValueError for what cannot be read.
        """
        self.folder = folder
        self.units = units_of(root.find("ssd:Units", NAMESPACES))
        self.fmus: dict[str, Fmu] = {}
        self.kinds: dict[Port, str] = {}
        self.connector_units: dict[Port, str] = {}
        self.links: list[Join] = []
        self.bindings: list[tuple[str, Element, bool]] = []
        self._system(system, "")

    def variable(self, port: Port) -> Variable | None:
        """The variable of a component at a port, if there is one."""
        fmu = self.fmus.get(port[0])
        return None if fmu is None else fmu.variables.get(port[1])

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
        self.links.append(Join(source, target, change, suppress))


def require_new(port: Port, seen: set[Port]) -> None:
    """Raise ValueError where connections lead back to a port that was passed; it is passed now."""
    if port in seen:
        raise ValueError(f"its connections lead from {'.'.join(port).lstrip('.')} back to it")
    seen.add(port)

"""The start values that the parameters of an SSP package give (SSP 1.0, section 5.1)."""

from __future__ import annotations

from dataclasses import replace

from ..errors import at
from ..units import conversion
from .fmu import Value, extracted
from .ssp_structure import Join, Structure, require_new
from .ssp_values import Parameter, bound_values, number
from .system import Port

__all__ = ["Parameters"]


class Parameters:
    """Start values by component and variable, and what there is to say of those ignored."""

    def __init__(self, structure: Structure) -> None:
        """Apply all bindings. Raises ValueError for what cannot be read."""
        self.structure = structure
        self.start: dict[str, dict[str, Value]] = {name: {} for name in structure.fmus}
        self.notes: list[str] = []
        self._bound()

    def _bound(self) -> None:
        """Apply bindings: inner ones first, so that those of an enclosing system prevail."""
        structure = self.structure
        outward: dict[Port, list[Join]] = {}
        for join in structure.links:
            outward.setdefault(join.source, []).append(join)
        ordered = sorted(
            structure.bindings, key=lambda b: (not b[2], -b[0].count("_") if b[0] else 1)
        )
        for owner, binding, is_component in ordered:
            folder = structure.folder
            if binding.get("sourceBase") == "component" and is_component:
                folder = extracted(structure.fmus[owner])
            with at(f"parameters of {owner or 'the system'}"):
                for parameter in bound_values(binding, folder):
                    self._apply(owner, parameter, is_component, outward)

    def _apply(
        self, owner: str, parameter: Parameter, is_component: bool, outward: dict[Port, list[Join]]
    ) -> None:
        """Give a value to all that its name stands for (SSP 1.0, section 5.1.4); or note it."""
        structure = self.structure
        if is_component:
            self._give((owner, parameter.name), parameter)
            return
        port = (owner, parameter.name)
        if port in structure.kinds:  # a connector of the system: down to what it is joined to
            unit = parameter.unit or structure.connector_units.get(port)
            following = [(port, replace(parameter, unit=unit))]
            seen: set[Port] = set()
            while following:
                port, value = following.pop()
                require_new(port, seen)
                if port[0] in structure.fmus:
                    self._give(port, value)
                for join in outward.get(port, ()):
                    following.append((join.target, self._behind(join, value)))
            return
        prefix = f"{owner}_" if owner else ""
        words = parameter.name.split(".")
        for n in range(1, len(words)):
            name = prefix + "_".join(words[:n])
            if name in structure.fmus:
                self._give((name, ".".join(words[n:])), parameter)
                return
            inner = (name, ".".join(words[n:]))
            if inner in structure.kinds:
                self._apply(name, replace(parameter, name=inner[1]), False, outward)
                return
        self._ignored(parameter, owner or "the system")

    def _ignored(self, parameter: Parameter, owner: str) -> None:
        self.notes.append(
            f"The parameter {parameter.name} = {parameter.value} of {owner} is ignored: there is "
            "no variable of that name."
        )

    def _behind(self, join: Join, parameter: Parameter) -> Parameter:
        """A parameter behind a connection: in the unit of its end, then transformed."""
        structure = self.structure
        variable = structure.variable(join.target)
        of = None if parameter.unit is None else self._unit(parameter, parameter.unit)
        name = structure.connector_units.get(join.target)
        to = structure.units.get(name or "")
        if variable is not None and variable.dimension:
            name, to = variable.unit, variable.dimension
        value, unit = parameter.value, parameter.unit
        if of is not None and to is not None and not join.suppress:
            value, unit = self._converted(value, of, to, join.target, parameter.unit, name), name
        elif join.suppress:
            unit = None
        return replace(parameter, value=join.change.applied(value), unit=unit)

    def _unit(self, parameter: Parameter, name: str) -> tuple[float, ...] | None:
        return parameter.units.get(name) or self.structure.units.get(name)

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
        variable = self.structure.variable(port)
        if variable is None:
            self._ignored(parameter, port[0])
            return
        value: Value = parameter.value
        if parameter.unit and variable.dimension and parameter.unit != variable.unit:
            of = self._unit(parameter, parameter.unit)
            if of is None:
                self.notes.append(
                    f"{'.'.join(port)} = {value} is given in {parameter.unit}, a unit that the "
                    f"package describes nowhere: taken as {variable.unit}."
                )
            else:
                value = self._converted(
                    value, of, variable.dimension, port, parameter.unit, variable.unit
                )
        self.start[port[0]][port[1]] = value

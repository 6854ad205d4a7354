"""Parameter values of SSP packages: .ssv and .ssm content, inline or in files."""

from __future__ import annotations

from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import NamedTuple
from urllib.parse import unquote
from xml.etree import ElementTree

from ..errors import at
from ..units import BASE_UNITS
from .fmu import Value, Variable
from .ssp import NAMESPACES

__all__ = ["Parameter", "Transformation", "bound_values", "number", "units_of"]

Element = ElementTree.Element


@dataclass(frozen=True)
class Parameter:
    """A value with its name, its unit (None: that of the variable) and the units of its file."""

    name: str
    value: Value
    unit: str | None = None
    units: dict[str, tuple[float, ...]] = field(default_factory=dict)


class Transformation(NamedTuple):
    """What a connection or a mapping of parameters makes of a value (SSP 1.0, section 4.5.1).

    entries: source and target of each entry of a table, as written; what is in none stays.
    """

    factor: float = 1.0
    offset: float = 0.0
    entries: tuple[tuple[str, str], ...] = ()

    @classmethod
    def of(cls, element: Element) -> Transformation:
        """That of a Connection or MappingEntry."""
        linear = element.find("ssc:LinearTransformation", NAMESPACES)
        if linear is not None:
            return cls(*_linear(linear, "a LinearTransformation"))
        for kind in ("Boolean", "Integer", "Enumeration"):
            table = element.find(f"ssc:{kind}MappingTransformation", NAMESPACES)
            if table is not None:
                entries = table.findall("ssc:MapEntry", NAMESPACES)
                return cls(
                    entries=tuple((e.get("source", ""), e.get("target", "")) for e in entries)
                )
        return cls()

    def applied(self, value: Value) -> Value:
        """The value of a parameter behind it."""
        if self.entries:
            word = str(value).lower() if isinstance(value, bool) else str(value)
            return dict(self.entries).get(word, value)
        if (self.factor, self.offset) == (1.0, 0.0):
            return value
        return self.factor * number(value, "a value") + self.offset

    def numbers(self, of: Variable, to: Variable) -> dict[int, int] | None:
        """Its table as whole numbers, between variables of these types."""
        pairs = {_number(source, of): _number(target, to) for source, target in self.entries}
        return pairs or None


def _number(text: str, variable: Variable) -> int:
    if variable.items is not None and text in variable.items:
        return variable.items[text]
    with at(f"an entry of a mapping for {variable.name}"):
        return int({"true": "1", "false": "0"}.get(text, text))


def number(text: object, what: str) -> float:
    """The number in a text; ValueError, which names `what` it is, where it is none."""
    try:
        return float(text)  # type: ignore[arg-type]
    except (TypeError, ValueError):
        raise ValueError(f"{what} is {text!r}, which is no number") from None


def _linear(element: Element, of: str) -> tuple[float, float]:
    factor = number(element.get("factor", "1"), f"the factor of {of}")
    return factor, number(element.get("offset", "0"), f"the offset of {of}")


def units_of(element: Element | None) -> dict[str, tuple[float, ...]]:
    """Units by name, as exponents of BASE_UNITS, then factor and offset."""
    found: dict[str, tuple[float, ...]] = {}
    for unit in () if element is None else element.findall("ssc:Unit", NAMESPACES):
        base = unit.find("ssc:BaseUnit", NAMESPACES)
        if base is not None:
            what = f"the unit {unit.get('name', '')}"
            exponents = [
                number(base.get(name, "0"), f"the exponent {name} of {what}") for name in BASE_UNITS
            ]
            found[unit.get("name", "")] = (*exponents, *_linear(base, what))
    return found


def bound_values(binding: Element, folder: Path) -> list[Parameter]:
    """The parameters that one ParameterBinding gives, mapped, with its prefix before the names."""
    source = binding.get("source")
    sets: list[Element]
    if source is not None:
        sets = [_parse(folder, source)]
    else:
        sets = binding.findall("ssd:ParameterValues/ssv:ParameterSet", NAMESPACES)
    prefix = binding.get("prefix", "")  # before the names of the source, mapped or not
    values = [
        replace(parameter, name=prefix + parameter.name)
        for one in sets
        for parameter in _values(one)
    ]
    for mapping in binding.findall("ssd:ParameterMapping", NAMESPACES):
        file = mapping.get("source")
        entries = (
            _parse(folder, file)
            if file is not None
            else mapping.find("ssm:ParameterMapping", NAMESPACES)
        )
        if entries is not None:
            values = _mapped(values, entries)
    return values


def _parse(folder: Path, source: str) -> Element:
    file = (folder / unquote(source)).resolve()
    if not file.is_relative_to(folder.resolve()) or not file.is_file():
        raise ValueError(f"it has no file {source}, which it binds as parameters")
    try:
        return ElementTree.parse(file).getroot()
    except ElementTree.ParseError as error:
        raise ValueError(f"{source} is no XML: {error}") from error


def _values(parameter_set: Element) -> list[Parameter]:
    units = units_of(parameter_set.find("ssv:Units", NAMESPACES))
    found = []
    given: dict[str, Value] = {}
    for parameter in parameter_set.findall("ssv:Parameters/ssv:Parameter", NAMESPACES):
        for typed in parameter:
            kind = typed.tag.rpartition("}")[2]
            if kind not in ("Real", "Integer", "Boolean", "String", "Enumeration"):
                continue
            text = typed.get("value", "")
            name = parameter.get("name", "")
            value: Value = number(text, name) if kind == "Real" else text
            if given.setdefault(name, value) != value:
                raise ValueError(f"{name} is {given[name]} and {value} in one set")
            found.append(Parameter(name, value, typed.get("unit"), units))
    return found


def _mapped(values: list[Parameter], mapping: Element) -> list[Parameter]:
    """Only what is mapped is applied (SSP 1.0, section 4.5.2.2)."""
    by_name = {parameter.name: parameter for parameter in values}
    mapped = []
    for entry in mapping.findall("ssm:MappingEntry", NAMESPACES):
        parameter = by_name.get(entry.get("source", ""))
        if parameter is None:
            continue
        change = Transformation.of(entry)
        value = change.applied(parameter.value)
        unit = parameter.unit
        if entry.get("suppressUnitConversion") in ("true", "1"):
            unit = None
        mapped.append(replace(parameter, name=entry.get("target", ""), value=value, unit=unit))
    return mapped

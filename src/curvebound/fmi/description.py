"""modelDescription.xml of an FMU (FMI 2.0.4, chapters 2.2 and 4.3)."""

from __future__ import annotations

import datetime
import os
from importlib.metadata import version
from xml.etree.ElementTree import Element, SubElement

from .. import __date__, __version__
from ..units import exponents
from .declaration import CHOICE, COUNT, COUNT_PARAMETER, INPUT, OUTPUT, PARAMETER, Fmu, Variable
from .engine import Engine

__all__ = ["describe", "timestamp"]

_CAUSALITY = {
    PARAMETER: "parameter",
    CHOICE: "parameter",
    COUNT_PARAMETER: "parameter",
    INPUT: "input",
    OUTPUT: "output",
    COUNT: "output",
}

_CAPABILITIES = {
    "needsExecutionTool": "false",
    "canHandleVariableCommunicationStepSize": "true",
    "canInterpolateInputs": "false",
    "maxOutputDerivativeOrder": "0",
    "canRunAsynchronuously": "false",
    "canBeInstantiatedOnlyOncePerProcess": "false",
    "canNotUseMemoryManagementFunctions": "true",
    "canGetAndSetFMUstate": "true",
    "canSerializeFMUstate": "true",
    "providesDirectionalDerivative": "false",
}

_LOG_CATEGORIES = {
    "logStatusWarning": "Warnings: results may be inaccurate",
    "logStatusError": "Errors: what failed, why and what to do",
    "logAll": "All messages",
}


def timestamp() -> datetime.datetime:
    """The date of a build: SOURCE_DATE_EPOCH where it is set, else that of the sources."""
    epoch = os.environ.get("SOURCE_DATE_EPOCH")
    if epoch:
        return datetime.datetime.fromtimestamp(int(epoch), datetime.timezone.utc)
    return datetime.datetime.fromisoformat(__date__).replace(tzinfo=datetime.timezone.utc)


def describe(fmu: Fmu, guid: str, engine: Engine, *, derivatives: bool) -> Element:
    """The root element for `fmu`.

    engine: tells which outputs depend on the inputs directly. derivatives: whether the binaries
    pass the functions about derivatives on.
    """
    root = Element(
        "fmiModelDescription",
        {
            "fmiVersion": "2.0",
            "modelName": fmu.name,
            "guid": guid,
            "description": fmu.description,
            "author": "the curvebound developers",
            "version": __version__,
            "copyright": "Copyright (c) 2026 the curvebound developers",
            "license": "MIT",
            "generationTool": f"curvebound {__version__} with PythonFMU {version('pythonfmu')}",
            "generationDateAndTime": timestamp().strftime("%Y-%m-%dT%H:%M:%SZ"),
            "variableNamingConvention": "structured",
        },
    )
    capabilities = dict(_CAPABILITIES)
    dependencies = engine.dependencies()
    if derivatives:
        capabilities |= {"canInterpolateInputs": "true", "maxOutputDerivativeOrder": "1"}
    if derivatives and engine.has_changes():
        capabilities["providesDirectionalDerivative"] = "true"
    SubElement(root, "CoSimulation", {"modelIdentifier": fmu.name, **capabilities})
    described = fmu.described()
    variables = [variable for _, variable in described]
    _unit_definitions(root, variables)
    _type_definitions(root, variables)
    categories = SubElement(root, "LogCategories")
    for name, text in _LOG_CATEGORIES.items():
        SubElement(categories, "Category", {"name": name, "description": text})
    SubElement(
        root,
        "DefaultExperiment",
        {
            "startTime": "0",
            "stopTime": repr(fmu.stop_time),
            "stepSize": repr(fmu.step_size),
        },
    )
    element = SubElement(root, "ModelVariables")
    for vr, variable in described:
        element.append(_scalar_variable(vr, variable))
    _structure(root, described, dependencies)
    return root


def _unit_definitions(root: Element, variables: list[Variable]) -> None:
    element = SubElement(root, "UnitDefinitions")
    for unit in sorted({v.unit for v in variables if v.unit}):
        base = {name: str(power) for name, power in exponents(unit).items()}
        SubElement(SubElement(element, "Unit", {"name": unit}), "BaseUnit", base)


def _type_definitions(root: Element, variables: list[Variable]) -> None:
    types = {v.type.name: v.type for v in variables if v.type}
    if not types:
        return
    element = SubElement(root, "TypeDefinitions")
    for name, type_ in types.items():
        simple = SubElement(element, "SimpleType", {"name": name, "description": type_.description})
        enumeration = SubElement(simple, "Enumeration")
        for number, (item, text) in enumerate(type_.items, start=1):
            SubElement(
                enumeration, "Item", {"name": item, "value": str(number), "description": text}
            )


def _scalar_variable(vr: int, variable: Variable) -> Element:
    causality = _CAUSALITY[variable.kind]
    attributes = {
        "name": variable.name,
        "valueReference": str(vr),
        "description": variable.description,
        "causality": causality,
    }
    if causality == "parameter":
        attributes["variability"] = "tunable" if variable.tunable else "fixed"
        attributes["initial"] = "exact"
    else:
        attributes["variability"] = "discrete" if variable.kind == COUNT else "continuous"
        if causality == "output":
            attributes["initial"] = "calculated"
    element = Element("ScalarVariable", attributes)
    has_start = causality != "output"
    if variable.kind == CHOICE:
        assert variable.type is not None
        SubElement(
            element,
            "Enumeration",
            {
                "declaredType": variable.type.name,
                "min": "1",
                "max": str(len(variable.type.items)),
                "start": str(int(variable.start)),
            },
        )
    elif variable.kind == COUNT_PARAMETER:
        integer = {} if variable.minimum is None else {"min": str(int(variable.minimum))}
        integer["start"] = str(int(variable.start))
        SubElement(element, "Integer", integer)
    else:
        real = {"unit": variable.unit}
        if variable.minimum is not None:
            real["min"] = repr(variable.minimum)
        if variable.nominal is not None:
            real["nominal"] = repr(variable.nominal)
        if has_start:
            real["start"] = repr(variable.start)
        SubElement(element, "Real", real)
    return element


def _structure(
    root: Element, described: list[tuple[int, Variable]], dependencies: list[list[int]]
) -> None:
    """Outputs, with the inputs on which they depend in the same instant; initial unknowns."""
    structure = SubElement(root, "ModelStructure")
    outputs = SubElement(structure, "Outputs")
    unknowns = SubElement(structure, "InitialUnknowns")
    index = {vr: number for number, (vr, _) in enumerate(described, start=1)}
    for vr, variable in described:
        if _CAUSALITY[variable.kind] != "output":
            continue
        inputs = [str(index[i]) for i in dependencies[vr] if i in index]
        SubElement(
            outputs,
            "Unknown",
            {
                "index": str(index[vr]),
                "dependencies": " ".join(inputs),
                "dependenciesKind": " ".join("dependent" for _ in inputs),
            },
        )
        # without the attribute dependencies: it may depend on every parameter and start value
        SubElement(unknowns, "Unknown", {"index": str(index[vr])})

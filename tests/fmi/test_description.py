"""modelDescription.xml: valid, complete, and the same as the promised interface."""

from __future__ import annotations

import random
import zipfile
from pathlib import Path
from xml.etree import ElementTree

import pytest
from fmpy.validation import validate_fmu
from interface_table import (
    ENUMERATIONS,
    FINITE,
    INTERFACE,
    NOMINALS,
    NOT_NEGATIVE,
    POSITIVE,
    UNITS,
    Row,
    rows,
)

NAMES = tuple(INTERFACE)
CASES = [(name, row) for name in NAMES for row in INTERFACE[name]]


@pytest.fixture(scope="module")
def roots(fmus: Path) -> dict[str, ElementTree.Element]:
    def parsed(name: str) -> ElementTree.Element:
        with zipfile.ZipFile(fmus / f"{name}.fmu") as archive:
            return ElementTree.fromstring(archive.read("modelDescription.xml"))

    return {name: parsed(name) for name in NAMES}


@pytest.fixture(scope="module")
def variables(roots) -> dict[str, dict[str, ElementTree.Element]]:
    return {
        name: {v.get("name"): v for v in root.find("ModelVariables")}
        for name, root in roots.items()
    }


@pytest.mark.parametrize(
    "name",  # the others are validated by the tests of `curvebound check`
    [NAMES[0], *(pytest.param(name, marks=pytest.mark.slow) for name in NAMES[1:])],
)
def test_fmpy_validate_finds_nothing(fmus: Path, name: str) -> None:
    assert validate_fmu(str(fmus / f"{name}.fmu")) == []


@pytest.mark.parametrize("name", NAMES)
def test_there_are_the_promised_variables_and_no_others(variables, name: str) -> None:
    assert set(variables[name]) == {row.name for row in INTERFACE[name]}
    assert len(INTERFACE[name]) == len({row.name for row in INTERFACE[name]})


@pytest.mark.parametrize(("name", "row"), CASES, ids=[f"{n}-{r.name}" for n, r in CASES])
def test_variable(variables, name: str, row: Row) -> None:
    variable = variables[name][row.name]
    assert variable.get("causality") == row.causality
    assert variable.get("description")
    (kind,) = variable
    if row.type in ENUMERATIONS:
        assert kind.tag == "Enumeration"
        assert kind.get("declaredType") == row.type
        assert int(kind.get("start")) == ENUMERATIONS[row.type].index(row.default) + 1
        assert (kind.get("min"), kind.get("max")) == ("1", str(len(ENUMERATIONS[row.type])))
    else:
        assert kind.tag == row.type
        assert kind.get("unit") == row.unit
        start = kind.get("start")
        assert (start is None) == (row.default is None)
        assert start is None or float(start) == row.default
    if row.causality == "parameter":
        assert variable.get("variability") == ("tunable" if row.tunable else "fixed")
        assert variable.get("initial") == "exact"
    elif row.causality == "input":
        assert variable.get("initial") is None
        assert variable.get("variability") == "continuous"
    else:
        assert variable.get("initial") == "calculated"
        # importers refuse continuous Integers
        assert variable.get("variability") == (
            "discrete" if row.name.startswith("solver.") else "continuous"
        )
    if row.type == "Real" and row.causality == "parameter":
        least = kind.get("min")
        assert (row.domain == FINITE) == (least is None)
        assert row.domain not in (POSITIVE, NOT_NEGATIVE) or float(least) == 0.0
    if row.name == "solver.max_steps":
        assert kind.get("min") == "1"
    nominal = kind.get("nominal")
    assert (None if nominal is None else float(nominal)) == NOMINALS.get(row.name)


@pytest.mark.parametrize("name", NAMES)
def test_enumerations(roots, name: str) -> None:
    types = roots[name].find("TypeDefinitions")
    used = {row.type for row in INTERFACE[name]} & set(ENUMERATIONS)
    assert {t.get("name") for t in types} == used
    for simple in types:
        items = simple.find("Enumeration").findall("Item")
        assert tuple(i.get("name") for i in items) == ENUMERATIONS[simple.get("name")]
        assert [i.get("value") for i in items] == [str(n + 1) for n in range(len(items))]
        assert simple.get("description")
        assert all(i.get("description") for i in items)


@pytest.mark.parametrize("name", NAMES)
def test_units(roots, name: str) -> None:
    found = {}
    for unit in roots[name].find("UnitDefinitions"):
        (base,) = unit
        assert base.tag == "BaseUnit"
        found[unit.get("name")] = {key: int(value) for key, value in base.items()}
    used = {row.unit for row in INTERFACE[name] if row.unit}
    assert found == {unit: UNITS[unit] for unit in used}


@pytest.mark.parametrize("name", NAMES)
def test_capabilities(roots, name: str) -> None:
    (cosimulation,) = roots[name].findall("CoSimulation")
    assert roots[name].find("ModelExchange") is None
    assert dict(cosimulation.items()) == {
        "modelIdentifier": name,
        "needsExecutionTool": "false",
        "canHandleVariableCommunicationStepSize": "true",
        "canInterpolateInputs": "true",
        "maxOutputDerivativeOrder": "1",
        "canRunAsynchronuously": "false",
        "canBeInstantiatedOnlyOncePerProcess": "false",
        "canNotUseMemoryManagementFunctions": "true",
        "canGetAndSetFMUstate": "true",
        "canSerializeFMUstate": "true",
        "providesDirectionalDerivative": "true",
    }


@pytest.mark.parametrize("name", NAMES)
def test_head(roots, name: str) -> None:
    root = roots[name]
    assert root.get("fmiVersion") == "2.0"
    assert root.get("modelName") == name
    assert root.get("variableNamingConvention") == "structured"
    assert root.get("generationDateAndTime").endswith("Z")
    assert root.get("description")
    assert root.get("license") == "MIT"
    experiment = root.find("DefaultExperiment")
    assert float(experiment.get("startTime")) == 0.0
    assert float(experiment.get("stopTime")) > 0.0
    assert float(experiment.get("stepSize")) > 0.0
    # importers would pass it to fmi2SetupExperiment, where it overrides solver.tolerance
    assert experiment.get("tolerance") is None
    assert [c.get("name") for c in root.find("LogCategories")]


def unknowns(root: ElementTree.Element, part: str) -> dict[str, ElementTree.Element]:
    names = [v.get("name") for v in root.find("ModelVariables")]
    listed = root.find("ModelStructure").find(part)
    return {names[int(u.get("index")) - 1]: u for u in listed}


@pytest.mark.parametrize("name", NAMES)
def test_outputs_and_initial_unknowns_are_complete(roots, name: str) -> None:
    outputs = {row.name for row in rows(name, "output")}
    assert set(unknowns(roots[name], "Outputs")) == outputs
    assert set(unknowns(roots[name], "InitialUnknowns")) == outputs


FORCES = {
    "BeadOnWire": {"wire.fx", "wire.fy", "constraint.multiplier", "constraint.force"},
    "ParabolaPendulum": {
        "constraint.normal_force",
        "pendulum.tension",
        "parabola.fx",
        "parabola.fy",
        "model.acceleration_error",
    },
    "ParabolaDrive": {"parabola.ax"},
}


def declared(roots, name: str) -> dict[str, set[str]]:
    names = [v.get("name") for v in roots[name].find("ModelVariables")]
    return {
        output: {names[int(i) - 1] for i in unknown.get("dependencies").split()}
        for output, unknown in unknowns(roots[name], "Outputs").items()
    }


@pytest.mark.parametrize("name", NAMES)
def test_only_forces_depend_on_the_inputs_of_the_same_instant(roots, name: str) -> None:
    inputs = {row.name for row in rows(name, "input")}
    for output, dependencies in declared(roots, name).items():
        assert dependencies == (inputs if output in FORCES[name] else set()), output


@pytest.mark.parametrize("name", NAMES)
def test_dependencies_hold_and_are_no_wider_than_needed(roots, instantiate, name: str) -> None:
    inputs = [row.name for row in rows(name, "input")]
    outputs = [row.name for row in rows(name, "output") if row.type == "Real"]
    gains = {row.name: 2.0 for row in INTERFACE[name] if row.name.startswith("feedback.")}
    linear = {"model.fidelity": "linear"} if name == "ParabolaPendulum" else {}
    seen: set[tuple[str, str]] = set()
    for choice in ({}, linear):
        instance = instantiate(name)
        instance.start({**gains, **choice})
        draw = random.Random(7)
        for _ in range(5):
            values = {i: draw.uniform(-2.0, 2.0) for i in inputs}
            instance.set(values)
            instance.step(0.1)
            for changed in inputs:
                before = instance.get(*outputs)
                instance.set({changed: values[changed] + 1.0})
                after = instance.get(*outputs)
                seen |= {
                    (output, changed)
                    for output, x, y in zip(outputs, before, after, strict=True)
                    if x != y
                }
                instance.set({changed: values[changed]})
                assert instance.get(*outputs) == before
    dependencies = declared(roots, name)
    assert seen <= {(output, i) for output in outputs for i in dependencies[output]}
    for output in FORCES[name]:
        unseen = dependencies[output] - {i for o, i in seen if o == output}
        assert len(unseen) <= len(inputs) // 2, (output, unseen)

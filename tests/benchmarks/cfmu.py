"""The FMU written in C that the Python FMUs are measured against: built from bench/c/fmu.c."""

from __future__ import annotations

import hashlib
import re
import zipfile
from pathlib import Path
from typing import NamedTuple
from xml.sax.saxutils import quoteattr

from curvebound.errors import CurveboundError
from curvebound.files import write_whole
from curvebound.units import exponents

from .native import SOURCES, shared_library

__all__ = ["PLANTS", "build_c_fmu"]

#: name of the Python FMU -> table of variables and compile-time switch of the C FMU
PLANTS = {
    "BeadOnWire": ("bead_variables.h", "PLANT_BEAD"),
    "ParabolaPendulum": ("pendulum_variables.h", "PLANT_PENDULUM"),
}

_ROW = re.compile(r'^REAL\(\w+, "([^"]+)", (\w+), "([^"]+)", ([^)]+)\)$', re.MULTILINE)


class _Real(NamedTuple):
    name: str
    causality: str
    unit: str
    start: float


def _variables(table: str) -> list[_Real]:
    text = (SOURCES / table).read_text("utf-8")
    return [
        _Real(name, causality, unit, float(start))
        for name, causality, unit, start in _ROW.findall(text)
    ]


def _unit(name: str) -> str:
    base = "".join(f' {base}="{power}"' for base, power in exponents(name).items())
    return f"<Unit name={quoteattr(name)}><BaseUnit{base}/></Unit>"


def _scalar(reference: int, variable: _Real) -> str:
    """One ScalarVariable; only inputs and parameters have a start value."""
    attributes = f'name="{variable.name}" valueReference="{reference}"'
    start = f' start="{variable.start!r}"'
    if variable.causality == "parameter":
        attributes += ' causality="parameter" variability="fixed" initial="exact"'
    elif variable.causality == "input":
        attributes += ' causality="input" variability="continuous"'
    else:
        attributes += ' causality="output" variability="continuous" initial="calculated"'
        start = ""
    return (
        f"<ScalarVariable {attributes}><Real unit={quoteattr(variable.unit)}{start}/>"
        "</ScalarVariable>"
    )


def _model_description(name: str, guid: str, variables: list[_Real]) -> str:
    units = dict.fromkeys(variable.unit for variable in variables)
    unknowns = "".join(
        f'<Unknown index="{index}"/>'
        for index, variable in enumerate(variables, start=1)
        if variable.causality == "output"
    )
    scalars = "\n".join(_scalar(reference, v) for reference, v in enumerate(variables))
    return (
        '<?xml version="1.0" encoding="UTF-8"?>\n'
        f'<fmiModelDescription fmiVersion="2.0" modelName="{name}" guid="{guid}"'
        ' generationTool="curvebound benchmarks" variableNamingConvention="structured">\n'
        f'<CoSimulation modelIdentifier="{name}" canHandleVariableCommunicationStepSize="true"/>\n'
        f"<UnitDefinitions>{''.join(map(_unit, units))}</UnitDefinitions>\n"
        '<DefaultExperiment startTime="0.0" stopTime="10.0" stepSize="0.001"/>\n'
        f"<ModelVariables>\n{scalars}\n</ModelVariables>\n"
        f"<ModelStructure><Outputs>{unknowns}</Outputs>"
        f"<InitialUnknowns>{unknowns}</InitialUnknowns></ModelStructure>\n"
        "</fmiModelDescription>\n"
    )


def build_c_fmu(name: str, out: Path) -> Path:
    """Write the C counterpart of the FMU `name` to the folder `out`; returns the .fmu.

    Its variables are a part of those of the Python FMU, under the same names. CurveboundError for
    a name without a counterpart, or without a C compiler.
    """
    import fmpy

    if name not in PLANTS:
        raise CurveboundError(f"There is no C FMU {name}; there are {', '.join(PLANTS)}.")
    table, switch = PLANTS[name]
    variables = _variables(table)
    guid = hashlib.sha256(_model_description(name, "", variables).encode()).hexdigest()[:32]
    library = shared_library("fmu.c", switch, f'GUID="{guid}"')

    def write(half: Path) -> None:
        with zipfile.ZipFile(half, "w", zipfile.ZIP_DEFLATED) as archive:
            archive.writestr("modelDescription.xml", _model_description(name, guid, variables))
            archive.write(library, f"binaries/{fmpy.platform}/{name}{fmpy.sharedLibraryExtension}")

    return write_whole(out / f"{name}.fmu", write)

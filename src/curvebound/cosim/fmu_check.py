"""What an FMU's description must be before anything relies on it."""

from __future__ import annotations

import zipfile
from pathlib import Path
from typing import Any
from xml.etree import ElementTree

__all__ = ["check_description", "check_structure", "default_initial"]

_CAUSALITIES = (
    *("parameter", "calculatedParameter", "input", "output", "local", "independent", None),
)
_VARIABILITIES = ("constant", "fixed", "tunable", "discrete", "continuous", None)
_INITIALS = ("exact", "approx", "calculated", None)


def check_structure(path: Path) -> None:
    """Raise ValueError where modelDescription.xml is none, or refers to variables it has not.

    fmpy takes any root element, and an index of 0 as that of the last variable.
    """
    with zipfile.ZipFile(path) as archive:
        try:
            data = archive.read("modelDescription.xml")
        except KeyError:
            raise ValueError("it holds no modelDescription.xml, so it is no FMU") from None
    try:
        root = ElementTree.fromstring(data)
    except ElementTree.ParseError as error:
        raise ValueError(f"modelDescription.xml is no XML: {error}") from error
    if root.tag != "fmiModelDescription":
        raise ValueError(f"modelDescription.xml begins with {root.tag}, not fmiModelDescription")
    version = root.get("fmiVersion", "none")
    if not version.startswith("2."):
        raise ValueError(f"it is of FMI {version}; taken are FMUs of FMI 2.0 for co-simulation")
    variables = root.findall("ModelVariables/ScalarVariable")
    for number, variable in enumerate(variables, 1):
        for attribute in ("name", "valueReference"):
            if not variable.get(attribute):
                raise ValueError(f"its variable number {number} has no {attribute}")
    count = len(variables)
    for group in root.findall("ModelStructure/*"):
        for unknown in group:
            words = [unknown.get("index", ""), *unknown.get("dependencies", "").split()]
            for word in words:
                if not (word.isdigit() and 1 <= int(word) <= count):
                    raise ValueError(
                        f"{group.tag} in its ModelStructure names variable {word or 'none'}; "
                        f"they are numbered 1 to {count}"
                    )


def check_description(md: Any) -> None:
    """Raise ValueError where fmpy's description of an FMI 2.0 FMU is not one to build on."""
    if not md.guid:
        raise ValueError("it has no guid")
    identifier = md.coSimulation.modelIdentifier or ""
    if not identifier or set(identifier) & set("/\\:\0"):
        raise ValueError(f"its modelIdentifier, {identifier!r}, is no name of a file")
    names: set[str] = set()
    for variable in md.modelVariables:
        if variable.name in names:
            raise ValueError(f"it has two variables {variable.name}")
        names.add(variable.name)
        for kind, value, known in (
            ("causality", variable.causality, _CAUSALITIES),
            ("variability", variable.variability, _VARIABILITIES),
            ("initial", variable.initial, _INITIALS),
        ):
            if value not in known:
                raise ValueError(
                    f"the {kind} of {variable.name} is {value!r}; FMI knows "
                    + ", ".join(word for word in known if word)
                )


def default_initial(causality: str, variability: str) -> str:
    """FMI 2.0.3, section 2.2.7, table of the default values of `initial`."""
    if causality == "parameter" or variability == "constant":
        return "exact"
    return "" if causality in ("input", "independent") else "calculated"

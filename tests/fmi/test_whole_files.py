"""The files of the FMUs, and their sketches, as a whole."""

from __future__ import annotations

import zipfile
from pathlib import Path

import pytest
from fingerprints import as_text, assert_same

from curvebound.fmi.folder import find, names

FILES = ("modelDescription.xml", "documentation/index.html", "documentation/reference.csv",
         "documentation/reference_inputs.csv", "resources/drawing.json",
         "documentation/licenses/license.txt")  # fmt: skip


@pytest.mark.parametrize("name", names())
def test_files_of_an_fmu(name: str, interpreted_fmus: Path) -> None:
    with zipfile.ZipFile(interpreted_fmus / f"{name}.fmu") as archive:
        for file in FILES:
            assert_same(f"fmi {name} {file}", archive.read(file).decode())


@pytest.mark.parametrize("name", names())
def test_what_a_system_declares(name: str) -> None:
    """Variables, units, starts, and the ranges that random motions are drawn from."""
    assert_same(f"declaration of {name}", as_text(find(name).declaration()._asdict()))

"""The FMUs carry the maps that `python tests/benchmarks maps --documentation fmus` made."""

from __future__ import annotations

import re
import zipfile
from pathlib import Path
from xml.etree import ElementTree

import pytest
from benchmarks.catalogue import catalogue

#: the whole file; an FMU is below a megabyte
LARGEST = 16_000


@pytest.mark.parametrize("name", ["BeadOnWire", "ParabolaPendulum"])
def test_the_documentation_shows_the_maps(fmus: Path, name: str) -> None:
    with zipfile.ZipFile(fmus / f"{name}.fmu") as archive:
        page = archive.read("documentation/index.html").decode()
        shown = re.findall(r'<img src="([^"]+)"', page)
        assert shown == ["stability.svg"]
        picture = archive.read("documentation/stability.svg")
    assert len(picture) < LARGEST
    root = ElementTree.fromstring(picture)
    assert b"prefers-color-scheme:dark" in picture
    words = {element.text for element in root.iter() if element.text}
    for one in catalogue():
        if one.fmu == name:
            variable = one.axis.path.partition(".")[2]
            assert any(text.startswith(variable) for text in words), variable
    # the lines of four methods, twice each, in every panel
    lines = [element for element in root.iter() if element.tag.endswith("polyline")]
    assert len(lines) == 8 * sum(one.fmu == name for one in catalogue())


def test_the_drive_needs_none(fmus: Path) -> None:
    with zipfile.ZipFile(fmus / "ParabolaDrive.fmu") as archive:
        assert "documentation/stability.svg" not in archive.namelist()

"""A start at which the mass matrix is singular: a cusp of the curve."""

from __future__ import annotations

from pathlib import Path

import pytest

from curvebound.errors import CurveboundError
from curvebound.fmi.folder import Folder
from curvebound.fmi.reference import reference_result

MECHANICS = """
from curvebound.mechanics import Mechanics, length, mass
u = length("body.u")
MECHANICS = Mechanics(coordinates=[u], masses=[mass("body", u**2, u**3)])
"""
FMU = """
from curvebound.fmi.declaration import Fmu
FMU = Fmu(name="Cusp", description="a body at a cusp", stop_time=0.02)
"""


def test_a_start_without_acceleration_is_named_with_its_value(tmp_path: Path) -> None:
    folder = tmp_path / "cusp"
    folder.mkdir()
    (folder / "mechanics.py").write_text(MECHANICS, encoding="utf-8")
    (folder / "fmu.py").write_text(FMU, encoding="utf-8")
    fmu = Folder(folder).fmu()
    with pytest.raises(
        CurveboundError, match=r"at the start, body\.u_start = 0\.0, .*moves no mass"
    ):
        reference_result(fmu)
    moved = tuple(v._replace(start=0.5) if v.name == "body.u_start" else v for v in fmu.variables)
    assert len(reference_result(fmu._replace(variables=moved)).time) == 3

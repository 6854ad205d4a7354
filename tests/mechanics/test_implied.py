"""The variables that follow from a statement, and what fmu.py may say of them."""

from __future__ import annotations

import importlib.util
from pathlib import Path

import pytest

from curvebound.errors import CurveboundError
from curvebound.fmi.declaration import OUTPUT, PARAMETER, Fmu, parameter
from curvebound.fmi.folder import Folder
from curvebound.fmi.implied import complete_variables

ROOT = Path(__file__).parents[2]


@pytest.mark.parametrize("name", ["bead_on_wire", "parabola_pendulum"])
def test_a_shipped_system_implies_its_declared_variables(name: str) -> None:
    source = ROOT / "fmus" / name / "fmu.py"
    spec = importlib.util.spec_from_file_location(f"declared_{name}", source)
    assert spec is not None
    assert spec.loader is not None
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    fmu: Fmu = module.FMU
    parameters = tuple(v for v in fmu.variables if v.kind == PARAMETER)
    implied = complete_variables(parameters, Folder(source.parent).derived())
    declared = {v.name: v for v in fmu.variables}
    assert {v.name for v in implied} == declared.keys()
    for v in implied:
        assert v.kind == declared[v.name].kind
        if v.name != "constraint.multiplier":  # only the author knows the unit of the constraint
            assert v.unit == declared[v.name].unit, v.name


def test_fmu_py_says_units_and_domains() -> None:
    derived = Folder(Path(__file__).parent / "systems" / "bead_on_parabola").derived()
    own = parameter("wire.coefficient", "1/m", 0.5, "coefficient of y = a x^2")
    found = {v.name: v for v in complete_variables((own,), derived)}
    assert found["wire.coefficient"] == own
    assert (found["bead.mass"].unit, found["bead.mass"].above) == ("kg", True)
    assert (found["bead.u_rate"].kind, found["bead.u_rate"].unit) == (OUTPUT, "m/s")
    with pytest.raises(CurveboundError, match=r"wire\.coeficient.*wire\.coefficient"):
        complete_variables((own._replace(name="wire.coeficient"),), derived)

"""The variables that follow from a statement, and what fmu.py may say of them."""

from __future__ import annotations

import importlib.util
from pathlib import Path

import pytest

from curvebound.errors import CurveboundError
from curvebound.fmi.declaration import OUTPUT, PARAMETER, Fmu, parameter
from curvebound.fmi.folder import Folder
from curvebound.fmi.implied import complete_variables
from curvebound.mechanics.derived import Implied

HERE = Path(__file__).parent
ROOT = HERE.parents[1]

#: kind, name, unit, start, least value, unit that follows from another variable's
ON_A_CURVE = """
parameter bead.mass kg 1 >0
parameter wire.height 1 1
parameter wire.width 1 1
parameter bead.damping N.s/m 0 >=0
parameter constraint.stiffness 1/s2 100 >=0
parameter constraint.damping 1/s 20 >=0
parameter bead.angle_start rad 0
parameter bead.angular_velocity_start rad/s 0 of bead.angle_start, per_second 1
choice model.formulation - 1
choice constraint.stabilization - 3
input wire.ax m/s2 0
input wire.ay m/s2 0
input bead.fx N 0
input bead.fy N 0
output bead.angle rad 0 of bead.angle_start, per_second 0
output bead.angular_velocity rad/s 0 of bead.angle_start, per_second 1
output bead.x m 0
output bead.y m 0
output bead.vx m/s 0
output bead.vy m/s 0
output wire.x m 0
output wire.y m 0
output wire.vx m/s 0
output wire.vy m/s 0
output energy J 0
output wire.fx N 0
output wire.fy N 0
output constraint.multiplier 1 0
output constraint.force N 0
output constraint.drift m 0
"""
IN_TWO_COORDINATES = """
parameter parabola.coefficient_start 1 1
parameter parabola.coefficient_rate_start 1/s 0 of parabola.coefficient_start, per_second 1
parameter slider.mass kg 1 >0
parameter pendulum.mass kg 1 >0
parameter pendulum.length 1 1
parameter slider.damping N.s/m 0 >=0
parameter pendulum.damping N.m.s/rad 0 >=0
parameter slider.u_start m 0
parameter slider.u_rate_start m/s 0 of slider.u_start, per_second 1
parameter pendulum.angle_start rad 0
parameter pendulum.angular_velocity_start rad/s 0 of pendulum.angle_start, per_second 1
choice model.fidelity - 2
input parabola.ax m/s2 0
input parabola.ay m/s2 0
input parabola.coefficient_acceleration 1/s2 0 of parabola.coefficient_start, per_second 2
input slider.fx N 0
input slider.fy N 0
input pendulum.fx N 0
input pendulum.fy N 0
output slider.u m 0 of slider.u_start, per_second 0
output slider.u_rate m/s 0 of slider.u_start, per_second 1
output pendulum.angle rad 0 of pendulum.angle_start, per_second 0
output pendulum.angular_velocity rad/s 0 of pendulum.angle_start, per_second 1
output slider.x m 0
output slider.y m 0
output slider.vx m/s 0
output slider.vy m/s 0
output pendulum.x m 0
output pendulum.y m 0
output pendulum.vx m/s 0
output pendulum.vy m/s 0
output parabola.x m 0
output parabola.y m 0
output parabola.vx m/s 0
output parabola.vy m/s 0
output parabola.coefficient 1 0 of parabola.coefficient_start, per_second 0
output parabola.coefficient_rate 1/s 0 of parabola.coefficient_start, per_second 1
output energy J 0
output parabola.fx N 0
output parabola.fy N 0
output constraint.normal_force N 0
output pendulum.tension N 0
output model.acceleration_error 1 0
"""


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


def line(v: Implied) -> str:
    """All that is said of a variable but its description."""
    words = [v.kind, v.name, v.unit or "-", f"{v.start:g}"]
    if v.minimum is not None:
        words.append(f"{'>' if v.above else '>='}{v.minimum:g}")
    return " ".join([*words, *([f"of {v.of}, per_second {v.per_second}"] if v.of else [])])


@pytest.mark.parametrize(
    ("folder", "lines"),
    [
        (HERE / "systems" / "bead_on_ellipse", ON_A_CURVE),
        (ROOT / "fmus" / "parabola_pendulum", IN_TWO_COORDINATES),
    ],
    ids=lambda x: x.name if isinstance(x, Path) else "",
)
def test_every_variable_is_implied_with_unit_start_and_domain(folder: Path, lines: str) -> None:
    derived = Folder(folder).derived()
    assert [line(v) for v in derived.variables] == lines.strip().splitlines()
    assert all(v.description for v in derived.variables)


def test_the_parts_of_a_system_are_named() -> None:
    bead = Folder(HERE / "systems" / "bead_on_ellipse").derived()
    pendulum = Folder(ROOT / "fmus" / "parabola_pendulum").derived()
    assert (bead.coordinates, bead.rates) == (("bead.angle",), ("bead.angular_velocity",))
    assert pendulum.coordinates == ("slider.u", "pendulum.angle")
    assert pendulum.rates == ("slider.u_rate", "pendulum.angular_velocity")
    assert (bead.angles, pendulum.angles) == ((True,), (False, True))
    assert (bead.masses, pendulum.masses) == (("bead",), ("slider", "pendulum"))
    assert (bead.shapes, pendulum.shapes) == ((), ("parabola.coefficient",))
    assert (bead.frame, pendulum.frame) == ("wire", "parabola")
    assert (bead.damping, pendulum.damping) == (
        ("bead.damping",), ("slider.damping", "pendulum.damping")
    )  # fmt: skip
    assert bead.forces == ("bead.fx", "bead.fy")
    assert pendulum.forces == ("pendulum.fx", "pendulum.fy", "slider.fx", "slider.fy")
    assert (bead.has_constraint, bead.has_linear) == (True, False)
    assert (pendulum.has_constraint, pendulum.has_linear) == (False, True)

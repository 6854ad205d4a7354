"""Mistakes in fmu.py and in the names of a folder: told before anything is built, by name."""

from __future__ import annotations

import re
import shutil
from pathlib import Path

import pytest

from curvebound.cli import main
from curvebound.errors import CurveboundError
from curvebound.fmi.declaration import Variable
from curvebound.fmi.folder import Folder, find, systems_in

MECHANICS = """\
from curvebound.mechanics import Mechanics, angle, drag, input_, length, mass, parameter, shape

u, tilt = length("bead.u"), shape("track.tilt")
turn = angle("ball.angle")
push = input_("track.push")
bead = mass("bead", u, parameter("track.bend") * u**2 + tilt * u)
ball = mass("ball", u, turn)
MECHANICS = Mechanics(
    [u, turn], [bead, ball], damping=[drag("bead.damping", bead)], couples={u: push}
)
"""
BEND = 'parameter("track.bend", "1/m", 0.5, "bend"),'


def system(folder: Path, variables: str, name: str = "tilted_track", more: str = "") -> Folder:
    """A system that declares `variables` beside its mechanics."""
    own = folder / name
    own.mkdir(parents=True, exist_ok=True)
    (own / "mechanics.py").write_text(MECHANICS)
    (own / "fmu.py").write_text(
        "from curvebound.fmi.declaration import *\n"
        f'FMU = Fmu("TiltedTrack", "a bead", ({variables}){more})\n'
    )
    return Folder(own)


def refused(folder: Path, variables: str, more: str = "") -> str:
    own = system(folder, variables, more=more)
    with pytest.raises(CurveboundError) as caught:
        own.declaration()
    said = str(caught.value)
    assert str(own.path / "fmu.py") in said
    assert len(said.replace(str(own.path), "")) < 260
    return said


def declared(folder: Path, variables: str) -> dict[str, Variable]:
    return {v.name: v for v in system(folder, variables).declaration().variables}


@pytest.mark.parametrize(
    ("variables", "said"),
    [
        (BEND + BEND, r"declares track\.bend 2 times: keep one"),
        (BEND[:-1], r"declares track\.bend alone, which takes a comma"),
        (
            BEND.replace("track.", "track-"),
            r"declares 'track-bend', no name of a variable: use let",
        ),
        (BEND + '"bead.mass",', "declares 'bead.mass' among the variables"),
        (
            'parameter("bead.u_start", 1.0, "m", "start"),',
            r"'bead\.u_start' with the unit 1\.0 and the start 'm'.*\(name, unit, start, desc",
        ),
        ('parameter("bead.u_start", "m", 1.0, 2.0),', r"'bead\.u_start' with the description 2\.0"),
        (
            'parameter("track.bend", "furlong", 1.0, "bend"),',
            r"unit of track\.bend: 'furlong' is no unit",
        ),
        (
            'parameter("bead.x", "m", 0.0, "place"),',
            r"bead\.x as a parameter, but it is an output: write output\('bead\.x', unit",
        ),
        (
            'output("track.bend", "1/m", "bend"),',
            r"track\.bend as an output, but it is a parameter: write parameter\('track\.bend', un",
        ),
        (
            'parameter("solver.method", "1", 4.0, "method"),',
            r"solver\.method as a parameter, but it is a choice",
        ),
        (
            'parameter("track.bned", "1/m", 0.5, "bend"),',
            r"declares track\.bned, which mechanics\.py does not use; did you mean track\.bend",
        ),
        (
            'parameter("colour", "1", 0.5, "none"),',
            r"declares colour, which mechanics\.py does not use; ",
        ),
    ],
)
def test_a_mistake_in_a_declaration_is_told_by_its_name(
    tmp_path: Path, variables: str, said: str
) -> None:
    assert re.search(said, refused(tmp_path, variables))


@pytest.mark.parametrize(
    ("variables", "said"),
    [
        ('parameter("bead.u_start", "rad", 1.0, "start"),', r"bead\.u_start in 'rad'.*in 'm'"),
        ('output("bead.u_rate", "rad/s", "rate"),', r"bead\.u_rate in 'rad/s'.*in 'm/s'"),
        ('output("bead.x", "s", "place"),', r"bead\.x in 's'.*in 'm'"),
        ('parameter("ball.angle_start", "m", 1.0, "a"),', r"ball\.angle_start in 'm'.*in 'rad'"),
        ('output("ball.angular_velocity", "1/s", "a"),', r"ball\.angular_velocity in '1/s'.*rad/s"),
        ('parameter("bead.mass", "N", 1.0, "mass"),', r"bead\.mass in 'N'.*in 'kg'"),
        ('input_("bead.fx", "kg", "force"),', r"bead\.fx in 'kg'.*in 'N'"),
        ('parameter("bead.damping", "N/m", 1.0, "damping"),', r"bead\.damping in 'N/m'"),
        ('parameter("gravity.y", "N", 1.0, "gravity"),', r"gravity\.y in 'N'.*in 'm/s2'"),
        ('output("energy.total", "N", "energy"),', r"energy\.total in 'N'.*in 'J'"),
        (
            'output("track.tilt", "rad", "tilt"),'
            'input_("track.tilt_acceleration", "1/s2", "acceleration"),',
            r"track\.tilt_acceleration in '1/s2'.*track\.tilt in 'rad'|"
            r"track\.tilt in 'rad'|track\.tilt_acceleration in '1/s2'",
        ),
    ],
)
def test_a_unit_is_that_of_the_statement(tmp_path: Path, variables: str, said: str) -> None:
    assert re.search(said, refused(tmp_path, variables))


@pytest.mark.parametrize(
    "one",
    [
        'output("track.tilt", "rad", "tilt"),',
        'parameter("track.tilt_start", "rad", 0.1, "tilt"),',
        'input_("track.tilt_acceleration", "rad/s2", "acceleration"),',
        'parameter("track.tilt_rate_start", "rad/s", 0.1, "rate"),',
    ],
)
def test_a_shape_has_one_unit_whichever_of_its_variables_declares_it(
    tmp_path: Path, one: str
) -> None:
    found = declared(tmp_path, one)
    tilt = "track.tilt"
    assert (found[tilt].unit, found[f"{tilt}_start"].unit) == ("rad", "rad")
    assert found[f"{tilt}_rate"].unit == found[f"{tilt}_rate_start"].unit == "rad/s"
    assert found[f"{tilt}_acceleration"].unit == "rad/s2"


def test_units_of_the_same_quantity_and_a_mere_number_are_kept(tmp_path: Path) -> None:
    found = declared(
        tmp_path,
        'parameter("bead.u_start", "1", 1.0, "parameter of the curve"),'
        'input_("bead.fx", "kg.m/s2", "force"), input_("track.push", "N.m", "push"),',
    )
    assert (found["bead.u"].unit, found["bead.u_rate"].unit) == ("1", "1/s")
    assert (found["bead.fx"].unit, found["track.push"].unit) == ("kg.m/s2", "N.m")


def test_a_domain_is_kept_and_may_be_narrowed(tmp_path: Path) -> None:
    found = declared(
        tmp_path,
        'parameter("bead.mass", "kg", 2.0, "mass"),'
        'parameter("ball.mass", "kg", 2.0, "mass", at_least=0.5),'
        'parameter("bead.damping", "N.s/m", 0.1, "damping", at_least=-1.0),'
        'parameter("solver.step", "s", 0.01, "step"),',
    )
    domains = {name: (v.minimum, v.above) for name, v in found.items()}
    assert domains["bead.mass"] == (0.0, True)
    assert domains["ball.mass"] == (0.5, False)
    assert domains["bead.damping"] == (0.0, False)
    assert domains["solver.step"] == (0.0, True)


@pytest.mark.parametrize(
    ("variables", "said"),
    [
        ('parameter("bead.mass", "kg", -1, "mass"),', r"bead\.mass starts at -1, .*above 0"),
        ('parameter("bead.mass", "kg", 0.0, "mass"),', r"bead\.mass starts at 0\.0, .*above 0"),
        ('parameter("solver.step", "s", 0.0, "step"),', r"solver\.step starts at 0\.0"),
        (
            'parameter("track.bend", "1/m", 0.1, "bend", at_least=0.5),',
            r"track\.bend starts at 0\.1, .*at least 0\.5",
        ),
        (
            'parameter("track.bend", "1/m", float("nan"), "bend"),',
            r"track\.bend starts at nan, .*finite",
        ),
    ],
)
def test_a_start_outside_its_domain_is_refused(tmp_path: Path, variables: str, said: str) -> None:
    assert re.search(said, refused(tmp_path, variables))


@pytest.mark.parametrize(
    ("more", "said"),
    [
        (', plotted=("bead.z",)', r"plotted names 'bead\.z'.*did you mean bead\."),
        (', plotted=("bead.mass",)', r"plotted names 'bead\.mass', which is no output"),
        (', reference_inputs={"bead.f": 1.0}', r"reference_inputs names 'bead\.f'.*bead\.fx"),
        (', ranges={"bead.mas": None}', r"ranges names 'bead\.mas'.*bead\.mass"),
    ],
)
def test_names_beside_the_variables_are_checked(tmp_path: Path, more: str, said: str) -> None:
    assert re.search(said, refused(tmp_path, BEND, more))


@pytest.mark.usefixtures("short_reference")
def test_build_tells_what_is_left_open(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    own = system(tmp_path, 'output("track.tilt", "rad", "tilt"),')
    assert own.left_open() == ["track.bend", "track.push"]
    assert system(tmp_path, BEND).left_open() == ["track.tilt_start", "track.push"]
    assert find("BeadOnWire").left_open() == []
    assert main(["build", str(own.path), "--out", str(tmp_path), "--no-compile"]) == 0
    _, note = capsys.readouterr().out.splitlines()
    assert "track.tilt_start, track.push: mechanics.py uses what" in note
    assert f"{own.path / 'fmu.py'} does not declare" in note


@pytest.mark.parametrize("name", ["dash-name", "space name", "Capital", "none", "a__b", "2nd"])
def test_one_rule_for_the_names_of_folders(
    tmp_path: Path, name: str, capsys: pytest.CaptureFixture[str]
) -> None:
    own = system(tmp_path, BEND, name)
    assert main(["build", str(own.path), "--out", str(tmp_path)]) == 1
    assert f"'{name}' cannot be the name of a system" in capsys.readouterr().err
    assert main(["new", str(tmp_path / "new" / name)]) == 1
    assert f"'{name}' cannot be the name of a system" in capsys.readouterr().err
    assert systems_in(tmp_path) == []


@pytest.mark.parametrize(
    ("text", "said"),
    [
        ("", r"drawing\.py declares no drawing: write DRAWING = Drawing\(\.\.\.\)"),
        ("DRAWING = 1\n", r"drawing\.py declares no drawing"),
        (
            "from curvebound.fmi.drawing import Drawing\nDRAWING = Drawing(readouts=('bead.z',))\n",
            r"names 'bead\.z'.*did you mean bead\.",
        ),
    ],
)
def test_a_mistake_in_a_drawing_is_told(tmp_path: Path, text: str, said: str) -> None:
    own = system(tmp_path, BEND)
    (own.path / "drawing.py").write_text(text)
    with pytest.raises(CurveboundError, match=said):
        own.drawing()


@pytest.mark.parametrize(
    ("old", "new", "said"),
    [
        (
            'output("bead.x", "m",',
            'parameter("bead.x", "m", 0.0,',
            r"declares bead\.y where the outputs of kernel\.py have bead\.x: declare them in its",
        ),
        ('input_("wire.ax"', 'input_("wire.az"', r"declares wire\.az where the inputs .* wire\.ax"),
        (
            'parameter("bead.damping"',
            'parameter("bead.drag"',
            r"kernel\.py reads bead\.damping, which .*fmu\.py does not declare; did you mean",
        ),
    ],
)
def test_a_kernel_by_hand_has_the_declared_variables(
    tmp_path: Path, old: str, new: str, said: str
) -> None:
    own = tmp_path / "bead_on_wire"
    shutil.copytree(find("BeadOnWire").path, own, ignore=shutil.ignore_patterns("__pycache__"))
    text = (own / "fmu.py").read_text(encoding="utf-8")
    assert old in text
    head, _ = text.replace(old, new).split("    reference_inputs=")
    (own / "fmu.py").write_text(f"{head})\n", encoding="utf-8")
    with pytest.raises(CurveboundError, match=said) as caught:
        Folder(own).fmu()
    assert len(str(caught.value).replace(str(own), "")) < 260


def test_a_kernel_by_hand_has_few_groups_of_outputs(tmp_path: Path) -> None:
    own = tmp_path / "bead_on_wire"
    shutil.copytree(find("BeadOnWire").path, own, ignore=shutil.ignore_patterns("__pycache__"))
    kernel = own / "base.py"
    last = '"constraint.force": '
    text = kernel.read_text(encoding="utf-8")
    assert text.count(f"{last}2,") == 1
    for group, refused in ((13, False), (14, True)):
        kernel.write_text(text.replace(f"{last}2,", f"{last}{group},"), encoding="utf-8")
        if refused:
            with pytest.raises(CurveboundError, match="outputs in 15 groups: there can be 14;"):
                Folder(own).fmu()
        else:
            Folder(own).fmu()

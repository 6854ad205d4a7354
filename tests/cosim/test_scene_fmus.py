"""FMUs for one scene: its settings are their defaults, and they show what it uses."""

from __future__ import annotations

import zipfile
from pathlib import Path

import numpy as np
import pytest
from fmpy.validation import validate_fmu

from curvebound.cli import main
from curvebound.cosim import Scene, load_scene
from curvebound.cosim.fmu import read_fmu
from curvebound.cosim.scene_fmus import specialised
from curvebound.errors import CurveboundError


@pytest.fixture(scope="module")
def built(tmp_path_factory: pytest.TempPathFactory) -> Path:
    folder = tmp_path_factory.mktemp("for")
    assert main(["build", "--for", "inverted_balance", "--out", str(folder)]) == 0
    return folder


def test_they_run_the_scene_without_being_told_its_start_values(built: Path) -> None:
    own = load_scene("inverted_balance")
    own.stop_time = 2.0
    expected = own.run()
    scene = own.copy()
    for name, component in scene.components.items():
        component.source = built / f"InvertedBalance{name.capitalize()}.fmu"
        component.start = {}
    result = scene.run()
    for name in expected.names:
        assert np.array_equal(result[name], expected[name]), name


def test_they_show_what_the_scene_sets_drives_connects_and_records(built: Path) -> None:
    fmu = read_fmu(built / "InvertedBalancePlant.fmu")
    assert set(fmu.variables) == {
        "slider.u_start", "pendulum.angle_start",  # set
        "pendulum.fx",  # driven
        "parabola.ax", "parabola.ay", "parabola.coefficient_acceleration",  # connected
        "slider.u", "slider.u_rate", "slider.x", "slider.y", "slider.vx", "slider.vy",
        "pendulum.angle", "pendulum.angular_velocity", "pendulum.x", "pendulum.y", "pendulum.vx",
        "pendulum.vy", "pendulum.tension", "parabola.x", "parabola.y", "parabola.vx", "parabola.vy",
        "parabola.coefficient", "parabola.coefficient_rate", "parabola.fx", "parabola.fy",
        "constraint.normal_force",  # drawn as an arrow
        "energy.kinetic", "energy.potential", "energy.total", "energy.residual",
    }  # fmt: skip
    assert fmu.variables["pendulum.angle_start"].start == repr(np.pi - 0.1)
    assert (fmu.stop_time, fmu.step) == (20.0, 0.01)
    drive = read_fmu(built / "InvertedBalanceDrive.fmu")
    assert "waveform.kind" not in drive.variables
    assert drive.dependencies["parabola.ay"] == ()
    assert set(drive.dependencies["parabola.ax"]) == {
        "slider.u", "slider.u_rate", "pendulum.angle", "pendulum.angular_velocity", "parabola.x",
        "parabola.vx",
    }  # fmt: skip


def test_they_are_valid_smaller_and_carry_no_statement(built: Path, fmus: Path) -> None:
    for part, name in (("Plant", "ParabolaPendulum"), ("Drive", "ParabolaDrive")):
        path = built / f"InvertedBalance{part}.fmu"
        assert validate_fmu(str(path)) == []
        assert path.stat().st_size < (fmus / f"{name}.fmu").stat().st_size
        with zipfile.ZipFile(path) as archive:
            assert not [n for n in archive.namelist() if n.endswith("resources/mechanics.py")]


def test_names_and_what_cannot_be_changed(mass_fmu: Path) -> None:
    scene = Scene("two beads, 1 wire", stop_time=1.0, step=0.1)
    scene.add("a b", "BeadOnWire", {"solver.method": "adaptive"})
    scene.add("other", mass_fmu)
    (one,) = specialised(scene)
    assert one.name == "TwoBeads1WireAB"
    assert dict(one.start) == {"solver.method": 4.0}
    scene = Scene("s", stop_time=1.0, step=0.1).add("other", mass_fmu)
    with pytest.raises(CurveboundError, match="FMU files only"):
        specialised(scene)


def test_a_start_value_outside_its_domain_is_no_default() -> None:
    scene = Scene("heavy", stop_time=0.1, step=0.01)
    scene.add("body", "BeadOnWire", {"bead.mass": -1.0})
    (system,) = specialised(scene)
    with pytest.raises(CurveboundError, match=r"HeavyBody.*bead\.mass starts at -1\.0, .*above 0"):
        system.fmu()

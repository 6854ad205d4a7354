"""The scenes that come with the package: each runs, by itself too, and shows what it says."""

from __future__ import annotations

import math
import re
import subprocess
import sys
import time

import numpy as np
import pytest

from curvebound.cli import main
from curvebound.cli import main as command_line
from curvebound.cosim import load_scene, read_csv, scene_names
from curvebound.cosim.command import summarize, summary
from curvebound.cosim.instance import Library
from curvebound.errors import CurveboundError
from curvebound.places import scenarios_directory

SINGLE = ["bead_on_wire", "pendulum_small", "pendulum_large", "shaken_wire"]
COUPLED = [
    "swaying_parabola",
    "active_damping",
    "inverted_balance",
    "vibrated_upright",
    "pumped_swing",
    "two_wires",
    "sampled_feedback",
]


def test_all_scenes_are_there():
    assert set(scene_names()) >= {*SINGLE, *COUPLED}


@pytest.mark.parametrize("name", SINGLE + COUPLED)
def test_scene_runs_states_its_needs_and_keeps_its_energy(name):
    scene = load_scene(name)
    assert scene.name == name
    assert scene.description
    assert scene.needs.errors
    scene.stop_time = min(scene.stop_time, 2.0)
    result = scene.run()
    assert result.complete
    assert result.time[-1] == pytest.approx(scene.stop_time)
    for column in result.names:
        assert np.all(np.isfinite(result[column])), column
        if column.endswith("energy.residual") and name != "two_wires":
            assert np.max(np.abs(result[column])) < 1e-6
    for path in scene.needs.errors:
        assert path in result.names


def test_scenes_run_as_scripts(tmp_path):
    script = scenarios_directory() / "swaying_parabola.py"
    out = tmp_path / "sway.csv"
    done = subprocess.run(
        [sys.executable, str(script), "--stop", "0.5", "--out", str(out)],
        capture_output=True, text=True, check=False, cwd=tmp_path,
    )  # fmt: skip
    assert done.returncode == 0, done.stderr
    assert "swaying_parabola: 0.5 s simulated" in done.stdout
    assert read_csv(out)["time"][-1] == 0.5
    assert len(read_csv(out).dtype.names) == 9  # time and eight outputs


def test_vibration_holds_the_pendulum_up_above_the_threshold_only():
    scene = load_scene("vibrated_upright")
    held = scene.run()
    assert np.max(np.abs(held["plant.pendulum.angle"] - math.pi)) < 0.3
    assert np.max(np.abs(held["plant.parabola.y"])) < 0.1
    assert abs(held["plant.parabola.y"][-1]) < 1e-6  # up and down about one place
    fallen = scene.with_variant("below").run()
    assert np.max(np.abs(fallen["plant.pendulum.angle"] - math.pi)) > math.pi / 2


def test_the_threshold_is_where_theory_has_it():
    scene = load_scene("vibrated_upright")
    scene.stop_time = 6.0
    amplitude = scene.components["drive"].start["waveform.amplitude"]
    scene.set("plant.pendulum.angle_start", math.pi - 0.01)

    def stays(factor):
        scene.set("drive.waveform.amplitude", amplitude / 1.3 * factor)
        return np.max(np.abs(scene.run()["plant.pendulum.angle"] - math.pi)) < 0.2

    assert not stays(0.95)
    assert stays(1.05)


def test_pumping_grows_at_twice_the_frequency_only():
    scene = load_scene("pumped_swing")
    grown = scene.run()
    early = np.max(np.abs(grown["plant.slider.u"][grown.time < 5.0]))
    assert np.max(np.abs(grown["plant.slider.u"])) > 4.0 * early
    detuned = scene.with_variant("detuned").run()
    assert np.max(np.abs(detuned["plant.slider.u"])) < 1.5 * early


def test_damping_brings_everything_to_rest():
    result = load_scene("active_damping").run()
    for name in ("slider.u", "pendulum.angle", "parabola.x", "parabola.vx"):
        assert abs(result[f"plant.{name}"][-1]) < 1e-3
    assert result["plant.energy.total"][-1] == pytest.approx(-9.81, abs=1e-5)


def test_balance_survives_the_push():
    result = load_scene("inverted_balance").run()
    angle = result["plant.pendulum.angle"] - math.pi
    pushed = (result.time > 5.0) & (result.time < 7.0)
    assert np.max(np.abs(angle[pushed])) > 0.1
    assert abs(angle[-1]) < 1e-3
    assert abs(result["plant.parabola.x"][-1]) < 1e-2


def test_two_wires_part_by_their_errors():
    result = load_scene("two_wires").with_variant("coarse").run()
    apart = np.abs(result["bead_angle.bead.x"] - result["bead_cartesian.bead.x"])
    assert apart[60] < 1e-4
    assert np.max(apart) > 1e-2
    assert result["bead_cartesian.constraint.drift"][-1] < -1e-3  # inward, and growing
    finer = load_scene("two_wires")
    for bead in ("bead_angle", "bead_cartesian"):
        finer.set(f"{bead}.solver.step", 1e-3)
    fine = finer.run()
    assert np.max(np.abs(fine["bead_angle.bead.x"] - fine["bead_cartesian.bead.x"])) < 1e-3


def test_sampling_too_slowly_loses_the_balance():
    scene = load_scene("sampled_feedback")
    angles = {}
    for name in scene.variants:
        result = scene.with_variant(name).run()
        angles[name] = np.max(np.abs(result["plant.pendulum.angle"][-100:] - math.pi))
    assert angles["0.1 s"] < 1e-3
    assert angles["0.2 s"] < 1e-2
    assert angles["0.22 s"] > 1.0


def test_unknown_scenes_and_broken_files(tmp_path):
    with pytest.raises(CurveboundError, match="did you mean swaying_parabola"):
        load_scene("swaying_parabol")
    broken = tmp_path / "broken.py"
    broken.write_text("scene = 1\n")
    with pytest.raises(CurveboundError, match="no variable `scene`"):
        load_scene(broken)
    broken.write_text("raise ValueError('x')\n")
    with pytest.raises(CurveboundError, match="fails to load: ValueError: x"):
        load_scene(broken)


def test_enumerations_by_name_or_number():
    scene = load_scene("bead_on_wire")
    scene.stop_time = 0.1
    by_name = scene.copy().set("bead.model.formulation", "angle").run()
    by_number = scene.copy().set("bead.model.formulation", "2").run()
    assert np.array_equal(by_name.data, by_number.data)
    with pytest.raises(CurveboundError, match="1 lagrange_multiplier, 2 angle"):
        scene.copy().set("bead.model.formulation", "angel").run()


@pytest.mark.parametrize(
    ("arguments", "status", "words"),
    [
        (["run", "pendulum_small", "--stop", "0.2"], 0, "0.2 s simulated"),
        (["run", "nothing"], 1, "There is no scene nothing"),
        (["run", "pendulum_small", "--set", "plant.slider.m=2"], 1, "did you mean"),
        (["run", "pendulum_small", "--set", "nonsense"], 2, "component.variable=value"),
        (["run", "pendulum_small", "--set", "plant.slider.mass=-1"], 1, "slider.mass"),
    ],
)
def test_command_line(arguments, status, words, capsys):
    try:
        found = main(arguments)
    except SystemExit as ended:  # by the parser
        found = ended.code
    said = capsys.readouterr()
    assert found == status, said.err
    assert words in " ".join((said.out + said.err).split())
    assert "Traceback" not in said.err


def test_variants_on_the_command_line(tmp_path):
    words = f"run sampled_feedback --variants --stop 0.5 --out {tmp_path}/s.csv".split()
    assert main(words) == 0
    names = sorted(p.name for p in tmp_path.iterdir())
    assert names == ["s_0.1 s.csv", "s_0.2 s.csv", "s_0.22 s.csv", "s_sampled_feedback.csv"]


@pytest.mark.parametrize("name", ["bead_on_wire", "swaying_parabola"])
def test_what_a_run_costs_is_stated_without_what_it_takes_to_load(name, monkeypatch):
    """Of one FMU as of two: a loader that takes a second changes nothing in the cost of a step."""
    scene = load_scene(name)
    scene.stop_time = 1.0
    load = Library.__init__

    def slow(self, fmu):
        time.sleep(1.0)
        load(self, fmu)

    monkeypatch.setattr(Library, "__init__", slow)
    result = scene.run()
    assert result.wall > 1.0
    assert result.stepping < 0.5
    said = re.sub(r"\s+", " ", summarize(summary(name, result)))
    stated = re.search(r"simulated in (\S+) s, 100 steps, (\S+) us each", said)
    assert stated is not None, said
    assert float(stated[1]) == pytest.approx(result.stepping, rel=0.01)
    assert float(stated[2]) == pytest.approx(result.stepping / 100 * 1e6, rel=0.01)


def test_any_fmu_that_scenes_take_can_be_listed(mass_fmu, capsys):
    assert command_line(["list", str(mass_fmu)]) == 0
    said = capsys.readouterr().out
    for word in ("CoupledMass", "x_start", "other"):
        assert word in said
    assert command_line(["list", str(mass_fmu.with_name("absent.fmu"))]) == 1
    assert "There is no FMU at" in capsys.readouterr().err

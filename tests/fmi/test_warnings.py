"""Warnings while running, through the FMI logger: once each, and only where there is a reason."""

from __future__ import annotations

from typing import Any

import pytest

from curvebound.cosim import Scene


def warnings(fmu: str, start: dict[str, Any], stop: float, step: float) -> list[str]:
    scene = Scene("warned", stop_time=stop, step=step)
    scene.add("plant", fmu, start)
    scene.record("plant.energy.residual")
    return [note for note in scene.run().notes if note.startswith("plant: ")]


def test_an_energy_that_is_not_kept_is_told_once_with_the_step_to_try() -> None:
    start = {"model.formulation": "angle", "solver.method": "explicit_euler", "solver.step": 1e-2}
    (note,) = warnings("BeadOnWire", start, 10.0, 0.1)
    assert "energy.residual" in note
    assert "the integration is inaccurate; try solver.step" in note
    better = float(note.partition("solver.step = ")[2].split()[0])
    assert not warnings("BeadOnWire", {**start, "solver.step": better}, 10.0, 0.1)


def test_a_small_swing_is_judged_by_the_energy_that_moves_in_it() -> None:
    """0.5 mJ of a bead that hangs at -9.81 J."""
    start = {
        "model.formulation": "angle", "solver.method": "explicit_euler", "solver.step": 1e-2,
        "bead.angle_start": 0.01,
    }  # fmt: skip
    (note,) = warnings("BeadOnWire", start, 10.0, 0.1)
    assert "energy.residual" in note


def test_a_drift_off_the_wire_is_told_once_with_what_holds_it() -> None:
    start = {"constraint.stabilization": "none", "solver.step": 2e-2, "solver.method": "rk4"}
    notes = warnings("BeadOnWire", start, 60.0, 0.1)
    assert sum("constraint.drift" in note for note in notes) == 1
    assert any("constraint.stabilization = 3 (projection)" in note for note in notes)


def test_a_linear_model_beyond_its_range_is_told_once() -> None:
    start = {"model.fidelity": "linear", "pendulum.angle_start": 1.5}
    notes = warnings("ParabolaPendulum", start, 20.0, 0.1)
    assert sum("beyond its range" in note for note in notes) == 1


@pytest.mark.parametrize("step", [1.0, pytest.param(10.0, marks=pytest.mark.slow)])
@pytest.mark.parametrize("method", ["rk4", "adaptive", "implicit"])
@pytest.mark.parametrize("form", ["angle", "lagrange_multiplier"])
def test_a_bead_that_damping_stopped_is_no_reason(form: str, method: str, step: float) -> None:
    """All energy moves before the first look, and counts still: rounding is little beside it."""
    start = {"bead.damping": 5.0, "model.formulation": form, "solver.method": method}
    assert not warnings("BeadOnWire", start, 70 * step, step)


COARSE = {"solver.method": "rk4", "solver.step": 0.25}
#: of the bead from the horizontal at the defaults, s
PERIOD = 2.36784194757624


@pytest.mark.parametrize("step", [0.5, 1.0, 3.0, 5.0, 15.0])
def test_an_energy_that_is_not_kept_is_told_however_the_run_is_cut(step: float) -> None:
    (note,) = warnings("ParabolaPendulum", COARSE, 15.0, step)
    assert "energy.residual" in note


@pytest.mark.parametrize("step", [0.1, 7.0, 60.0])
def test_drift_is_told_however_the_run_is_cut(step: float) -> None:
    start = {"constraint.stabilization": "none", "solver.step": 2e-2, "solver.method": "rk4"}
    notes = warnings("BeadOnWire", start, 60.0, step)
    assert sum("constraint.drift" in note for note in notes) == 1


@pytest.mark.parametrize("step", [0.1, 1.0, 20.0])
def test_a_start_beyond_the_linear_range_is_told_however_the_run_is_cut(step: float) -> None:
    start = {"model.fidelity": "linear", "solver.method": "exact", "pendulum.angle_start": 1.5}
    (note,) = warnings("ParabolaPendulum", start, 20.0, step)
    assert "beyond its range" in note


@pytest.mark.parametrize("method", ["rk4", "adaptive", "implicit"])
@pytest.mark.parametrize("form", ["angle", "lagrange_multiplier"])
@pytest.mark.parametrize("periods", [0.5, 1.0, 2.0])
def test_communication_points_where_nothing_moves_are_no_reason(
    periods: float, form: str, method: str
) -> None:
    """At each of them the bead is at rest, at one height: what moves is between them."""
    start = {"model.formulation": form, "solver.method": method}
    assert not warnings("BeadOnWire", start, 40.0 * PERIOD, periods * PERIOD)


@pytest.mark.parametrize("method", ["rk4", "adaptive", "implicit"])
@pytest.mark.parametrize("angle", [1e-6, 1e-9, 1e-12])
def test_rounding_beside_little_motion_is_no_reason(angle: float, method: str) -> None:
    start = {"solver.method": method, "gravity.y": -1e3, "bead.angle_start": angle}
    assert not warnings("BeadOnWire", start, 100.0, 0.1)


def drive_warnings(start: dict[str, Any], step: float) -> list[str]:
    scene = Scene("warned", stop_time=20 * step, step=step).add("drive", "ParabolaDrive", start)
    notes = scene.record("drive.parabola.ax").run().notes
    return [note for note in notes if note.startswith("drive: ")]


@pytest.mark.parametrize(
    ("period", "step", "fits"),
    [(0.02, 0.015, 0.01), (0.02, 0.05, 0.02), (0.05, 0.02, 0.05 / 3.0), (0.1, 0.07, 0.05)],
)
def test_samples_within_a_communication_step_are_told_with_the_step_that_fits(
    period: float, step: float, fits: float
) -> None:
    start = {"feedback.slider_u": 1.0, "sample.period": period}
    (note,) = drive_warnings(start, step)
    assert "sample.period" in note
    advised = float(note.partition("communication steps of ")[2].split()[0])
    assert advised == pytest.approx(fits)
    assert not drive_warnings(start, advised)


@pytest.mark.parametrize(("period", "step"), [(0.02, 0.02), (0.1, 1 / 30), (1 / 3, 1 / 30)])
def test_samples_at_communication_points_are_no_reason(period: float, step: float) -> None:
    assert not drive_warnings({"feedback.slider_u": 1.0, "sample.period": period}, step)


def test_a_drive_that_does_nothing_samples_nothing_late() -> None:
    assert not drive_warnings({"sample.period": 0.02}, 0.015)


def test_a_step_of_the_waveform_within_a_communication_step_is_told() -> None:
    start = {"waveform.kind": "step", "waveform.start_time": 0.5}
    (note,) = drive_warnings(start, 0.3)
    assert "end a communication step at 0.5 s" in note
    assert not drive_warnings(start, 0.25)


@pytest.mark.parametrize("kind", ["sine", "chirp"])
def test_a_waveform_faster_than_its_values_are_held_is_told(kind: str) -> None:
    start = {"waveform.kind": kind, "waveform.frequency": 3.0, "waveform.end_frequency": 8.0}
    (note,) = drive_warnings(start, 0.15 if kind == "chirp" else 0.2)
    assert "above half the rate" in note
    assert not drive_warnings(start, 0.01)

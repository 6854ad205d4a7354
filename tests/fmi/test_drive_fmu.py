"""The ParabolaDrive FMU: feedback, waveforms, limit, sampling and tunable parameters."""

from __future__ import annotations

import math

import pytest
from harness import ERROR, Instance

MEASUREMENTS = {
    "slider.u": 0.3,
    "slider.u_rate": -1.2,
    "pendulum.angle": 0.7,
    "pendulum.angular_velocity": 2.1,
    "parabola.x": -0.4,
    "parabola.vx": 0.9,
}
GAINS = {
    "feedback.slider_u": 1.5,
    "feedback.slider_u_rate": -0.3,
    "feedback.pendulum_angle": 4.0,
    "feedback.pendulum_angular_velocity": 0.25,
    "feedback.parabola_x": -2.0,
    "feedback.parabola_vx": 0.8,
}
REFERENCES = {"reference.pendulum_angle": 0.2, "reference.parabola_x": 0.1}
OUTPUTS = ("parabola.ax", "parabola.ay", "parabola.coefficient_acceleration")


def feedback(measured: dict[str, float], **gains: float) -> float:
    """-K (measurement - reference)."""
    reference = {
        "pendulum.angle": REFERENCES["reference.pendulum_angle"],
        "parabola.x": REFERENCES["reference.parabola_x"],
    }
    return -sum(
        gain * (measured[name] - reference.get(name, 0.0))
        for name, gain in zip(MEASUREMENTS, {**GAINS, **gains}.values(), strict=True)
    )


def test_feedback_follows_the_inputs_directly(start) -> None:
    drive = start("ParabolaDrive", {**GAINS, **REFERENCES})
    assert drive["parabola.ax"] == pytest.approx(feedback(dict.fromkeys(MEASUREMENTS, 0.0)))
    drive.set(MEASUREMENTS)
    assert drive.get(*OUTPUTS) == pytest.approx([feedback(MEASUREMENTS), 0.0, 0.0], rel=1e-14)
    drive.step(0.1)
    drive.set({"slider.u": 1.0})
    expected = feedback({**MEASUREMENTS, "slider.u": 1.0})
    assert drive["parabola.ax"] == pytest.approx(expected, rel=1e-14)


def test_inputs_count_in_initialization_mode(instantiate) -> None:
    drive = instantiate("ParabolaDrive")
    drive.slave.setupExperiment()
    drive.set({**GAINS, **REFERENCES})
    drive.slave.enterInitializationMode()
    drive.set(MEASUREMENTS)
    assert drive["parabola.ax"] == pytest.approx(feedback(MEASUREMENTS), rel=1e-14)
    drive.slave.exitInitializationMode()
    assert drive["parabola.ax"] == pytest.approx(feedback(MEASUREMENTS), rel=1e-14)


@pytest.mark.parametrize("limit", [0.0, 0.5, 3.0])
def test_limit(start, limit: float) -> None:
    drive = start(
        "ParabolaDrive",
        {"feedback.slider_u": 1.0, "limit.acceleration": limit, "waveform.kind": "step"},
    )
    for u in (-10.0, -1.2, 0.0, 1.0, 10.0):
        drive.set({"slider.u": u})
        assert drive["parabola.ax"] == pytest.approx(max(-limit, min(limit, 1.0 - u)))


def waveform(kind: str, time: float) -> float:
    """Amplitude 2, from 0.5 s on, 1.5 Hz, phase 0.4, chirp to 6 Hz in 2 s."""
    t = time - 0.5
    if kind == "none" or t < 0.0:
        return 0.0
    if kind == "step":
        return 2.0
    if kind == "sine":
        return 2.0 * math.sin(2.0 * math.pi * 1.5 * t + 0.4)
    if t < 2.0:
        cycles = 1.5 * t + (6.0 - 1.5) * t * t / (2.0 * 2.0)
    else:
        cycles = (1.5 + 6.0) / 2.0 * 2.0 + 6.0 * (t - 2.0)
    return 2.0 * math.sin(2.0 * math.pi * cycles + 0.4)


WAVEFORM = {
    "waveform.amplitude": 2.0,
    "waveform.frequency": 1.5,
    "waveform.phase": 0.4,
    "waveform.start_time": 0.5,
    "waveform.end_frequency": 6.0,
    "waveform.duration": 2.0,
}


@pytest.mark.parametrize("axis", ["x", "y", "coefficient"])
@pytest.mark.parametrize("kind", ["none", "sine", "chirp", "step"])
def test_waveform(start, kind: str, axis: str) -> None:
    drive = start("ParabolaDrive", {**WAVEFORM, "waveform.kind": kind, "waveform.axis": axis})
    for i in range(160):
        # of the start of the interval over which it is held
        expected = [0.0, 0.0, 0.0]
        expected[["x", "y", "coefficient"].index(axis)] = waveform(kind, i * 0.025)
        assert drive.get(*OUTPUTS) == pytest.approx(expected, abs=1e-13)
        drive.run(1, 0.025)
        drive.time = (i + 1) * 0.025


@pytest.mark.parametrize("size", [0.1, 0.05, 1.0 / 60.0, 0.03, 0.25])
@pytest.mark.parametrize("summed", [True, False], ids=["summed", "multiples"])
def test_sampled_at_multiples_of_the_period(start, size: float, summed: bool) -> None:
    period = 0.1
    drive = start("ParabolaDrive", {"feedback.slider_u": -1.0, "sample.period": period})
    time = 0.0
    held = 0.0
    for i in range(120):
        measured = math.sin(1.0 + i)
        drive.set({"slider.u": measured})
        nearest = round(time / period) * period
        if abs(time - nearest) < 1e-9:
            held = measured
        assert drive["parabola.ax"] == held, (i, time)
        end = time + size if summed else (i + 1) * size
        drive.time = time
        drive.step(end - time)
        # a sample inside the step takes the inputs that are held over it
        if math.floor((end - 1e-9) / period) > math.floor((time + 1e-9) / period):
            held = measured
        time = end


def test_sampling_survives_times_that_are_added_up(start) -> None:
    drive = start("ParabolaDrive", {"feedback.slider_u": -1.0, "sample.period": 0.1})
    for i in range(30000):
        drive.step(0.1)
        if i % 100 == 0:
            drive.set({"slider.u": float(i)})
            assert drive["parabola.ax"] == i
    # added up they miss the multiple by far more than its last digit
    assert abs(drive.time - 3000.0) > 1e-12 * 3000.0 / 10


def test_sampling_counts_from_zero_whatever_the_start(start) -> None:
    drive = start(
        "ParabolaDrive", {"feedback.slider_u": -1.0, "sample.period": 0.1}, start_time=5.05
    )
    drive.set({"slider.u": 1.0})
    # the start counts as a sample
    assert drive["parabola.ax"] == 1.0
    drive.step(0.02)
    drive.set({"slider.u": 2.0})
    assert drive["parabola.ax"] == 1.0
    drive.step(0.03)
    assert drive["parabola.ax"] == 2.0
    drive.set({"slider.u": 3.0})
    assert drive["parabola.ax"] == 3.0
    drive.step(0.01)
    drive.set({"slider.u": 4.0})
    assert drive["parabola.ax"] == 3.0


def test_tunable_parameters_take_effect_at_the_communication_point(start) -> None:
    drive = start("ParabolaDrive", {**GAINS, **REFERENCES})
    drive.set(MEASUREMENTS)
    drive.step(0.1)
    drive.set({"feedback.slider_u": 7.0})
    assert drive["parabola.ax"] == pytest.approx(
        feedback(MEASUREMENTS, **{"feedback.slider_u": 7.0}), rel=1e-14
    )
    drive.set({"waveform.kind": "step", "waveform.axis": "y", "waveform.amplitude": 3.0})
    assert drive["parabola.ay"] == 3.0
    drive.set({"waveform.start_time": 1.0})
    assert drive["parabola.ay"] == 0.0
    drive.step(0.1)
    drive.set({"limit.acceleration": 0.25})
    assert abs(drive["parabola.ax"]) == 0.25
    assert drive.errors == []


def test_tunable_parameters_take_effect_at_the_next_sample(start) -> None:
    drive = start("ParabolaDrive", {"feedback.slider_u": -1.0, "sample.period": 0.1})
    drive.set({"slider.u": 1.0})
    drive.step(0.05)
    drive.set({"feedback.slider_u": -5.0})
    assert drive["parabola.ax"] == 1.0
    drive.step(0.04)
    assert drive["parabola.ax"] == 1.0
    drive.step(0.01)
    assert drive["parabola.ax"] == 5.0


def test_a_step_over_several_samples_uses_the_last(start) -> None:
    drive = start(
        "ParabolaDrive",
        {**WAVEFORM, "waveform.kind": "sine", "waveform.start_time": 0.0, "sample.period": 0.1},
    )
    drive.step(0.55)
    expected = 2.0 * math.sin(2.0 * math.pi * 1.5 * 0.5 + 0.4)
    assert drive["parabola.ax"] == pytest.approx(expected, rel=1e-12)


def test_sample_period_is_fixed(start) -> None:
    drive = start("ParabolaDrive", {"sample.period": 0.1})
    variable = drive.fmu.variables["sample.period"]
    status = drive.status("setReal", [variable.valueReference], [0.2])
    assert status == ERROR or not drive.fmu.forwarded
    assert len(drive.errors) == 1
    assert drive["sample.period"] == 0.1


def test_drive_and_plant_by_hand(start) -> None:
    """Fed back without delay, the drive first: the frame moves by what the law says."""
    gains = {"feedback.parabola_x": 4.0, "feedback.parabola_vx": 4.0, "feedback.slider_u": 1.0}
    drive: Instance = start("ParabolaDrive", gains)
    plant: Instance = start("ParabolaPendulum")
    x = vx = 0.0
    for _ in range(500):
        u, px, pvx = plant.get("slider.u", "parabola.x", "parabola.vx")
        assert (px, pvx) == pytest.approx((x, vx), rel=1e-12, abs=1e-14)
        drive.set({"slider.u": u, "parabola.x": px, "parabola.vx": pvx})
        ax = drive["parabola.ax"]
        assert ax == pytest.approx(-(4.0 * px + 4.0 * pvx + u), rel=1e-13, abs=1e-14)
        plant.set({"parabola.ax": ax})
        plant.step(0.01)
        drive.step(0.01)
        x += 0.01 * vx + 0.5 * 0.01 * 0.01 * ax
        vx += 0.01 * ax
    assert abs(plant["energy.residual"]) < 1e-8

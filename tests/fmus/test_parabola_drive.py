"""The drive: feedback, waveforms, limit, sampling."""

from __future__ import annotations

import math
from typing import Any

import mpmath
import numpy as np
import pytest

from curvebound.fmi.folder import find
from curvebound.kernel.base import MOST_INPUTS

ParabolaDrive = find("ParabolaDrive").module("kernel").ParabolaDrive

DEFAULTS = {
    "feedback.slider_u": 0.0,
    "feedback.slider_u_rate": 0.0,
    "feedback.pendulum_angle": 0.0,
    "feedback.pendulum_angular_velocity": 0.0,
    "feedback.parabola_x": 0.0,
    "feedback.parabola_vx": 0.0,
    "reference.pendulum_angle": 0.0,
    "reference.parabola_x": 0.0,
    "waveform.amplitude": 1.0,
    "waveform.frequency": 1.0,
    "waveform.phase": 0.0,
    "waveform.start_time": 0.0,
    "waveform.end_frequency": 10.0,
    "waveform.duration": 10.0,
    "limit.acceleration": 1e6,
    "sample.period": 0.0,
}
NONE, SINE, CHIRP, STEP = 1, 2, 3, 4
HELD = [0.0] * MOST_INPUTS


def drive(kind: int = NONE, axis: int = 1, time: float = 0.0, **changed: float) -> ParabolaDrive:
    law = ParabolaDrive()
    names = {k.replace(".", "_"): k for k in DEFAULTS}
    parameters = {**DEFAULTS, **{names[k]: v for k, v in changed.items()}}
    law.start(parameters, {"waveform.kind": kind, "waveform.axis": axis}, time)
    return law


def read(law: ParabolaDrive) -> tuple[float, float, float]:
    values = [math.nan] * 5
    law.observe(0, values, 1)
    assert all(map(math.isnan, values[2:]))
    law.observe(1, values, 1)
    assert math.isnan(values[0])
    assert math.isnan(values[4])
    return values[1], values[2], values[3]


def rates(law: ParabolaDrive, slopes: list[float]) -> list[float]:
    values = [math.nan] * 3
    for group in (0, 1):
        law.find_rates(group, slopes, values, 0)
    return values


def measure(law: ParabolaDrive, u: float) -> None:
    """Measured slider.u, the rest zero."""
    law.set_inputs([99.0, u, 0.0, 0.0, 0.0, 0.0, 0.0], 1)


def test_declarations() -> None:
    assert set(DEFAULTS) == set(ParabolaDrive.PARAMETERS)
    assert ParabolaDrive.CHOICES == ("waveform.kind", "waveform.axis")
    # the feedback alone looks at the inputs
    assert ParabolaDrive.FEEDTHROUGH == (0,)
    assert [n for n, group in ParabolaDrive.OUTPUTS.items() if group == 0] == ["parabola.ax"]


def test_feedback_law() -> None:
    law = drive(
        feedback_slider_u=2.0,
        feedback_slider_u_rate=3.0,
        feedback_pendulum_angle=5.0,
        feedback_pendulum_angular_velocity=7.0,
        feedback_parabola_x=11.0,
        feedback_parabola_vx=13.0,
        reference_pendulum_angle=0.5,
        reference_parabola_x=-0.25,
    )
    law.set_inputs([0.1, 0.2, 0.3, 0.4, 0.5, 0.6], 0)
    expected = -(0.2 + 0.6 + 5.0 * (0.3 - 0.5) + 2.8 + 11.0 * (0.5 + 0.25) + 7.8)
    assert read(law) == (pytest.approx(expected, rel=1e-15), 0.0, 0.0)


@pytest.mark.parametrize("axis", [1, 2, 3])
def test_waveform_goes_to_its_axis(axis: int) -> None:
    law = drive(STEP, axis, waveform_amplitude=-3.0, feedback_slider_u=1.0)
    measure(law, 2.0)
    expected = [-2.0, 0.0, 0.0]
    expected[axis - 1] += -3.0
    assert read(law) == tuple(expected)


def test_no_waveform() -> None:
    assert read(drive(NONE, waveform_amplitude=5.0)) == (0.0, 0.0, 0.0)


def wave(law: ParabolaDrive, time: float) -> float:
    """The output after stepping to `time`."""
    if time > law.time:
        law.advance(law.time, time - law.time, HELD)
    return read(law)[0]


def test_sine() -> None:
    law = drive(SINE, waveform_amplitude=2.0, waveform_frequency=0.7, waveform_phase=0.4)
    for i in range(50):
        t = 0.13 * i
        expected = 2.0 * math.sin(2.0 * math.pi * 0.7 * t + 0.4)
        assert wave(law, t) == pytest.approx(expected, abs=1e-13)


def test_sine_keeps_its_precision_at_late_times() -> None:
    law = drive(SINE, waveform_frequency=128.0, time=1e6)
    law.advance(1e6, 2.0**-10, HELD)
    with mpmath.workdps(40):
        true = mpmath.sin(2 * mpmath.pi * 128 * mpmath.mpf(law.time))
    assert read(law)[0] == pytest.approx(float(true), abs=1e-15)


@pytest.mark.parametrize("kind", [SINE, CHIRP, STEP])
def test_zero_before_start(kind: int) -> None:
    law = drive(kind, waveform_start_time=0.3, waveform_phase=1.0, waveform_amplitude=2.0)
    begun = 2.0 if kind == STEP else 2.0 * math.sin(1.0)
    for _ in range(2):
        assert read(law)[0] == 0.0
        law.advance(law.time, 0.1, HELD)
    law.advance(0.2, 0.09, HELD)
    assert read(law)[0] == 0.0
    # 0.1 + 0.2, added up, is not 0.3; nor is 3 times 0.1
    for time in (0.3, 0.1 + 0.2, 0.29999999999999993):
        law.time = time
        assert read(law)[0] == pytest.approx(begun, rel=1e-12)


def test_chirp_is_linear_in_frequency_and_goes_on() -> None:
    law = drive(
        CHIRP,
        waveform_frequency=0.5,
        waveform_end_frequency=3.0,
        waveform_duration=4.0,
        waveform_start_time=1.0,
        waveform_phase=0.2,
    )

    def cycles(elapsed: float) -> Any:
        ends = [0, min(elapsed, 4), elapsed]
        return mpmath.quad(lambda t: 0.5 + 2.5 * min(t / 4, mpmath.mpf(1)), ends)

    for i in range(60):
        t = 1.0 + 0.1 * i
        expected = mpmath.sin(2 * mpmath.pi * cycles(0.1 * i) + mpmath.mpf(0.2))
        assert wave(law, t) == pytest.approx(float(expected), abs=1e-12)


def test_chirp_of_no_duration_is_a_sine() -> None:
    law = drive(CHIRP, waveform_duration=0.0, waveform_end_frequency=2.0)
    assert wave(law, 0.1) == pytest.approx(math.sin(0.4 * math.pi))


def test_limit_acts_on_the_sum_along_x_alone() -> None:
    law = drive(STEP, feedback_slider_u=1.0, limit_acceleration=1.5)
    for u, expected in ((0.0, 1.0), (-1.0, 1.5), (2.0, -1.0), (4.0, -1.5)):
        measure(law, u)
        assert read(law)[0] == expected
    for axis in (2, 3):
        law = drive(STEP, axis, waveform_amplitude=9.0, limit_acceleration=1.5)
        assert read(law)[axis - 1] == 9.0


def test_products_beyond_the_floats_are_limited_not_nan() -> None:
    law = drive(feedback_slider_u=1e300, feedback_slider_u_rate=1e300, limit_acceleration=10.0)
    for u, rate, expected in ((1e300, -1e299, -10.0), (1e299, -1e300, 10.0), (1.0, 0.0, -10.0)):
        law.set_inputs([u, rate, 0.0, 0.0, 0.0, 0.0], 0)
        assert read(law)[0] == expected
    law = drive(SINE, waveform_frequency=1e308, waveform_phase=1.0)
    assert wave(law, 1e3) == math.sin(1.0)


def test_without_period_outputs_follow_directly() -> None:
    law = drive(feedback_slider_u=1.0)
    for u in (0.5, -0.25, 3.0):
        measure(law, u)
        assert read(law)[0] == -u
        law.advance(law.time, 0.37, HELD)
        assert read(law)[0] == -u


def test_samples_are_held_between_multiples() -> None:
    law = drive(feedback_slider_u=1.0, sample_period=0.1)
    held = None
    for i in range(101):
        measure(law, float(i + 1))
        sampled = i % 10 == 0
        if sampled:
            held = -float(i + 1)
        assert read(law)[0] == held, i
        law.advance(i * 0.01, 0.01, HELD)


def test_a_sample_feeds_through_until_the_step_leaves_it() -> None:
    law = drive(feedback_slider_u=1.0, sample_period=0.1)
    for u in (1.0, 2.0):
        measure(law, u)
        assert read(law)[0] == -u
    law.advance(0.0, 0.03, HELD)
    measure(law, 9.0)
    assert read(law)[0] == -2.0
    law.advance(0.03, 0.03, HELD)
    assert read(law)[0] == -2.0


def test_multiples_inside_a_step_sample_the_held_inputs_at_their_time() -> None:
    law = drive(
        SINE,
        feedback_slider_u=1.0,
        sample_period=0.1,
        waveform_frequency=0.5,
        waveform_amplitude=2.0,
    )
    measure(law, 1.0)
    law.advance(0.0, 0.05, HELD)
    measure(law, 5.0)
    # 0.1, 0.2 and 0.3 are inside; the last one counts
    law.advance(0.05, 0.3, HELD)
    measure(law, 7.0)
    expected = -5.0 + 2.0 * math.sin(2.0 * math.pi * 0.5 * 0.3)
    assert read(law)[0] == pytest.approx(expected, rel=1e-14)


def test_end_of_a_step_on_a_multiple_is_sampled_by_the_next_one() -> None:
    law = drive(feedback_slider_u=1.0, sample_period=0.1)
    measure(law, 1.0)
    law.advance(0.0, 0.1, HELD)
    measure(law, 3.0)
    assert read(law)[0] == -3.0
    law.advance(0.1, 0.05, HELD)
    assert read(law)[0] == -3.0


@pytest.mark.parametrize(
    ("step", "period", "origin"),
    [
        (1.0 / 60.0, 0.1, 0.0),
        (1.0 / 60.0, 0.1, 1e5),
        (0.001, 0.007, 0.0),
        (0.001, 0.01, -3.0),
        (0.1, 0.3, 0.0),
    ],
)
def test_added_up_time_samples_as_often_as_exact_time(
    step: float, period: float, origin: float
) -> None:
    every = round(period / step)
    law = drive(feedback_slider_u=1.0, sample_period=period, time=origin)
    time = origin
    held = None
    for i in range(5000):
        measure(law, float(i))
        if i % every == 0:
            held = -float(i)
        assert read(law)[0] == held, (i, time)
        law.advance(time, step, HELD)
        time += step


def test_start_between_multiples_counts_as_a_sample() -> None:
    law = drive(feedback_slider_u=1.0, sample_period=0.1, time=0.05)
    measure(law, 2.0)
    assert read(law)[0] == -2.0
    law.advance(0.05, 0.02, HELD)
    measure(law, 3.0)
    assert read(law)[0] == -2.0
    law.advance(0.07, 0.03, HELD)
    assert read(law)[0] == -3.0


def test_period_below_the_resolution_of_time_follows_directly() -> None:
    law = drive(feedback_slider_u=1.0, sample_period=1e-300, time=1e3)
    measure(law, 2.0)
    law.advance(1e3, 0.1, HELD)
    assert read(law)[0] == -2.0


def test_tunable_parameters_take_effect_at_the_next_point_or_sample() -> None:
    choices = {"waveform.kind": STEP, "waveform.axis": 2}
    direct = drive(feedback_slider_u=1.0)
    sampled = drive(feedback_slider_u=1.0, sample_period=0.1)
    for law in (direct, sampled):
        measure(law, 1.0)
        law.advance(0.0, 0.05, HELD)
        law.set_parameters({**DEFAULTS, "feedback.slider_u": 4.0}, choices)
    assert read(direct) == (-4.0, 1.0, 0.0)
    assert read(sampled) == (-1.0, 0.0, 0.0)
    sampled.advance(0.05, 0.05, HELD)
    assert read(sampled) == (-4.0, 1.0, 0.0)


def test_state_and_rollback() -> None:
    law = drive(SINE, feedback_slider_u=1.0, sample_period=0.1)
    measure(law, 1.0)
    assert law.get_state()[4] == 1.0
    law.advance(0.0, 0.13, HELD)
    saved, out = law.get_state(), read(law)
    law.keep()
    law.advance(0.13, 0.4, HELD)
    assert read(law) != out
    after = law.get_state()
    law.undo()
    assert law.get_state() == saved
    assert read(law) == out
    other = drive(SINE, feedback_slider_u=1.0, sample_period=0.1)
    measure(other, 1.0)
    other.set_state(saved)
    assert read(other) == out
    other.advance(0.13, 0.4, HELD)
    assert other.get_state() == after
    with pytest.raises(ValueError, match="saved state has 2 numbers where 5 belong"):
        law.set_state([0.0, 1.0])


def test_long_times_sample_at_multiples_not_sums() -> None:
    law = drive(SINE, sample_period=1e-3, waveform_frequency=0.25, time=1e6)
    for i in range(1000):
        law.advance(1e6 + i * 2.5e-4, 2.5e-4, HELD)
    # held since 1e6 + 0.249, or sampled at 1e6 + 0.25, which the point now is
    assert read(law)[0] == pytest.approx(math.sin(math.pi / 8.0), abs=1e-9)


def test_time_rounds_coarser_than_the_period_is_fine() -> None:
    origin, period = 1e6, 2e-5
    law = drive(feedback_slider_u=1.0, sample_period=period, time=origin)
    for i in range(200):
        measure(law, float(i))
        assert read(law)[0] == -float(i - i % 2)
        law.advance(origin + i * 1e-5, 1e-5, HELD)


@pytest.mark.parametrize("axis", [1, 2, 3])
@pytest.mark.parametrize("kind", [NONE, SINE, CHIRP, STEP])
def test_references_follow_the_same_law(kind: int, axis: int) -> None:
    """Before, within and after a chirp, limited at times."""
    sizes = {"amplitude": 3.0, "frequency": 0.7, "phase": 0.4, "start_time": 0.5,
             "end_frequency": 2.1, "duration": 1.2}  # fmt: skip
    own = {f"waveform_{name}": size for name, size in sizes.items()}
    own |= {"feedback_slider_u": 1.5, "feedback_pendulum_angle": -0.8, "limit_acceleration": 2.5,
            "feedback_parabola_vx": 0.3, "reference_pendulum_angle": 0.2,
            "reference_parabola_x": 9.0}  # fmt: skip
    measured = [0.4, 5.0, -0.6, 7.0, 8.0, 0.9]
    module = find("ParabolaDrive").module("reference")
    names = {k.replace(".", "_"): k for k in DEFAULTS}
    parameters: dict[str, Any] = {**DEFAULTS, **{names[k]: v for k, v in own.items()}}
    parameters |= {
        "waveform.kind": ("none", "sine", "chirp", "step")[kind - 1],
        "waveform.axis": ("x", "y", "coefficient")[axis - 1],
    }
    law = module.Law(parameters)
    times = np.array([0.0, 0.49, 0.5, 0.8, 1.1, 1.69, 1.71, 2.5], dtype=np.longdouble)
    outputs = ("parabola.ax", "parabola.ay", "parabola.coefficient_acceleration")
    found = law.outputs(outputs, times, [], dict(zip(module._MEASURED, measured, strict=True)))
    for k, time in enumerate(times):
        kernel = drive(kind, axis, float(time), **own)
        kernel.set_inputs([0.0, *measured], 1)
        here = [float(np.broadcast_to(found[name], times.shape)[k]) for name in outputs]
        assert here == pytest.approx(read(kernel), rel=1e-13, abs=1e-13)
    assert law.breaks() == {NONE: [], CHIRP: [0.5, 1.7]}.get(kind, [0.5])
    assert law.set_points() == {name: {"pendulum.angle": 0.2, "parabola.x": 9.0}.get(name, 0.0)
                                for name in module._MEASURED}  # fmt: skip
    assert module.Law({**DEFAULTS, "waveform.kind": "none"}).set_points() == {}


@pytest.mark.parametrize("axis", [1, 2, 3])
@pytest.mark.parametrize("kind", [NONE, SINE, CHIRP, STEP])
def test_rates_are_those_of_the_law(kind: int, axis: int) -> None:
    """Against differences of the outputs, inputs rising, before and in the waveform."""
    gains = {
        "feedback_slider_u": 2.0,
        "feedback_slider_u_rate": -3.0,
        "feedback_pendulum_angle": 5.0,
        "feedback_pendulum_angular_velocity": 7.0,
        "feedback_parabola_x": -11.0,
        "feedback_parabola_vx": 13.0,
    }
    wave = {"waveform_frequency": 0.7, "waveform_phase": 0.3, "waveform_amplitude": 1.7}
    slopes = [0.1, 0.2, -0.3, 0.4, 0.5, -0.6, *HELD[6:]]
    for time in (0.2, 0.9, 3.0):
        outputs = []
        law = drive(kind, axis, **gains, **wave, waveform_start_time=0.5, waveform_duration=2.0)
        for h in (-1e-5, 1e-5):
            law.set_inputs([1.0 + slope * h for slope in slopes[:6]], 0)
            law.time = time + h
            outputs.append(read(law))
        law.time = time
        assert rates(law, slopes) == pytest.approx(
            (np.subtract(*outputs[::-1]) / 2e-5).tolist(), abs=1e-7
        )


def test_rates_at_the_limit_at_the_start_and_between_samples() -> None:
    rising = [1.0, *HELD[1:]]
    law = drive(SINE, feedback_slider_u=-3.0, limit_acceleration=2.0, waveform_amplitude=0.5)
    measure(law, 0.0)
    assert rates(law, rising)[0] == pytest.approx(3.0 + math.pi, rel=1e-15)
    measure(law, 1.0)
    assert rates(law, rising) == [0.0, 0.0, 0.0]
    # of a step nothing is seen but that it is over, also where rounding puts time before it
    late = drive(SINE, axis=2, waveform_start_time=0.3, time=0.3 * (1 - 1e-15))
    assert rates(late, HELD)[1] == pytest.approx(2.0 * math.pi, rel=1e-15)
    sampled = drive(SINE, feedback_slider_u=-3.0, sample_period=0.1)
    assert rates(sampled, rising) == [0.0, 0.0, 0.0]


def test_a_sample_within_a_step_measures_what_has_risen() -> None:
    law = drive(sample_period=0.02, feedback_slider_u=-1.0, feedback_parabola_vx=-10.0)
    law.set_inputs([0.5, 0.0, 0.0, 0.0, 0.0, 0.25], 0)
    law.advance(0.0, 0.05, [1.0, 0.0, 0.0, 0.0, 0.0, 2.0, *HELD[6:]])
    assert read(law)[0] == pytest.approx(0.54 + 10.0 * (0.25 + 0.08), rel=1e-15)


@pytest.mark.parametrize(
    ("kind", "elapsed", "expected"),
    [
        (SINE, -1e-9, 0.0), (SINE, 0.0, 2.0), (SINE, 50.0, 2.0), (CHIRP, -1e-9, 0.0),
        (CHIRP, 0.0, 2.0), (CHIRP, 5.0, 6.0), (STEP, 1.0, 0.0), (NONE, 1.0, 0.0),
    ],
)  # fmt: skip
def test_present_frequency(kind: int, elapsed: float, expected: float) -> None:
    law = drive(kind, waveform_frequency=2.0, waveform_end_frequency=10.0)
    assert law.present_frequency(elapsed) == pytest.approx(expected, rel=1e-15)


@pytest.mark.parametrize(
    ("kind", "time", "duration", "changed", "expected"),
    [
        (STEP, 0.0, 0.1, {"waveform_start_time": 0.05}, "waveform.start_time"),
        (STEP, 0.0, 0.1, {"waveform_start_time": 0.1}, ""),
        (STEP, 0.05, 0.1, {"waveform_start_time": 0.05}, ""),
        (STEP, 0.1, 0.1, {"waveform_start_time": 0.05}, ""),
        (STEP, 0.0, 0.04, {"waveform_start_time": 0.05}, ""),
        (SINE, 0.0, 0.1, {"waveform_start_time": 0.05}, ""),
        (SINE, 0.0, 0.5, {}, ""),
        (SINE, 0.0, 0.51, {}, "the waveform's frequency, 1 Hz"),
        (SINE, 0.0, 0.1, {"sample_period": 0.5}, ""),
        (SINE, 0.0, 0.1, {"sample_period": 0.6}, "the waveform's frequency, 1 Hz"),
        (SINE, 0.0, 0.6, {"waveform_start_time": 1.0}, ""),
        (SINE, 1.0, 0.6, {"waveform_start_time": 1.0}, "the waveform's frequency, 1 Hz"),
        (SINE, 0.0, 0.1, {"waveform_frequency": -6.0}, "the waveform's frequency, 6 Hz"),
        (CHIRP, 9.0, 0.1, {}, "the waveform's frequency, 9.1 Hz"),
        (CHIRP, 4.0, 0.1, {}, ""),
        (SINE, 0.0, 0.1, {"sample_period": 0.15}, ""),
        (SINE, 0.1, 0.1, {"sample_period": 0.15}, "sample.period"),
        (SINE, 0.15, 0.1, {"sample_period": 0.15}, ""),
        (SINE, 0.05, 0.1, {"sample_period": 0.15}, ""),
        (NONE, 0.1, 0.1, {"sample_period": 0.15}, ""),
        (NONE, 0.1, 0.1, {"sample_period": 0.15, "feedback_slider_u": 1.0}, "sample.period"),
    ],
)  # fmt: skip
def test_what_comes_late_is_told(
    kind: int, time: float, duration: float, changed: dict[str, float], expected: str
) -> None:
    said = drive(kind, **changed).late(time, duration)
    assert said.startswith(expected)
    assert bool(said) == bool(expected)


def test_steps_that_fit_are_told() -> None:
    law = drive(SINE, sample_period=0.15)
    assert "has its sample at 0.15 s within a communication step, 0.1 s from 0.1 s" in law.late(
        0.1, 0.1
    )
    assert "communication steps of 0.075 s would" in law.late(0.1, 0.1)
    law = drive(SINE, waveform_frequency=10.0)
    assert "is held, 0.1 s each" not in law.late(0.0, 0.05)
    assert "0.1 s each" in law.late(0.0, 0.1)

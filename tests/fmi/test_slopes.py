"""Inputs linear in time over a communication step, and the rates of outputs."""

from __future__ import annotations

import math
from collections.abc import Callable
from ctypes import c_double

import numpy as np
import pytest
from driven import METHODS, MODELS, constant, inputs_at, slopes_at
from fmpy import simulate_fmu, simulation
from harness import ERROR, OK, Extracted, Instance

Start = Callable[..., Instance]

#: those of the frame, by FMU
PUSHED = {"BeadOnWire": ("wire.ax", "wire.x"), "ParabolaPendulum": ("parabola.ax", "parabola.x")}


@pytest.mark.parametrize("count", [1, 2, 7, 20, 200])
@pytest.mark.parametrize("name", PUSHED)
def test_held_input_rising_with_time(start: Start, name: str, count: int) -> None:
    """a = t for 2 s: 2^3 / 6 m. Held, it comes to 1.2350 m at steps of 0.1 s."""
    ax, x = PUSHED[name]
    ramped, held = start(name), start(name)
    for i in range(count):
        for instance in (ramped, held):
            instance.set({ax: 2.0 * i / count})
        ramped.slope({ax: 1.0})
        for instance in (ramped, held):
            instance.step(2.0 / count)
    assert ramped[x] == pytest.approx(4.0 / 3.0, rel=1e-14)
    assert ramped[ax] == pytest.approx(2.0, rel=1e-15)
    if count == 20:
        assert held[x] == pytest.approx(1.2350, abs=5e-5)


@pytest.mark.parametrize("method", METHODS)
@pytest.mark.parametrize("label", MODELS)
def test_one_step_is_many(start: Start, label: str, method: str) -> None:
    """A step with slopes is the same as parts of it, each with the inputs of its own start."""
    name, parameters = MODELS[label]
    parameters = {**parameters, "solver.method": method, "solver.step": 1e-2}
    whole, cut = start(name, parameters), start(name, parameters)
    first, slopes = inputs_at(name, 0.3), slopes_at(name, 0.3)
    whole.set(first)
    whole.slope(slopes)
    whole.step(0.2)
    for i in range(5):
        cut.set({n: x + i * 0.04 * slopes[n] for n, x in first.items()})
        cut.slope(slopes)
        cut.step(0.04)
    # the steps of adaptive are others
    close = 1e-5 if method == "adaptive" else 1e-11
    skip = ("solver.steps", "solver.evaluations")
    names = [n for n in whole.fmu.outputs if n not in skip]
    assert whole.get(*names) == pytest.approx(cut.get(*names), rel=close, abs=close)
    for n, x in first.items():
        assert whole[n] == x + 0.2 * slopes[n]
    # the slopes were for that step
    whole.step(0.1)
    for n, x in first.items():
        assert whole[n] == x + 0.2 * slopes[n]


@pytest.mark.parametrize("label", ["angle", "projection", "nonlinear"])
def test_residual_tells_of_the_integration_alone(start: Start, label: str) -> None:
    name, parameters = MODELS[label]
    instance = start(name, {**parameters, "solver.method": "rk4", "solver.step": 1e-3})
    for _ in range(50):
        instance.set(inputs_at(name, instance.time))
        instance.slope(slopes_at(name, instance.time))
        instance.step(0.02)
    assert abs(instance["energy.residual"]) < 1e-9


def test_exact_follows_horizontal_slopes_alone(start: Start) -> None:
    parameters = constant(MODELS["linear"][1])
    exact = start("ParabolaPendulum", {**parameters, "solver.method": "exact"})
    other = start("ParabolaPendulum", {**parameters, "solver.method": "rk4"})
    for _ in range(20):
        for instance in (exact, other):
            instance.set(inputs_at("ParabolaPendulum", instance.time, constant=True))
            instance.slope(slopes_at("ParabolaPendulum", instance.time, constant=True))
            instance.step(0.1)
    names = ("slider.u", "pendulum.angle", "slider.u_rate", "pendulum.angular_velocity")
    assert exact.get(*names) == pytest.approx(other.get(*names), abs=1e-10)
    assert abs(exact["energy.residual"]) < 1e-11
    before = exact.bits()
    exact.slope({"pendulum.fy": 2.0, "slider.fx": 1.0})
    assert exact.step_status(exact.time, 0.1) == ERROR
    assert "pendulum.fy with its slope of 2.0 per s" in exact.errors[-1]
    assert "slider.fx" not in exact.errors[-1]
    assert exact.bits() == before


@pytest.mark.parametrize("label", MODELS)
def test_saved_state_has_the_slopes(start: Start, label: str) -> None:
    name, parameters = MODELS[label]
    instance = start(name, parameters)
    instance.set(inputs_at(name, 0.0))
    instance.slope(slopes_at(name, 0.0))
    saved = instance.serialized()
    instance.step(0.1)
    there = instance.bits()
    instance.step(0.1)
    instance.restore(saved, 0.0)
    instance.step(0.1)
    assert instance.bits() == there
    fresh = start(name)
    fresh.restore(saved, 0.0)
    fresh.step(0.1)
    assert fresh.bits() == there


def test_what_is_refused(start: Start) -> None:
    variables = start("BeadOnWire").fmu.variables
    for vr, order, words in (
        (variables["bead.x"].valueReference, 1, "bead.x is no input"),
        (variables["wire.radius"].valueReference, 1, "wire.radius is no input"),
        (variables["wire.ax"].valueReference, 2, "order = 2"),
        (variables["wire.ax"].valueReference, 0, "order = 0"),
        (9999, 1, "value reference 9999"),
    ):
        instance = start("BeadOnWire")
        assert instance.status("setRealInputDerivatives", [vr], [order], [1.0]) == ERROR
        assert words in instance.errors[-1]
        instance = start("BeadOnWire")
        if words != "bead.x is no input":
            assert instance.status("getRealOutputDerivatives", [vr], [order]) == ERROR
    for slope in (math.nan, math.inf, 1e200):
        instance = start("BeadOnWire")
        before = instance.bits()
        instance.slope({"wire.ax": slope})
        assert instance.step_status(0.0, 0.1) == ERROR
        assert "wire.ax" in instance.errors[-1]
        assert instance.bits() == before


def test_failed_step_keeps_inputs_and_slopes(start: Start) -> None:
    parameters = {"solver.method": "rk4", "solver.step": 1e-3, "solver.max_steps": 100}
    failing, other = start("BeadOnWire", parameters), start("BeadOnWire", parameters)
    for instance in (failing, other):
        instance.set({"wire.ax": 1.0})
        instance.slope({"wire.ax": 2.0})
    saved = failing.serialized()
    assert failing.step_status(0.0, 0.2) == ERROR
    assert failing["wire.ax"] == 1.0
    failing.restore(saved, 0.0)
    for instance in (failing, other):
        instance.step(0.05)
    assert failing.bits() == other.bits()


@pytest.fixture
def mended_fmpy(monkeypatch: pytest.MonkeyPatch) -> None:
    """fmpy 0.3.32 has room for the derivatives of nine inputs, and fails with any other number."""
    made = simulation.Input.__init__

    def make(self: simulation.Input, *arguments: object, **named: object) -> None:
        made(self, *arguments, **named)
        if self.t is not None:
            self.continuous = [
                c._replace(derivatives=(c_double * len(c.vrs))()) for c in self.continuous
            ]

    monkeypatch.setattr(simulation.Input, "__init__", make)


@pytest.mark.usefixtures("mended_fmpy")
@pytest.mark.parametrize("name", PUSHED)
def test_simulate_fmu_with_input_derivatives(extracted: dict[str, Extracted], name: str) -> None:
    """A smooth drive at steps of 20 ms: far nearer to small steps than without derivatives."""
    ax, x = PUSHED[name]
    t = np.linspace(0.0, 1.0, 51)
    drive = np.array(list(zip(t, 3.0 * np.sin(4.0 * t), strict=True)), [("time", "f8"), (ax, "f8")])
    true = 3.0 * (1.0 / 4.0 - math.sin(4.0) / 16.0)
    error = {}
    for derivatives in (False, True):
        result = simulate_fmu(
            str(extracted[name].folder),
            stop_time=1.0,
            output_interval=0.02,
            input=drive,
            output=[x],
            set_input_derivatives=derivatives,
        )
        error[derivatives] = abs(result[x][-1] - true)
    assert error[True] < 3e-4
    assert error[False] > 50 * error[True]


@pytest.mark.parametrize("sloped", [False, True])
@pytest.mark.parametrize("label", MODELS)
def test_rates_of_outputs(start: Start, label: str, sloped: bool) -> None:
    """Against differences over a short step, from the middle of it."""
    name, parameters = MODELS[label]
    instance = start(name, {**parameters, "solver.method": "rk4", "solver.step": 1e-6})
    instance.set(inputs_at(name, 0.5))
    instance.step(0.01)
    h = 1e-4
    outputs = [n for n in instance.fmu.outputs if not n.startswith("solver.")]
    slopes = slopes_at(name, 0.5) if sloped else {}
    before = instance.get(*outputs)
    instance.slope(slopes)
    instance.step(h)
    state = instance.bits()
    instance.slope(slopes)
    rates = instance.rates(*outputs)
    assert instance.bits() == state
    instance.step(h)
    after = instance.get(*outputs)
    for n, a, b, rate in zip(outputs, before, after, rates, strict=True):
        assert rate == pytest.approx((b - a) / (2 * h), rel=1e-5, abs=2e-5), n
    assert instance.status("getRealOutputDerivatives", [0], [1]) == ERROR


def test_drive_follows_slopes_and_tells_rates(start: Start) -> None:
    """Its measurements rise over a step, and with them what it puts out; once."""
    drive = start("ParabolaDrive", {"feedback.slider_u": -4.0, "waveform.kind": "sine"})
    drive.set({"slider.u": 0.5})
    drive.slope({"slider.u": 3.0})
    assert drive.rates("parabola.ax", "parabola.ay") == pytest.approx([12.0 + 2.0 * math.pi, 0.0])
    saved = drive.serialized()
    for _ in range(2):
        drive.step(0.25)
        assert drive["slider.u"] == 1.25
        assert drive["parabola.ax"] == pytest.approx(5.0 + 1.0, rel=1e-15)
        drive.restore(saved, 0.0)
    drive.step(0.25)
    drive.step(0.25)
    assert drive["parabola.ax"] == pytest.approx(5.0, rel=1e-14)


def test_rates_in_initialization(instantiate: Callable[..., Instance]) -> None:
    instance = instantiate("BeadOnWire")
    instance.slave.setupExperiment()
    instance.set({"bead.angular_velocity_start": 2.0})
    instance.slave.enterInitializationMode()
    assert instance.rates("bead.angle", "bead.angular_velocity") == pytest.approx([2.0, -9.81])
    assert instance.status("exitInitializationMode") == OK

"""fmi2GetDirectionalDerivative: outputs by inputs of the same instant."""

from __future__ import annotations

import math
import random
from collections.abc import Callable

import pytest
from driven import INPUTS, MODELS
from harness import ERROR, OK, Instance, Value

Start = Callable[..., Instance]

#: states of one motion
RUN = 10
STEP = 1e-5
CLOSE = 1e-7

DRIVE: dict[str, Value] = {
    "feedback.slider_u": 1.5,
    "feedback.slider_u_rate": -0.3,
    "feedback.pendulum_angle": 4.0,
    "feedback.pendulum_angular_velocity": 0.25,
    "feedback.parabola_x": -2.0,
    "feedback.parabola_vx": 0.8,
    "limit.acceleration": 5.0,
}
CASES = {**MODELS, "drive": ("ParabolaDrive", DRIVE)}


def vrs(instance: Instance, names: list[str]) -> list[int]:
    return [instance.fmu.variables[name].valueReference for name in names]


def changes(instance: Instance, outputs: list[str], seeds: dict[str, float]) -> list[float]:
    """J seed for some outputs."""
    knowns = vrs(instance, list(seeds))
    return instance.slave.getDirectionalDerivative(
        vrs(instance, outputs), knowns, list(seeds.values())
    )


def differences(
    instance: Instance, outputs: list[str], inputs: dict[str, float], seeds: dict[str, float]
) -> list[float]:
    """Central differences, of two steps, extrapolated."""
    found = []
    for h in (STEP, 0.5 * STEP):
        ends = []
        for side in (h, -h):
            instance.set({name: x + side * seeds.get(name, 0.0) for name, x in inputs.items()})
            ends.append(instance.get(*outputs))
        found.append([(b - a) / (2.0 * h) for b, a in zip(*ends, strict=True)])
    instance.set(inputs)
    return [(4.0 * b - a) / 3.0 for a, b in zip(*found, strict=True)]


@pytest.mark.parametrize("count", [50, pytest.param(1000, marks=pytest.mark.slow)])
@pytest.mark.parametrize("label", CASES)
def test_against_differences(start: Start, label: str, count: int) -> None:
    """At random states and inputs, along a random seed each time."""
    name, parameters = CASES[label]
    rng = random.Random(label)
    instance = start(name, parameters)
    outputs = instance.fmu.outputs
    starts = [n for n in instance.fmu.variables if n.endswith("_start")]
    for number in range(count):
        if number % RUN == 0:
            instance.slave.reset()
            instance.start({**parameters, **{n: rng.uniform(-1.0, 1.0) for n in starts}})
        inputs = {n: size * rng.uniform(-2.0, 2.0) for n, size in INPUTS[name].items()}
        instance.set(inputs)
        instance.step(rng.uniform(1e-3, 0.05))
        chosen = rng.sample(list(inputs), rng.randint(1, len(inputs)))
        seeds = {n: rng.uniform(-1.0, 1.0) for n in chosen}
        before = instance.bits()
        got = changes(instance, outputs, seeds)
        assert instance.bits() == before
        true = differences(instance, outputs, inputs, seeds)
        size = max(map(abs, true))
        for n, a, b in zip(outputs, got, true, strict=True):
            assert abs(a - b) <= CLOSE * max(1.0, abs(b), 1e-3 * size), (n, a, b, inputs, seeds)


@pytest.mark.parametrize("label", CASES)
def test_phases_and_saved_states(instantiate: Callable[..., Instance], label: str) -> None:
    """From initialization mode on; after a state is restored, what it was there."""
    name, parameters = CASES[label]
    instance = instantiate(name)
    outputs = instance.fmu.outputs
    inputs = INPUTS[name]
    seeds = {n: 1.0 + i for i, n in enumerate(inputs)}
    instance.slave.setupExperiment()
    instance.set(parameters)
    asked = vrs(instance, outputs), vrs(instance, list(seeds)), list(seeds.values())
    assert instance.status("getDirectionalDerivative", *asked) == ERROR
    assert "fmi2EnterInitializationMode" in instance.errors[-1]
    instance.slave.enterInitializationMode()
    instance.set(inputs)
    first = changes(instance, outputs, seeds)
    assert any(first)
    assert first == pytest.approx(differences(instance, outputs, inputs, seeds), abs=1e-6)
    instance.slave.exitInitializationMode()
    assert changes(instance, outputs, seeds) == first
    instance.step(0.1)
    there = changes(instance, outputs, seeds)
    saved = instance.serialized()
    instance.step(0.1)
    later = changes(instance, outputs, seeds)
    assert (later == there) == (label == "drive")
    instance.restore(saved, 0.1)
    assert changes(instance, outputs, seeds) == there
    instance.step(0.1)
    assert changes(instance, outputs, seeds) == later
    assert instance.status("terminate") == OK
    assert changes(instance, outputs, seeds) == later


def test_a_limit_and_a_sample_stop_the_feedback(start: Start) -> None:
    seeds = {"pendulum.angle": 1.0, "parabola.vx": 1.0}
    drive = start("ParabolaDrive", DRIVE)
    assert changes(drive, ["parabola.ax"], seeds) == pytest.approx([-4.8])
    drive.set({"pendulum.angle": 2.0})
    assert drive["parabola.ax"] == -5.0
    assert changes(drive, ["parabola.ax", "parabola.ay"], seeds) == [0.0, 0.0]
    sampled = start("ParabolaDrive", {**DRIVE, "sample.period": 0.1})
    assert changes(sampled, ["parabola.ax"], seeds) == pytest.approx([-4.8])
    sampled.step(0.05)
    assert changes(sampled, ["parabola.ax"], seeds) == [0.0]
    sampled.step(0.05)
    assert changes(sampled, ["parabola.ax"], seeds) == pytest.approx([-4.8])


def test_sizes_and_repeated_knowns(start: Start) -> None:
    """Exact for seeds of any size; seeds of an input named twice add up."""
    instance = start("BeadOnWire", {"bead.mass": 2.0, "bead.angle_start": 0.3})
    (up,) = vrs(instance, ["wire.ay"])
    (force,) = vrs(instance, ["constraint.force"])
    expected = -2.0 * math.cos(0.3)
    for size in (1e-140, 1e-9, 1.0, 1e140):
        got = instance.slave.getDirectionalDerivative([force], [up], [size])
        assert got == pytest.approx([size * expected], rel=1e-14)
    got = instance.slave.getDirectionalDerivative([force], [up, up], [1.0, 2.0])
    assert got == pytest.approx([3.0 * expected], rel=1e-14)
    assert instance.slave.getDirectionalDerivative([force], [up], [0.0]) == [0.0]
    assert instance.slave.getDirectionalDerivative([], [up], [1.0]) == []


def test_what_is_refused(start: Start) -> None:
    instance = start("BeadOnWire")
    for unknown, known, seed, words in (
        ("wire.ax", "wire.ay", 1.0, "wire.ax is no output and cannot be the unknown"),
        ("wire.radius", "wire.ay", 1.0, "wire.radius is no output"),
        ("wire.fx", "bead.x", 1.0, "bead.x is no input and cannot be the known"),
        ("wire.fx", "gravity.y", 1.0, "gravity.y is no input"),
        ("solver.method", "wire.ax", 1.0, "solver.method of type Enumeration"),
        ("wire.fx", "wire.ax", math.nan, "seed nan of wire.ax"),
        ("wire.fx", "wire.ax", 1e200, "seed 1e+200 of wire.ax"),
    ):
        a, b = vrs(instance, [unknown, known])
        assert instance.status("getDirectionalDerivative", [a], [b], [seed]) == ERROR
        assert words in instance.errors[-1], words
    assert instance.status("getDirectionalDerivative", [9999], [0], [1.0]) == ERROR
    assert "value reference 9999" in instance.errors[-1]
    instance.set({"wire.ax": math.nan})
    a, b = vrs(instance, ["wire.fx", "wire.ay"])
    assert instance.status("getDirectionalDerivative", [a], [b], [1.0]) == ERROR
    assert "wire.ax = nan" in instance.errors[-1]

"""Saved states: saving, restoring and stepping in any order gives the bits of the straight run."""

from __future__ import annotations

import random
from typing import NamedTuple

import pytest
from driven import METHODS, MODELS, constant, inputs_at
from harness import DISCARD, ERROR, FATAL, OK, Extracted, Instance, Value

STEPS = 24


class Tape(NamedTuple):
    """A straight run: what was done in each step, and all outputs before and after each."""

    #: communication points, one more than steps
    times: list[float]
    sizes: list[float]
    inputs: list[dict[str, float]]
    bits: list[bytes]


class Subject(NamedTuple):
    """An FMU with parameters; `tuning` holds tunable parameters that change on the way."""

    fmu: str
    parameters: dict[str, Value]
    is_constant: bool = False
    tuning: tuple[str, ...] = ()


_DRIVE: dict[str, Value] = {
    "feedback.slider_u": 2.0,
    "feedback.pendulum_angular_velocity": -0.7,
    "waveform.kind": "chirp",
    "waveform.amplitude": 3.0,
    "limit.acceleration": 4.0,
}
_TUNED = ("feedback.slider_u", "waveform.amplitude", "reference.parabola_x")

SUBJECTS: dict[str, Subject] = {
    **{
        f"{label}-{method}": Subject(fmu, {**parameters, "solver.method": method})
        for label, (fmu, parameters) in MODELS.items()
        for method in METHODS
    },
    "linear-exact": Subject(
        "ParabolaPendulum", {**constant(MODELS["linear"][1]), "solver.method": "exact"}, True
    ),
    "drive": Subject("ParabolaDrive", _DRIVE, tuning=_TUNED),
    "drive-sampled": Subject("ParabolaDrive", {**_DRIVE, "sample.period": 0.03}, tuning=_TUNED),
    "drive-sampled-slowly": Subject(
        "ParabolaDrive", {**_DRIVE, "sample.period": 0.25, "waveform.axis": "y"}, tuning=_TUNED
    ),
}


def recorded(fmu: Extracted, subject: Subject, seed: int) -> Tape:
    draw = random.Random(seed)
    with Instance(fmu) as instance:
        instance.start(subject.parameters)
        times = [0.0]
        sizes: list[float] = []
        inputs: list[dict[str, float]] = []
        bits = [instance.bits()]
        for _ in range(STEPS):
            chosen = inputs_at(subject.fmu, instance.time, constant=subject.is_constant)
            chosen |= {name: draw.uniform(-3.0, 3.0) for name in subject.tuning}
            if draw.random() < 0.3:
                chosen = {}
            size = draw.choice((0.01, 0.05 * draw.random() + 1e-3, 0.1))
            instance.set(chosen)
            instance.step(size)
            times.append(instance.time)
            sizes.append(size)
            inputs.append(chosen)
            bits.append(instance.bits())
        assert instance.errors == []
    return Tape(times, sizes, inputs, bits)


@pytest.fixture(scope="module")
def fleet(extracted: dict[str, Extracted], interpreted: dict[str, Extracted]):
    return {"extracted": extracted, "interpreted": interpreted}


@pytest.mark.parametrize("count", [1, pytest.param(4, marks=pytest.mark.slow)])
@pytest.mark.parametrize("label", SUBJECTS)
def test_random_sequences(fleet, label: str, count: int) -> None:
    for seed in range(count):
        random_sequence(fleet, SUBJECTS[label], seed, 80 if count == 1 else 120)


def random_sequence(fleet, subject: Subject, seed: int, actions: int) -> None:
    fmu = fleet["extracted"][subject.fmu]
    tape = recorded(fmu, subject, seed)
    draw = random.Random(1000 + seed)
    instance = Instance(fmu).start(subject.parameters)
    others: list[Instance] = []
    position = 0
    handles: list[tuple[int, object]] = []
    saved: list[tuple[int, bytes]] = []
    for _ in range(actions):
        action = draw.random()
        if action < 0.6 and position < STEPS:
            instance.set(tape.inputs[position])
            instance.step(tape.sizes[position])
            position += 1
            assert instance.bits() == tape.bits[position], (position, instance.errors)
        elif action < 0.7:
            handles.append((position, instance.slave.getFMUstate()))
        elif action < 0.8:
            saved.append((position, instance.serialized()))
        elif action < 0.88 and handles:
            position, state = draw.choice(handles)
            instance.slave.setFMUstate(state)
            assert instance.bits() == tape.bits[position]
        elif action < 0.96 and saved:
            position, data = draw.choice(saved)
            instance.restore(data, 0.0)
            assert instance.bits() == tape.bits[position]
        elif saved:
            # a new instance goes on: initialised or not, of this build or of the interpreted one
            for _, state in handles:
                instance.slave.freeFMUstate(state)
            handles.clear()
            others.append(instance)
            position, data = draw.choice(saved)
            instance = Instance(fleet[draw.choice(("extracted", "interpreted"))][subject.fmu])
            if draw.random() < 0.5:
                instance.start({})
                instance.step(0.05)
            instance.restore(data, 0.0)
            assert instance.bits() == tape.bits[position]
        instance.time = tape.times[position]
    assert instance.errors == []
    for other in [*others, instance]:
        other.free()


@pytest.mark.parametrize("name", ["BeadOnWire", "ParabolaPendulum", "ParabolaDrive"])
def test_saving_changes_nothing_and_restoring_changes_all(instantiate, name: str) -> None:
    instance = instantiate(name).start()
    instance.set(inputs_at(name, 0.0))
    instance.step(0.1)
    data, bits = instance.serialized(), instance.bits()
    assert (instance.serialized(), instance.bits()) == (data, bits)
    instance.set(inputs_at(name, 0.5))
    instance.step(0.1)
    after = instance.bits()
    if name != "ParabolaDrive":
        assert after != bits
    instance.restore(data, 0.1)
    assert (instance.serialized(), instance.bits()) == (data, bits)


def test_model_time_is_restored(start) -> None:
    instance = start("BeadOnWire", {}, start_time=5.0)
    instance.step(0.5)
    data = instance.serialized()
    instance.step(0.5)
    instance.restore(data, 5.5)
    assert instance.step_status(6.0, 0.5) >= DISCARD
    instance.restore(data, 5.5)
    assert instance.step_status(5.5, 0.5) == OK


def test_parameters_and_tolerance_are_restored(instantiate) -> None:
    parameters = {"bead.mass": 3.0, "wire.radius": 0.4, "solver.method": "adaptive"}
    straight = instantiate("BeadOnWire").start(parameters, tolerance=1e-11)
    straight.step(0.5)
    data = straight.serialized()
    straight.step(3.0)
    other = instantiate("BeadOnWire").start({"bead.mass": 0.1, "solver.method": "rk4"})
    other.restore(data, 0.5)
    assert other.get("bead.mass", "wire.radius", "solver.method") == [3.0, 0.4, 4]
    other.step(3.0)
    assert other.bits() == straight.bits()


@pytest.mark.parametrize("name", ["BeadOnWire", "ParabolaPendulum", "ParabolaDrive"])
def test_states_of_every_mode(instantiate, name: str) -> None:
    """Saved before initialization, in initialization mode and after termination."""
    straight = instantiate(name).start({}, tolerance=1e-9)
    straight.step(0.1)
    instance = instantiate(name)
    slave = instance.slave
    slave.setupExperiment(tolerance=1e-9)
    fresh = slave.getFMUstate()
    slave.enterInitializationMode()
    initializing = slave.getFMUstate()
    slave.exitInitializationMode()
    instance.step(0.1)
    assert instance.bits() == straight.bits()
    slave.terminate()
    terminated = slave.getFMUstate()
    slave.setFMUstate(initializing)
    slave.exitInitializationMode()
    slave.setFMUstate(fresh)
    slave.enterInitializationMode()
    slave.exitInitializationMode()
    instance.time = 0.0
    instance.step(0.1)
    assert instance.bits() == straight.bits()
    slave.setFMUstate(terminated)
    assert instance.bits() == straight.bits()
    assert instance.status("doStep", 0.1, 0.1) >= DISCARD


# -- what is no state of this FMU ------------------------------------------------------------------


def refused(instance: Instance, data: bytes) -> str:
    """Deserialise and restore; the message of the refusal."""
    before = len(instance.errors)
    bits = instance.bits()
    states: list[object] = []

    def load() -> None:
        states.append(instance.slave.deSerializeFMUstate(data))
        instance.slave.setFMUstate(states[-1])

    instance.slave.load = load
    status = instance.status("load")
    assert status >= ERROR or len(instance.errors) == before + 1
    if status == FATAL:
        # without a binary of this project
        return "state"
    assert instance.bits() == bits
    assert len(instance.errors) == before + 1
    return instance.errors[-1]


def test_altered_and_truncated_states_are_refused(instantiate) -> None:
    instance = instantiate("ParabolaPendulum").start({"solver.method": "adaptive"})
    instance.step(0.1)
    data = instance.serialized()
    draw = random.Random(3)
    forged = [b"", data[:1], data[:100], data[:-1], data + b" ", data[1:], b"x" * len(data)]
    for _ in range(200):
        place = draw.randrange(len(data))
        other = bytes([data[place] ^ (1 << draw.randrange(8))])
        forged.append(data[:place] + other + data[place + 1 :])
    for other in forged:
        if instance.lost:
            instance = instantiate("ParabolaPendulum").start()
        assert "state" in refused(instance, other)
    if not instance.lost:
        instance.restore(data, 0.1)
        instance.step(0.1)


def test_states_of_another_fmu_are_refused(instantiate) -> None:
    bead = instantiate("BeadOnWire").start()
    pendulum = instantiate("ParabolaPendulum").start()
    assert bead.fmu.guid in refused(pendulum, bead.serialized())


def test_states_of_another_library_are_refused(instantiate, extracted) -> None:
    if not extracted["BeadOnWire"].forwarded:
        pytest.skip("without a binary of this project a foreign pointer is followed")
    bead = instantiate("BeadOnWire").start()
    pendulum = instantiate("ParabolaPendulum").start()
    state = bead.slave.getFMUstate()
    assert pendulum.status("setFMUstate", state) == ERROR
    assert "state" in pendulum.errors[-1]
    bead.slave.freeFMUstate(state)
    assert bead.status("setFMUstate", state) == ERROR


def test_a_state_with_an_input_that_is_nan(instantiate) -> None:
    """Restored, it waits for a usable input as it did when saved, and shows no NaN."""
    instance = instantiate("BeadOnWire").start()
    instance.step(0.1)
    instance.set({"wire.ax": float("nan")})
    data = instance.serialized()
    other = instantiate("BeadOnWire")
    other.restore(data, 0.1)
    assert all(abs(x) < 1e3 for x in other.reals())
    other.set({"wire.ax": 1.0})
    other.step(0.1)
    instance.set({"wire.ax": 1.0})
    instance.step(0.1)
    assert other.bits() == instance.bits()

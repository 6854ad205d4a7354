"""Frame motion, saved states and rollback, of all models."""

from __future__ import annotations

import random
from typing import Any

import pytest

from curvebound.fmi.folder import find
from curvebound.kernel.rk4 import RK4

bead_on_wire = find("BeadOnWire").module("kernel").model
parabola_pendulum = find("ParabolaPendulum").module("kernel").model

KINDS: dict[str, tuple[Any, dict[str, int]]] = {
    "none": (bead_on_wire, {"model.formulation": 1, "constraint.stabilization": 1}),
    "baumgarte": (bead_on_wire, {"model.formulation": 1, "constraint.stabilization": 2}),
    "projection": (bead_on_wire, {"model.formulation": 1, "constraint.stabilization": 3}),
    "angle": (bead_on_wire, {"model.formulation": 2, "constraint.stabilization": 3}),
    "linear": (parabola_pendulum, {"model.fidelity": 1}),
    "nonlinear": (parabola_pendulum, {"model.fidelity": 2}),
}


@pytest.fixture(params=KINDS)
def kind(request: pytest.FixtureRequest) -> str:
    return str(request.param)


@pytest.fixture
def new(kind: str, bead_defaults: dict[str, float], parabola_defaults: dict[str, float]) -> Any:
    """Makes a started model of the kind, turning over and with damping."""
    factory, choices = KINDS[kind]
    defaults = bead_defaults if factory is bead_on_wire else parabola_defaults
    lively = {
        "bead.damping": 0.1,
        "slider.damping": 0.1,
        "pendulum.damping": 0.05,
        "bead.angular_velocity_start": 9.0,
        "pendulum.angular_velocity_start": 9.0,
        "parabola.coefficient_rate_start": 0.02,
    }
    parameters = {**defaults, **{k: v for k, v in lively.items() if k in defaults}}

    def make() -> Any:
        model = factory(choices)
        model.start(parameters, choices)
        return model

    return make


def random_inputs(model: Any, rng: random.Random) -> list[float]:
    return [rng.uniform(-0.5, 0.5) for _ in model.INPUTS]


def step(model: Any, inputs: list[float], duration: float = 0.05, count: int = 25) -> None:
    model.set_inputs(inputs, 0)
    model.keep()
    RK4().advance(model, duration, count, 0.0, count)
    model.advance_frame(duration)


def test_outputs_are_complete_and_read_without_changing_anything(
    kind: str, new: Any, outputs: Any, rng: random.Random
) -> None:
    model = new()
    assert set(model.FEEDTHROUGH) <= set(model.OUTPUTS.values())
    step(model, random_inputs(model, rng))
    before = model.get_state()
    first = outputs(model)
    assert all(value == value for value in first.values())
    assert outputs(model) == first
    assert model.get_state() == before


def test_only_declared_groups_depend_on_inputs(kind: str, new: Any, rng: random.Random) -> None:
    model = new()
    step(model, random_inputs(model, rng))
    names = list(model.OUTPUTS)
    seen = []
    for _ in range(2):
        model.set_inputs(random_inputs(model, rng), 0)
        values = [0.0] * len(names)
        for group in set(model.OUTPUTS.values()):
            model.observe(group, values, 0)
        seen.append(values)
    changed = {n for n, a, b in zip(names, *seen, strict=True) if a != b}
    declared = {n for n in names if model.OUTPUTS[n] in model.FEEDTHROUGH}
    assert changed <= declared
    constant = {"model.acceleration_error"} if kind == "nonlinear" else set()
    assert declared - constant <= changed


def test_observation_writes_its_own_group_only(new: Any) -> None:
    model = new()
    names = list(model.OUTPUTS)
    for group in set(model.OUTPUTS.values()):
        values = [float("nan")] * (len(names) + 7)
        model.observe(group, values, 5)
        written = {names[i - 5] for i, v in enumerate(values) if v == v}
        assert written == {n for n in names if model.OUTPUTS[n] == group}


def test_saved_state_continues_with_the_same_bits(
    new: Any, outputs: Any, rng: random.Random
) -> None:
    model = new()
    for _ in range(30):
        step(model, random_inputs(model, rng))
    saved = model.get_state()
    assert all(isinstance(x, float) and x - x == 0.0 for x in saved)
    ways = [random_inputs(model, rng) for _ in range(30)]
    expected = []
    for inputs in ways:
        step(model, inputs)
        expected.append((model.get_state(), outputs(model)))
    for other in (model, new()):
        other.set_inputs(random_inputs(model, rng), 0)
        other.set_state(saved)
        assert other.get_state() == saved
        for inputs, (state, out) in zip(ways, expected, strict=True):
            step(other, inputs)
            assert other.get_state() == state
            assert outputs(other) == out


def test_undo_returns_the_same_bits(new: Any, outputs: Any, rng: random.Random) -> None:
    model = new()
    for _ in range(40):
        inputs = random_inputs(model, rng)
        model.set_inputs(inputs, 0)
        kept, out = model.get_state(), outputs(model)
        model.keep()
        step(model, inputs, 0.7)
        once = model.get_state()
        model.undo()
        assert model.get_state() == kept
        assert outputs(model) == out
        step(model, inputs, 0.7)
        assert model.get_state() == once


def test_restart_on_the_same_instance(
    kind: str,
    bead_defaults: dict[str, float],
    parabola_defaults: dict[str, float],
    rng: random.Random,
    outputs: Any,
) -> None:
    factory, choices = KINDS[kind]
    defaults = bead_defaults if factory is bead_on_wire else parabola_defaults
    model = factory(choices)
    model.start(defaults, choices)
    fresh, out = model.get_state(), outputs(model)
    flags = (model.works, model.settles, model.is_constant)
    for _ in range(5):
        step(model, random_inputs(model, rng))
    model.start(defaults, choices)
    assert model.get_state() == fresh
    assert outputs(model) == out
    assert (model.works, model.settles, model.is_constant) == flags


def test_foreign_state_is_refused(kind: str, new: Any) -> None:
    with pytest.raises(ValueError, match="saved state has 3 numbers"):
        new().set_state([1.0, 2.0, 3.0])


def test_frame_follows_its_polynomial(kind: str, new: Any, outputs: Any) -> None:
    model = new()
    frame = "wire" if "wire.x" in model.OUTPUTS else "parabola"
    zeros = [0.0] * (len(model.INPUTS) - 2)
    x = v = a = 0.0
    a_rate = 0.02
    time = 0.0
    for ax, bend, duration in ((1.0, 0.3, 0.5), (-2.0, -0.1, 0.25), (0.0, 0.0, 2.0)):
        model.set_inputs([ax, -ax, *zeros], 0)
        if frame == "parabola":
            model.set_inputs([ax, -ax, bend, *zeros[1:]], 0)
            a += a_rate * duration + bend * duration**2 / 2
            a_rate += bend * duration
        model.keep()
        model.advance_frame(duration)
        x += v * duration + ax * duration**2 / 2
        v += ax * duration
        time += duration
        out = outputs(model)
        assert out[f"{frame}.x"] == pytest.approx(x, rel=1e-15)
        assert out[f"{frame}.y"] == pytest.approx(-x, rel=1e-15)
        assert out[f"{frame}.vx"] == pytest.approx(v, rel=1e-15)
        assert out[f"{frame}.vy"] == pytest.approx(-v, rel=1e-15)
        if frame == "parabola":
            assert out["parabola.coefficient"] == pytest.approx(0.5 + a, rel=1e-15)
            assert out["parabola.coefficient_rate"] == pytest.approx(a_rate, rel=1e-14)


def test_motion_in_the_world_is_the_derivative_of_position(
    kind: str, new: Any, outputs: Any, rng: random.Random
) -> None:
    model = new()
    for _ in range(3):
        step(model, random_inputs(model, rng), 0.5, 500)
    inputs = random_inputs(model, rng)
    names = [n for n in model.OUTPUTS if n.endswith((".vx", ".vy"))]
    step(model, inputs, 1e-4, 1)
    before, out = outputs(model), None
    step(model, inputs, 1e-4, 1)
    out = outputs(model)
    step(model, inputs, 1e-4, 1)
    after = outputs(model)
    for name in names:
        place = name.replace(".v", ".")
        slope = (after[place] - before[place]) / 2e-4
        assert out[name] == pytest.approx(slope, abs=2e-6)


def test_energy_residual_vanishes_at_the_order_of_the_method(
    kind: str, new: Any, outputs: Any
) -> None:
    residuals = []
    for count in (100, 200):
        model = new()
        inputs = [(-1.0) ** i * 0.4 for i in range(len(model.INPUTS))]
        for _ in range(4):
            step(model, inputs, 0.25, count // 4)
            inputs = [-i for i in inputs]
        residuals.append(abs(outputs(model)["energy.residual"]))
    assert residuals[1] < 1e-4
    # projection changes the energy by what it removes: of the order of the method too
    assert residuals[0] / residuals[1] > 12.0 or residuals[1] < 1e-11


def test_terms_that_are_off_are_off(kind: str, bead_defaults: Any, parabola_defaults: Any) -> None:
    factory, choices = KINDS[kind]
    defaults = bead_defaults if factory is bead_on_wire else parabola_defaults
    model = factory(choices)
    model.start(defaults, choices)
    assert not model.works
    assert model.settles == (kind in ("none", "baumgarte", "projection"))
    off = [0.0] * len(model.INPUTS)
    for i in range(len(off)):
        on = [*off]
        on[i] = 0.5
        model.start(defaults, choices)
        model.set_inputs(on, 0)
        assert model.works
        model.keep()
        model.advance_frame(1.0)
        model.set_inputs(off, 0)
        # a frame or a shape that keeps moving does work; to the linear model a steady frame is none
        moves = model.INPUTS[i].startswith(("wire.", "parabola."))
        steady = kind == "linear" and model.INPUTS[i] in ("parabola.ax", "parabola.ay")
        assert model.works == (moves and not steady)


def test_infinite_energy_is_refused(kind: str, bead_defaults: Any, parabola_defaults: Any) -> None:
    factory, choices = KINDS[kind]
    defaults = bead_defaults if factory is bead_on_wire else parabola_defaults
    mass = "bead.mass" if factory is bead_on_wire else "pendulum.mass"
    with pytest.raises(ValueError, match=r"the initial energy is .*use smaller ones"):
        factory(choices).start({**defaults, mass: 1e308, "gravity.y": -1e308}, choices)


@pytest.mark.parametrize("fidelity", [1, 2])
def test_what_acts_later_is_what_acts_at_a_start_that_is_later(
    fidelity: int, parabola_defaults: dict[str, float]
) -> None:
    """Of a parabola that bends: its coefficient is all that depends on time."""
    choices, t = {"model.fidelity": fidelity}, 0.7
    damped = {**parabola_defaults, "slider.damping": 0.1, "pendulum.damping": 0.05}
    inputs = [0.3, -0.2, 0.4, 0.5, -0.6, 0.7, -0.8]
    bend, state = inputs[2], (0.6, -0.4, 0.9, -1.1)

    def made(a: float, rate: float) -> Any:
        model = parabola_pendulum(choices)
        start = {"parabola.coefficient_start": a, "parabola.coefficient_rate_start": rate}
        model.start({**damped, **start}, choices)
        model.set_inputs(inputs, 0)
        return model

    early, late = made(0.5, 0.3), made(0.5 + t * (0.3 + 0.5 * t * bend), 0.3 + t * bend)
    ax, ay = inputs[:2]
    late.x, late.y, late.vx, late.vy = 0.5 * ax * t * t, 0.5 * ay * t * t, ax * t, ay * t
    early.acceleration(t, *state)
    late.acceleration(0.0, *state)
    accelerations = early.a0, early.a1
    assert accelerations == pytest.approx((late.a0, late.a1), rel=1e-13)
    power = early.power(t, *state, *accelerations)
    assert power == pytest.approx(late.power(0.0, *state, *accelerations), rel=1e-13)


def test_the_form_of_the_power_is_the_power(parabola_defaults: dict[str, float]) -> None:
    """What `exact` integrates, of sizes of which none is 1."""
    sizes = {"slider.mass": 1.3, "pendulum.mass": 0.7, "pendulum.length": 0.8, "gravity.x": 0.4,
             "slider.damping": 0.1, "pendulum.damping": 0.05,
             "parabola.coefficient_start": 0.6, "parabola.coefficient_rate_start": 0.0}  # fmt: skip
    model = parabola_pendulum({"model.fidelity": 1})
    model.start({**parabola_defaults, **sizes}, {"model.fidelity": 1})
    model.set_inputs([0.3, -0.2, 0.0, 0.5, -0.6, 0.7, -0.8], 0)
    form = model.power_form()
    for state in ((0.6, -0.4, 0.9, -1.1), (-0.2, 0.8, 0.3, 0.7)):
        model.acceleration(0.0, *state)
        z = (*state, 1.0)
        found = sum(form[i][j] * z[i] * z[j] for i in range(5) for j in range(5))
        assert found == pytest.approx(model.power(0.0, *state, model.a0, model.a1), rel=1e-13)


def test_work_is_counted_where_anything_does_any(
    kind: str, bead_defaults: dict[str, float], parabola_defaults: dict[str, float]
) -> None:
    """A single input, damping or changing coefficient, of size 1 too; at rest nothing does."""
    factory, choices = KINDS[kind]
    defaults = bead_defaults if factory is bead_on_wire else parabola_defaults

    def works(given: dict[str, float], number: int | None = None) -> bool:
        model = factory(choices)
        model.start({**defaults, **given}, choices)
        model.set_inputs([float(i == number) for i in range(len(model.INPUTS))], 0)
        return bool(model.works)

    assert not works({})
    losses = [n for n in defaults if n.endswith((".damping", "rate_start")) and "u_rate" not in n]
    for name in losses:
        if name != "constraint.damping":
            assert works({name: 1.0}), name
    for number in range(len(factory(choices).INPUTS)):
        assert works({}, number), number

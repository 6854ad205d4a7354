"""First-order hold: inputs linear in time over a macro step, against the continuous reference."""

from __future__ import annotations

import math

import numpy as np
import pytest

from curvebound.cosim import Adaptive, Scene, load_scene
from curvebound.cosim.exchange import Exchange
from curvebound.cosim.instance import Instance
from curvebound.cosim.prepared import Prepared
from curvebound.cosim.resolution import resolve
from curvebound.cosim.ssp import write_ssp
from curvebound.errors import CurveboundError
from curvebound.study.reference.reference import refer

STEPS = [0.04, 0.02, 0.01, 0.005, 0.0025]
OMEGA = 2.0 * math.sqrt(9.81)


def shaken_wire() -> Scene:
    """The scene of that name with the drive as it is, not half a step ahead."""
    scene = Scene("shaken", stop_time=2.0, step=0.01)
    start = {"model.formulation": "angle", "bead.angle_start": 0.05, "solver.method": "adaptive"}
    scene.add("bead", "BeadOnWire", {**start, "solver.tolerance": 1e-12})
    scene.input("bead.wire.ay", lambda t: 0.05 * OMEGA * OMEGA * math.cos(OMEGA * t))
    return scene.record("bead.bead.angle")


def swaying_parabola() -> Scene:
    """The scene of that name with a function instead of the drive FMU."""
    scene = Scene("swayed", stop_time=4.0, step=0.01)
    start = {"slider.u_start": 0.0, "pendulum.angle_start": 0.0, "solver.method": "adaptive"}
    scene.add("plant", "ParabolaPendulum", {**start, "solver.tolerance": 1e-12})
    scene.input("plant.parabola.ax", lambda t: 0.5 * math.cos(2.0 * math.pi * 0.35 * t))
    return scene.record("plant.slider.u", "plant.pendulum.angle")


SCENES = {"shaken_wire": shaken_wire, "swaying_parabola": swaying_parabola}


def errors(make, hold: str) -> list[float]:
    """Largest errors at the communication points, by macro step."""
    scene = make()
    reference = refer(resolve(scene), scene.recorded, continuous=True)
    scene.hold = hold
    found = []
    with Prepared(scene) as prepared:
        for step in STEPS:
            result = prepared.run(step=step)
            true = reference.values(result.time)
            found.append(
                max(
                    np.max(np.abs(result[path] - np.ravel(true[path]).astype(float)))
                    for path in scene.recorded
                )
            )
    return found


def step_for(error: float, found: list[float]) -> float:
    """The macro step for an error, along the line fitted in logarithms."""
    slope, at = np.polyfit(np.log(found), np.log(STEPS), 1)
    return float(math.exp(at + slope * math.log(error)))


@pytest.mark.parametrize(
    "name", ["shaken_wire", pytest.param("swaying_parabola", marks=pytest.mark.slow)]
)
def test_order_two_in_the_macro_step(name: str) -> None:
    zero, first = (errors(SCENES[name], hold) for hold in ("zero", "first"))
    orders = [np.polyfit(np.log(STEPS), np.log(found), 1)[0] for found in (zero, first)]
    table = {e: [step_for(e, found) for found in (zero, first)] for e in (1e-3, 1e-4, 1e-6)}
    assert abs(orders[0] - 1.0) < 0.1
    assert abs(orders[1] - 2.0) < 0.1
    assert table[1e-4][1] > 5.0 * table[1e-4][0]


def wire(step: float, drive, **settings: object) -> Scene:
    """A wire pushed along x; its motion is an integral of the drive alone."""
    scene = Scene("wire", stop_time=1.0, step=step, hold="first", **settings)  # type: ignore[arg-type]
    scene.add("bead", "BeadOnWire", {"model.formulation": "angle"})
    return scene.input("bead.wire.ax", drive).record("bead.wire.x", "bead.wire.vx")


@pytest.mark.parametrize("step", [0.3, 0.125, 0.03])
def test_tables_are_followed_exactly_jumps_included(step: float) -> None:
    """To 1 at 0.5 s, from there 3, down to 0 at the end, whatever the step."""
    table = ([0.0, 0.5, 0.5, 1.0], [0.0, 1.0, 3.0, 0.0])
    if step in (0.3, 0.03):  # corners within a step are cut: put them where steps end
        table = ([0.0, 0.6, 0.6, 0.9, 1.0], [0.0, 1.0, 3.0, 0.0, 0.0])
    result = wire(step, table).run()
    times, values = np.array(table[0]), np.array(table[1])
    v = np.sum(np.diff(times) * (values[1:] + values[:-1]) / 2)
    x = sum(
        h * h * (2 * a + b) / 6 + h * a_before
        for h, a, b, a_before in zip(
            np.diff(times), values[:-1], values[1:],
            np.cumsum([0.0, *(np.diff(times) * (values[1:] + values[:-1]) / 2)[:-1]]),
            strict=True,
        )
    )  # fmt: skip
    assert result["bead.wire.vx"][-1] == pytest.approx(v, rel=1e-12)
    assert result["bead.wire.x"][-1] == pytest.approx(x, rel=1e-12)


def test_a_function_that_jumps_where_a_step_ends() -> None:
    """A ramp before a jump would begin it a step early."""
    result = wire(0.1, lambda t: 0.0 if t < 0.5 - 1e-9 else 2.0).run()
    v = result["bead.wire.vx"]
    assert np.all(v[:6] == 0.0)
    assert v[-1] == pytest.approx(1.0, rel=1e-14)


def test_a_function_that_jumps_within_a_step_is_not_overshot() -> None:
    result = wire(0.1, lambda t: 0.0 if t < 0.537 else 2.0).run()
    gained = np.diff(result["bead.wire.vx"])
    assert np.all(gained >= 0.0)
    assert np.all(gained <= 0.2 + 1e-15)
    # late by part of a step at most
    assert abs(result["bead.wire.vx"][-1] - 2.0 * (1.0 - 0.537)) <= 0.2


def chain(step: float, hold: str, algorithm: str = "jacobi", *, jump: bool = False) -> Scene:
    """A bead whose force on its wire pushes another one."""
    scene = Scene("chain", stop_time=1.5, step=step, hold=hold, algorithm=algorithm)
    start = {"model.formulation": "angle", "solver.method": "adaptive", "solver.tolerance": 1e-11}
    scene.add("one", "BeadOnWire", {**start, "bead.angle_start": 1.0})
    scene.add("two", "BeadOnWire", start)
    scene.connect("one.wire.fx", "two.bead.fx", factor=-0.5)
    scene.connect("one.wire.fy", "two.bead.fy")
    if jump:
        scene.input("one.bead.fx", lambda t: 0.0 if t < 1.0 - 1e-10 else 5.0)
    return scene.record("two.bead.angle")


@pytest.mark.parametrize("jump", [False, True])
@pytest.mark.parametrize("algorithm", ["jacobi", "gauss_seidel"])
def test_connections_follow_the_derivative_of_their_source(algorithm: str, jump: bool) -> None:
    """Order 2 instead of 1, across a jump where a step ends too: nothing is carried over it."""
    true = chain(0.00125, "first", jump=jump).run()["two.bead.angle"][-1]
    orders = {}
    steps = [0.04, 0.02, 0.01, 0.005]
    for hold in ("zero", "first"):
        found = [
            abs(chain(h, hold, algorithm, jump=jump).run()["two.bead.angle"][-1] - true)
            for h in steps
        ]
        orders[hold] = np.polyfit(np.log(steps), np.log(found), 1)[0]
    assert abs(orders["zero"] - 1.0) < 0.2
    assert orders["first"] > 1.8


def test_overshoot_at_a_jump_that_nobody_tells_of() -> None:
    """The source's force jumps within a step: what was extrapolated is put right at its end.

    Until then the input is off by no more than the jump and the slope times the step.
    """
    step = 0.05

    def run(hold: str, h: float) -> float:
        scene = chain(h, hold)
        scene.input("one.bead.fx", lambda t: 0.0 if t < 0.523 else 5.0)
        return float(scene.run()["two.bead.angle"][-1])

    true = run("first", step / 64)
    assert abs(run("first", step) - true) <= 1.2 * abs(run("zero", step) - true)


@pytest.mark.parametrize("algorithm", ["jacobi", "gauss_seidel"])
@pytest.mark.parametrize("name", ["active_damping", "inverted_balance"])
def test_feedback_is_of_order_two(name: str, algorithm: str) -> None:
    """A control law's output rises as its measurements do: what it drives follows."""
    steps = [0.02, 0.01, 0.005, 0.0025]
    found: dict[str, list[float]] = {}
    scene = load_scene(name)
    scene.inputs.clear()  # the push: its jumps lie within some of the steps
    scene.stop_time = 1.0
    scene.algorithm = algorithm
    scene.set("plant.solver.tolerance", 1e-10)
    true = None
    for hold in ("first", "zero"):
        scene.hold = hold
        with Prepared(scene) as prepared:
            if true is None:
                true = prepared.run(step=steps[-1] / 6)["plant.pendulum.angle"][-1]
            ends = [prepared.run(step=h)["plant.pendulum.angle"][-1] for h in steps]
        found[hold] = [abs(end - true) for end in ends]
    orders = {hold: np.polyfit(np.log(steps), np.log(e), 1)[0] for hold, e in found.items()}
    assert abs(orders["zero"] - 1.0) < 0.15
    assert abs(orders["first"] - 2.0) < 0.15
    assert found["first"][1] < 0.1 * found["zero"][1]


@pytest.mark.parametrize("pushing", [False, True])
def test_a_component_is_asked_once_unless_another_needs_it_before(
    monkeypatch: pytest.MonkeyPatch, pushing: bool
) -> None:
    """The drive's feedback waits for the plant's rates; what it pushes on the bead, for it."""
    scene = load_scene("inverted_balance")
    scene.hold = "first"
    if pushing:
        scene.add("bead", "BeadOnWire").connect("plant.parabola.fx", "bead.bead.fx")
    asked: list[tuple[str, int]] = []
    prepare = Exchange.prepare

    def noted(self: Exchange, instance: Instance, function: str, *given: object) -> object:
        if function == "GetRealOutputDerivatives":
            asked.append((instance.name, len(given[0])))
        return prepare(self, instance, function, *given)

    monkeypatch.setattr(Exchange, "prepare", noted)
    with Prepared(scene) as prepared:
        prepared.run(stop_time=scene.step)
    assert asked == [("plant", 6), ("drive", 3), *([("plant", 1)] if pushing else [])]


@pytest.mark.parametrize("algorithm", ["strang", "midpoint"])
def test_not_with_algorithms_that_hold_on_purpose(algorithm: str) -> None:
    with pytest.raises(CurveboundError, match="hold is 'first' with algorithm"):
        chain(0.1, "first", algorithm).check()
    with pytest.raises(CurveboundError, match="hold is 'second'"):
        chain(0.1, "second").check()


def test_what_cannot_be_sloped_is_held(gain_fmu) -> None:
    scene = Scene("held", stop_time=1.0, step=0.25, hold="first").add("a", gain_fmu).record("a.y")
    scene.input("a.u", lambda t: t)
    assert list(scene.run()["a.y"]) == [0.0, 0.25, 0.5, 0.75, 1.0]


def test_adaptive_macro_steps_and_settings() -> None:
    scene = wire(0.1, lambda t: 3.0 * math.sin(4.0 * t), adaptive=Adaptive(1e-5))
    result = scene.run()
    assert result["bead.wire.x"][-1] == pytest.approx(0.75 - 3.0 * math.sin(4.0) / 16.0, abs=1e-5)
    assert result.settings["hold"] == "first"
    assert scene.set("hold", "zero").hold == "zero"


def test_ssp_keeps_it(tmp_path) -> None:
    scene = chain(0.1, "first")
    assert load_scene(write_ssp(scene, tmp_path / "chain.ssp")).hold == "first"

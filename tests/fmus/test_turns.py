"""Angles stay continuous over any number of turns, at any speed and step."""

from __future__ import annotations

import math
import random
from typing import Any

import mpmath
import pytest

from curvebound.fmi.folder import find
from curvebound.kernel.angles import TURN, TURN_REST, reduce_angle, unwind
from curvebound.kernel.rk4 import RK4

bead_on_wire = find("BeadOnWire").module("kernel").model
parabola_pendulum = find("ParabolaPendulum").module("kernel").model

ANGLE = {"model.formulation": 2, "constraint.stabilization": 3}
CARTESIAN = [{"model.formulation": 1, "constraint.stabilization": n} for n in (1, 2, 3)]
NONLINEAR = {"model.fidelity": 2}


def test_two_pi_has_two_parts() -> None:
    with mpmath.workdps(50):
        assert mpmath.mpf(TURN) + mpmath.mpf(TURN_REST) == pytest.approx(2 * mpmath.pi, rel=1e-31)


@pytest.mark.parametrize("angle", [0.0, 3.0, -3.2, 6.3, 1e3, -1e6, 1e9, 12345678.901])
def test_reduction_is_exact(angle: float) -> None:
    rest, turns = reduce_angle(angle)
    assert abs(rest) <= 3.15
    assert turns == int(turns)
    with mpmath.workdps(50):
        true = mpmath.mpf(angle) - int(turns) * 2 * mpmath.pi
        assert abs(rest - true) <= 5e-16
    assert unwind(rest, turns) == angle


#: on and beside the upward ray, where the angle to begin with may round to the other side
STARTS = [0.0, 1.0, *(n * math.pi for n in (-7, -3, -1, 1, 3, 5, 33)), 100.0]


@pytest.mark.parametrize("choices", CARTESIAN, ids=["none", "baumgarte", "projection"])
@pytest.mark.parametrize("start", STARTS)
def test_turns_of_a_free_bead(
    choices: dict[str, int], start: float, bead_defaults: dict[str, float], outputs: Any
) -> None:
    for rate in (0.05, -2.9, 3.1, -3.3, 6.2, -6.4, 1000.3):
        turns_at(rate, choices, start, bead_defaults, outputs)


def turns_at(
    rate: float,
    choices: dict[str, int],
    start: float,
    bead_defaults: dict[str, float],
    outputs: Any,
) -> None:
    # one radian per second times `rate` per step of one second, placed exactly by hand
    model = bead_on_wire(choices)
    free = {
        **bead_defaults,
        "gravity.y": 0.0,
        "wire.radius": 2.0,
        "bead.angle_start": start,
        "bead.angular_velocity_start": rate,
    }
    model.start(free, choices)
    assert outputs(model)["bead.angle"] == pytest.approx(start, abs=1e-15, rel=1e-15)
    for i in range(1, 40):
        angle = start + rate * i
        model.q0, model.q1 = 2.0 * math.sin(angle), -2.0 * math.cos(angle)
        model.v0, model.v1 = 2.0 * rate * math.cos(angle), 2.0 * rate * math.sin(angle)
        model.settle(1.0)
        assert outputs(model)["bead.angle"] == pytest.approx(angle, abs=1e-10)


@pytest.mark.parametrize("choices", CARTESIAN, ids=["none", "baumgarte", "projection"])
def test_upward_ray_itself(
    choices: dict[str, int], bead_defaults: dict[str, float], outputs: Any
) -> None:
    model = bead_on_wire(choices)
    model.start({**bead_defaults, "gravity.y": 0.0, "bead.angle_start": 3.0}, choices)
    for x, y in ((0.0, 1.0), (-0.1, 1.0), (-0.0, 1.0), (0.1, 1.0), (0.0, 1.0), (-0.1, 1.0)):
        model.q0, model.q1 = x, y
        model.settle(1e-6)
        # to the left of the upward ray the angle is above pi
        assert outputs(model)["bead.angle"] == pytest.approx(math.pi - math.atan2(x, y), abs=1e-12)


@pytest.mark.parametrize("choices", CARTESIAN, ids=["none", "baumgarte", "projection"])
@pytest.mark.parametrize(("rate", "step"), [(6.4, 1e-3), (-9.0, 5e-3), (25.0, 5e-3)])
def test_both_formulations_count_the_same_turns(
    choices: dict[str, int], rate: float, step: float, bead_defaults: dict[str, float], outputs: Any
) -> None:
    start = {
        **bead_defaults,
        "bead.angle_start": 0.3,
        "bead.angular_velocity_start": rate,
        "bead.damping": 0.1,
    }
    angles = []
    for c in (choices, ANGLE):
        model = bead_on_wire(c)
        model.start(start, c)
        found = []
        for _ in range(60):
            RK4().advance(model, 0.1, round(0.1 / step), 0.0, 1000)
            model.advance_frame(0.1)
            found.append(outputs(model)["bead.angle"])
        angles.append(found)
    assert max(abs(a - b) for a, b in zip(*angles, strict=True)) < 0.5
    assert max(map(abs, angles[0])) > 3.5


def test_large_steps_in_a_field(
    bead_defaults: dict[str, float], outputs: Any, rng: random.Random
) -> None:
    """The step may be far beyond half a turn, and gravity changes the rate within it."""
    choices = CARTESIAN[2]
    most = 0.0
    for _ in range(40):
        spin = {
            **bead_defaults,
            "bead.angle_start": rng.uniform(-3.0, 3.0),
            "bead.angular_velocity_start": rng.uniform(-25.0, 25.0),
        }
        fine = bead_on_wire(ANGLE)
        fine.start(spin, ANGLE)
        coarse = bead_on_wire(choices)
        coarse.start(spin, choices)
        step = rng.uniform(0.1, 1.0)
        for _ in range(5):
            before = outputs(fine)["bead.angle"]
            RK4().advance(fine, step, 100, 0.0, 100)
            coarse.q0, coarse.q1, coarse.v0, coarse.v1 = fine.relative()
            coarse.settle(step)
            angle = outputs(fine)["bead.angle"]
            most = max(most, abs(angle - before))
            assert outputs(coarse)["bead.angle"] == pytest.approx(angle, abs=1e-12, rel=1e-12)
    assert most > 15.0


@pytest.mark.parametrize("kind", ["bead", "pendulum"])
def test_turning_that_begins_later(
    kind: str, bead_defaults: dict[str, float], parabola_defaults: dict[str, float], outputs: Any
) -> None:
    """Too slow to turn over at the start, but then forces take the weight away."""

    def new() -> Any:
        if kind == "bead":
            model = bead_on_wire(ANGLE)
            model.start({**bead_defaults, "bead.angular_velocity_start": 3.0}, ANGLE)
            model.set_inputs([0.0, 0.0, 0.0, 9.81], 0)
        else:
            model = parabola_pendulum(NONLINEAR)
            heavy = {"slider.mass": 1e6, "pendulum.angular_velocity_start": 3.0}
            model.start({**parabola_defaults, **heavy}, NONLINEAR)
            model.set_inputs([0.0, -9.81, 0.0, 0.0, 0.0, 0.0, 0.0], 0)
        return model

    model = new()
    assert not model.settles
    for _ in range(40):
        model.keep()
        RK4().advance(model, 0.25, 25, 0.0, 25)
        model.advance_frame(0.25)
    assert model.settles
    assert abs(model.q0 if kind == "bead" else model.q1) < TURN + 1.0
    angle = outputs(model)["bead.angle" if kind == "bead" else "pendulum.angle"]
    assert angle > 20.0
    other = new()
    other.set_state(model.get_state())
    assert other.settles
    model.keep()
    RK4().advance(model, 30.0, 3000, 0.0, 3000)
    assert abs(model.q0 if kind == "bead" else model.q1) < TURN + 0.1
    RK4().advance(other, 30.0, 3000, 0.0, 3000)
    assert other.get_state() == model.get_state()


def test_many_turns_lose_nothing_in_the_bead(bead_defaults: dict[str, float], outputs: Any) -> None:
    motions = []
    for turns in (0, 2**40):
        model = bead_on_wire(ANGLE)
        model.start({**bead_defaults, "bead.angular_velocity_start": 20.0}, ANGLE)
        model.turns += turns
        RK4().advance(model, 10.0, 10000, 0.0, 10000)
        model.advance_frame(10.0)
        out = outputs(model)
        motions.append((out["bead.x"], out["bead.y"], out["bead.vx"], out["bead.vy"]))
        assert out["bead.angle"] == pytest.approx(TURN * turns + 200.0, abs=20.0, rel=1e-12)
        assert abs(model.q0) <= TURN + 0.1
    assert motions[0] == motions[1]


def test_angle_start_may_hold_many_turns(
    bead_defaults: dict[str, float], parabola_defaults: dict[str, float], outputs: Any
) -> None:
    for angle in (1e6, -12345.6):
        for choices in (ANGLE, *CARTESIAN):
            model = bead_on_wire(choices)
            model.start({**bead_defaults, "bead.angle_start": angle}, choices)
            out = outputs(model)
            assert out["bead.angle"] == pytest.approx(angle, rel=1e-15)
            assert out["bead.x"] == pytest.approx(math.sin(angle), abs=4e-16)
        for fidelity in (1, 2):
            pendulum = parabola_pendulum({"model.fidelity": fidelity})
            pendulum.start({**parabola_defaults, "pendulum.angle_start": angle}, {})
            out = outputs(pendulum)
            assert out["pendulum.angle"] == angle
            x = out["slider.x"] + math.sin(angle)
            assert out["pendulum.x"] == pytest.approx(x, abs=4e-16)


@pytest.mark.parametrize("cut", [1, 10, 1000])
def test_turning_pendulum(cut: int, parabola_defaults: dict[str, float], outputs: Any) -> None:
    """Three seconds of turning over, in one communication step or many: same angle, small state."""
    start = {
        **parabola_defaults,
        "slider.mass": 50.0,
        "pendulum.angular_velocity_start": -25.0,
    }
    model = parabola_pendulum(NONLINEAR)
    model.start(start, NONLINEAR)
    # the same motion without taking turns out of the state
    raw = parabola_pendulum(NONLINEAR)
    raw.start(start, NONLINEAR)
    raw.settles = False
    RK4().advance(raw, 3.0, 9000, 0.0, 9000)
    for _ in range(cut):
        RK4().advance(model, 3.0 / cut, 9000 // cut, 0.0, 9000)
        model.advance_frame(3.0 / cut)
    out = outputs(model)
    assert out["pendulum.angle"] == pytest.approx(raw.q1, abs=1e-8)
    assert out["pendulum.angle"] < -40.0
    assert abs(model.q1) <= TURN + 0.1
    assert abs(out["energy.residual"]) < 1e-6

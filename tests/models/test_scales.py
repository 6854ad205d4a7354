"""The sizes by which methods measure errors and turns are counted, in closed form.

A wrong one changes no result that a bound on errors would notice, but reserves and costs.
"""

from __future__ import annotations

import math
from typing import Any

import pytest

from curvebound.models.bead_on_wire import bead_on_wire
from curvebound.models.parabola_pendulum import parabola_pendulum

ANGLE = {"model.formulation": 2, "constraint.stabilization": 3}
CARTESIAN = {"model.formulation": 1, "constraint.stabilization": 3}
NONLINEAR = {"model.fidelity": 2}

Defaults = dict[str, float]


def bead(choices: dict[str, int], defaults: Defaults, **changes: float) -> Any:
    model = bead_on_wire(choices)
    named = {name.replace("_", ".", 1): value for name, value in changes.items()}
    model.start({**defaults, **named}, choices)
    return model


def pendulum(defaults: Defaults, **changes: float) -> Any:
    model = parabola_pendulum(NONLINEAR)
    named = {name.replace("_", ".", 1): value for name, value in changes.items()}
    model.start({**defaults, **named}, NONLINEAR)
    return model


def test_the_load_of_the_bead_is_the_field_in_which_it_is(bead_defaults: Defaults) -> None:
    """Gravity (1, -2), the wire accelerated by (0.5, 0.25), a force of (3, 5) N on 2 kg."""
    setting = {"gravity_x": 1.0, "gravity_y": -2.0, "bead_mass": 2.0, "wire_radius": 4.0}
    for choices, per in ((CARTESIAN, 1.0), (ANGLE, 4.0)):
        model = bead(choices, bead_defaults, **setting)
        assert model.load == pytest.approx(3.0 / per)
        model.set_inputs([0.5, 0.25, 3.0, 5.0], 0)
        assert model.load == pytest.approx((2.0 + 0.25) / per)


def test_scales_and_coupling(bead_defaults: Defaults, parabola_defaults: Defaults) -> None:
    made = bead(CARTESIAN, bead_defaults, wire_radius=4.0)
    assert (made.q0_scale, made.q1_scale, made.coupling) == (4.0, 4.0, 1.0)
    made = bead(ANGLE, bead_defaults, wire_radius=4.0)
    assert (made.q0_scale, made.coupling) == (1.0, 1.0)
    made = pendulum(parabola_defaults, pendulum_length=3.0)
    assert (made.q0_scale, made.q1_scale, made.coupling) == (3.0, 1.0, 1e-6)


@pytest.mark.parametrize(("x", "y"), [(0.0, -9.81), (3.0, -4.0), (0.0, 2.0), (-5.0, 0.0)])
@pytest.mark.parametrize("angle", [0.0, 0.7, -2.5])
def test_a_bead_that_can_turn_over_settles_from_the_start(
    bead_defaults: Defaults, x: float, y: float, angle: float
) -> None:
    """It can where its energy reaches that of the highest point, but for a thousandth."""
    r, g = 2.0, math.hypot(x, y)
    potential = -r * (x * math.sin(angle) - y * math.cos(angle))  # per mass
    for share, turns in ((0.9985, False), (0.9995, True), (1.01, True)):
        # share of the highest potential that is reached
        missing = share * r * g - potential
        if missing < 0.0:
            continue
        rate = math.sqrt(2.0 * missing) / r
        model = bead(
            ANGLE, bead_defaults, gravity_x=x, gravity_y=y, wire_radius=r,
            bead_angle_start=angle, bead_angular_velocity_start=rate,
        )  # fmt: skip
        assert model.settles is turns


def test_a_rod_that_turns_fast_settles_from_the_start(parabola_defaults: Defaults) -> None:
    """Above the rate with which it would turn over on a support at rest, 2 sqrt(g / r)."""
    for factor in (0.99, 1.01):
        rate = factor * 2.0 * math.sqrt(5.0 / 3.0)
        model = pendulum(
            parabola_defaults, gravity_x=3.0, gravity_y=-4.0, pendulum_length=3.0,
            pendulum_angular_velocity_start=rate,
        )  # fmt: skip
        assert model.settles is (factor > 1.0)


def test_the_swing_bounds_what_the_field_adds_to_the_spin(bead_defaults: Defaults) -> None:
    """From one end of the field to the other the square of p x v grows by 4 |e| r^3."""
    r = 2.0
    model = bead(CARTESIAN, bead_defaults, gravity_x=3.0, gravity_y=-4.0, wire_radius=r)
    assert model.swing == pytest.approx(4.0 * 5.0 * r**3)
    fastest = math.sqrt(2.0 * 5.0 * 2.0 * r) * r  # of a bead that fell from the highest point
    assert model.swing == pytest.approx(fastest**2)


@pytest.mark.parametrize(("m1", "m2", "mass"), [(2.0, 1.0, 1.0), (0.25, 8.0, 32.0)])
def test_errors_are_magnified_by_mass_ratio_and_slope(
    parabola_defaults: Defaults, m1: float, m2: float, mass: float
) -> None:
    setting = {"slider_mass": m1, "pendulum_mass": m2}
    flat = {**setting, "parabola_coefficient_start": 0.0}
    assert pendulum(parabola_defaults, **flat).magnification == pytest.approx(mass)
    steep = {**setting, "parabola_coefficient_start": -3.0, "slider_u_start": 2.0}
    assert pendulum(parabola_defaults, **steep).magnification == pytest.approx(12.0 * mass)
    # one that moves rises as far as its speed along the parabola carries it
    speed = 0.5 * math.sqrt(1.0 + 12.0**2)
    reached = 12.0 + math.sqrt(2.0 * 3.0 * speed**2 / 9.81)
    moving = pendulum(parabola_defaults, **steep, slider_u_rate_start=0.5)
    assert moving.magnification == pytest.approx(reached * mass)

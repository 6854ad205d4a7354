"""The sizes by which methods measure errors and turns are counted, in closed form.

A wrong one changes no result that a bound on errors would notice, but reserves and costs.
"""

from __future__ import annotations

import math
from typing import Any

import pytest

from curvebound.fmi.folder import find

bead_on_wire = find("BeadOnWire").module("kernel").model
parabola_pendulum = find("ParabolaPendulum").module("kernel").model

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


def test_scales(bead_defaults: Defaults, parabola_defaults: Defaults) -> None:
    made = bead(CARTESIAN, bead_defaults, wire_radius=4.0)
    assert (made.q0_scale, made.q1_scale) == (4.0, 4.0)
    made = bead(ANGLE, bead_defaults, wire_radius=4.0)
    assert made.q0_scale == 1.0
    made = pendulum(parabola_defaults, pendulum_length=3.0)
    assert (made.q0_scale, made.q1_scale) == (3.0, 1.0)


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


@pytest.mark.parametrize("t", [0.0, 0.4])
def test_energies_within_a_step(
    bead_defaults: Defaults, parabola_defaults: Defaults, t: float
) -> None:
    """With the frame where it is by then, and the size of what cancels in the potential one."""
    frame = {"x": 0.3, "y": -0.8, "vx": 0.5, "vy": 0.7}
    ax, ay, g = 1.5, -2.5, (2.0, -3.0)
    at = [
        frame["x"] + t * (frame["vx"] + 0.5 * t * ax),
        frame["y"] + t * (frame["vy"] + 0.5 * t * ay),
    ]
    moves = [frame["vx"] + t * ax, frame["vy"] + t * ay]
    field = {"gravity_x": g[0], "gravity_y": g[1]}

    def prepared(model: Any, inputs: list[float]) -> Any:
        for name, value in frame.items():
            setattr(model, name, value)
        model.set_inputs(inputs, 0)
        return model

    for choices in (ANGLE, CARTESIAN):
        setting = {"wire_radius": 2.0, "bead_mass": 3.0, "bead_angle_start": 0.6}
        made = bead(choices, bead_defaults, **field, **setting, bead_angular_velocity_start=1.2)
        model = prepared(made, [ax, ay, 0.0, 0.0])
        p = [at[0] + 2.0 * math.sin(0.6), at[1] - 2.0 * math.cos(0.6)]
        v = [moves[0] + 2.4 * math.cos(0.6), moves[1] + 2.4 * math.sin(0.6)]
        model.energies_at(t)
        assert (model.kinetic, model.potential, model.potential_size) == pytest.approx(
            (
                1.5 * math.hypot(*v) ** 2,
                -3.0 * (g[0] * p[0] + g[1] * p[1]),
                3.0 * (abs(g[0] * p[0]) + abs(g[1] * p[1])),
            )
        )
    m1, m2, r, u, u1, angle, turn = 2.0, 3.0, 1.5, 0.7, -0.4, 0.9, 1.1
    made = pendulum(
        parabola_defaults, **field, slider_mass=m1, pendulum_mass=m2, pendulum_length=r,
        slider_u_start=u, slider_u_rate_start=u1, pendulum_angle_start=angle,
        pendulum_angular_velocity_start=turn, parabola_coefficient_start=0.6,
        parabola_coefficient_rate_start=0.3,
    )  # fmt: skip
    model = prepared(made, [ax, ay, -0.5, 0.0, 0.0, 0.0, 0.0])
    a, rate = 0.6 + 0.3 * t - 0.25 * t * t, 0.3 - 0.5 * t
    s = [at[0] + u, at[1] + a * u * u]
    w = [moves[0] + u1, moves[1] + 2.0 * a * u * u1 + rate * u * u]
    b = [s[0] + r * math.sin(angle), s[1] - r * math.cos(angle)]
    z = [w[0] + r * turn * math.cos(angle), w[1] + r * turn * math.sin(angle)]
    model.energies_at(t)
    assert (model.kinetic, model.potential, model.potential_size) == pytest.approx(
        (
            0.5 * (m1 * math.hypot(*w) ** 2 + m2 * math.hypot(*z) ** 2),
            -sum(g[i] * (m1 * s[i] + m2 * b[i]) for i in (0, 1)),
            sum(abs(g[i]) * ((m1 + m2) * abs(s[i]) + m2 * r) for i in (0, 1)),
        )
    )

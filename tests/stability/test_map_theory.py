"""Boundaries of linear theory against closed forms and against the methods themselves."""

from __future__ import annotations

import math
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from curvebound.fmi.folder import find
from curvebound.kernel.methods import METHODS, create
from curvebound.mechanics.derive import derive_text
from curvebound.study.reference.motion import Motion
from curvebound.study.stability.probe import Probe
from curvebound.study.stability.ranges import sampled
from curvebound.study.stability.theory import (
    FACTOR,
    LIMITED,
    boundary,
    jacobians,
    step_matrix,
    swings,
)

parabola_pendulum = find("ParabolaPendulum").module("kernel").model


def oscillator(omega: float, damping: float = 0.0) -> np.ndarray:
    """q'' = -omega^2 q - damping q'."""
    return np.array([[0.0, 1.0], [-omega * omega, -damping]])


VALUES = {
    "gravity.x": 0.0,
    "gravity.y": -9.81,
    "parabola.coefficient_start": 0.5,
    "parabola.coefficient_rate_start": 0.0,
    "slider.mass": 1.0,
    "pendulum.mass": 3.0,
    "pendulum.length": 0.7,
    "slider.damping": 0.4,
    "pendulum.damping": 0.9,
    "slider.u_start": 0.0,
    "slider.u_rate_start": 0.0,
    "pendulum.angle_start": 0.0,
    "pendulum.angular_velocity_start": 0.0,
}


@pytest.mark.parametrize("method", LIMITED)
@pytest.mark.parametrize("h", [0.01, 0.3])
def test_the_step_matrix_is_what_the_integrator_does(method: str, h: float) -> None:
    """One step of the kernel's own integrator from each unit vector, damped and coupled."""
    choices = {"model.fidelity": 1}
    model = parabola_pendulum(choices)
    model.start(VALUES, choices)
    still = {**dict.fromkeys(model.INPUTS, 0.0), "model.fidelity": "linear"}
    motion = Motion(sampled("ParabolaPendulum")[1], {**VALUES, **still})
    (a,) = jacobians(motion, np.zeros((4, 1)))
    measured = np.zeros((4, 4))
    for i in range(4):
        start = [0.0] * 4
        start[i] = 1.0
        model.q0, model.q1, model.v0, model.v1 = start
        create(METHODS.index(method) + 1).advance(model, h, 1, 1e-6, 10)
        measured[:, i] = model.q0, model.q1, model.v0, model.v1
    expected = step_matrix(method, a, h)
    assert np.abs(measured - expected).max() < 1e-13 * np.abs(expected).max()


def test_how_far_a_unit_of_a_coordinate_moves_a_mass() -> None:
    """The slider along y = u^2/2 at u = 2: sqrt(1 + u^2); the bob on its rod: the length."""
    derived = sampled("ParabolaPendulum")[1]
    still = dict.fromkeys(parabola_pendulum({"model.fidelity": 2}).INPUTS, 0.0)
    motion = Motion(derived, {**VALUES, **still, "slider.u_start": 2.0})
    assert motion.reach(0) == pytest.approx(math.sqrt(5.0), rel=1e-14)
    assert motion.reach(1) == motion.unit() == pytest.approx(0.7, rel=1e-14)


def parabola(**start: float) -> tuple[Any, dict[str, Any]]:
    """A bead on y = 2 x^2, without gravity and damping, and its values."""
    derived = sampled(Path(__file__).parents[1] / "mechanics" / "systems" / "bead_on_parabola")[1]
    values = {v.name: 0.0 for v in derived.variables} | {"gravity.x": 0.0, "gravity.y": 0.0}
    return derived, {**values, "bead.mass": 1.0, "wire.coefficient": 2.0, **start}


def test_how_far_a_bead_goes_until_its_path_has_turned() -> None:
    """(1, 4 x) along the path turns by (0, 4) per length."""
    derived, values = parabola(**{"bead.u_start": 0.3, "bead.u_rate_start": 1.0})
    motion = Motion(derived, values)
    assert motion.unit() == pytest.approx(math.hypot(1.0, 1.2) / 4.0, rel=1e-14)
    there = motion.unit(0.0, np.array([[0.0, -0.3], [0.0, 0.0]]), np.ones((2, 2)))
    assert there == pytest.approx([0.25, math.hypot(1.0, 1.2) / 4.0], rel=1e-14)


BENDING = """
from curvebound.mechanics import Mechanics, length, mass, shape
x, a = length("bead.u"), shape("wire.bend")
MECHANICS = Mechanics([x], [mass("bead", x, a * x**2)])
"""


def test_how_far_it_goes_along_a_wire_that_bends() -> None:
    """y = (1 + t) x^2: from one turn per 2 m^-1 to one per 4."""
    derived = derive_text(BENDING, "Bending", "here")
    values = {v.name: 0.0 for v in derived.variables} | {"gravity.x": 3.0, "gravity.y": 0.0}
    bend = {"wire.bend_start": 1.0, "wire.bend_rate_start": 1.0}
    motion = Motion(derived, {**values, "bead.mass": 1.0, **bend})
    assert motion.unit() == pytest.approx(0.5, rel=1e-14)
    times, rest = np.array([0.0, 1.0]), np.zeros((2, 2))
    assert motion.unit(times, rest, rest) == pytest.approx([0.5, 0.25], rel=1e-14)
    # where the slope vanishes: the root of acceleration over that size
    assert motion.rates(times, rest, rest) == pytest.approx([6.0**0.5, 12.0**0.5], rel=1e-14)


def test_the_boundary_along_a_motion_is_where_it_is_fastest() -> None:
    """x'' = -16 x x'^2 / (1 + 16 x^2) swings about x = 0 with 4 x', and does nothing at rest."""
    probe = Probe.__new__(Probe)
    probe.alone, probe.duration, probe.states = True, 1e4, ["x", "v"]
    probe.derived, probe._values = parabola()
    probe.variable, probe.model = "bead.mass", ""
    exact = {"x": np.zeros(3), "v": np.array([1.0, 3.0, 2.0])}
    probe._exact = lambda value: (exact, "")  # type: ignore[method-assign, assignment]
    at_rest, moving = probe.linear_boundaries(1.0, "rk4", 1e-6, 1.0)
    assert at_rest == math.inf
    assert moving == pytest.approx(2.0 * math.sqrt(2.0) / 12.0, rel=1e-3)


@pytest.mark.parametrize("omega", [1e-3, 3.1, 4e5])
def test_oscillators_end_where_the_stability_functions_say(omega: float) -> None:
    """|R(i y)| = 1 at y = 2 sqrt 2 (RK4), the trace's bound at y = 2 (semi-implicit Euler)."""
    a, run = oscillator(omega), 100.0 / omega
    for method, y in (("rk4", 2.0 * math.sqrt(2.0)), ("semi_implicit_euler", 2.0)):
        found = boundary(method, a, run, 1e-6 / omega, 10.0 / omega) * omega
        assert y <= found < 1.01 * y  # a hair beyond: growth takes time
        longer = boundary(method, a, 1e6 * run, 1e-6 / omega, 10.0 / omega) * omega
        assert longer == pytest.approx(y, rel=1e-5)
    found = boundary("explicit_euler", a, run, 1e-9 / omega, 10.0 / omega) * omega
    # (1 + y^2)^(100 / y) = FACTOR
    assert 100.0 / found * math.log1p(found * found) == pytest.approx(math.log(FACTOR), rel=1e-9)


@pytest.mark.parametrize(
    ("method", "z"),
    # zeros of |R(-z)| - 1: 1 - z = -1; 1 - z + z^2/2 - z^3/6 + z^4/24 = 1
    [("explicit_euler", 2.0), ("rk4", 2.785293563405282), ("semi_implicit_euler", 2.0)],
)
def test_damping_ends_at_the_real_bound(method: str, z: float) -> None:
    rate = 7.0
    found = boundary(method, oscillator(0.0, rate), 1e6, 1e-6, 1e2) * rate
    assert found == pytest.approx(z, rel=1e-4)


def test_beyond_what_is_asked_there_is_no_number() -> None:
    a = oscillator(1.0)
    assert boundary("rk4", a, 10.0, 1e-3, 1e-2) == math.inf
    assert boundary("rk4", a, 1e6, 5.0, 10.0) == 0.0


def test_true_growth_is_no_instability() -> None:
    """An inverted pendulum falls: the method may grow as fast as the motion."""
    a = np.array([[0.0, 1.0], [4.0, 0.0]])
    assert not swings(a)
    assert swings(oscillator(2.0))
    assert boundary("rk4", a, 10.0, 1e-6, 1e3) > 1.0

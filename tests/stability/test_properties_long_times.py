"""A million seconds and hundreds of millions of radians: neither time nor turns cost digits."""

from __future__ import annotations

import math

import mpmath as mp
import numpy as np
import pytest
from properties import run

FREE = {"gravity.y": 0.0, "bead.angle_start": 1.0}


@pytest.mark.parametrize("formulation", ["angle", "lagrange_multiplier"])
def test_a_bead_that_turns_for_a_million_seconds(formulation: str) -> None:
    """Free, at 300 rad/s: 3e8 rad, known exactly."""
    rate = 300.0 if formulation == "angle" else 0.3
    found = run(
        "bead",
        {
            **FREE,
            "model.formulation": formulation,
            "bead.angular_velocity_start": rate,
            "solver.method": "adaptive",
            "solver.tolerance": 1e-12,
        },
        1e3,
        1000,
    )
    with mp.workdps(40):
        end = 1 + mp.mpf(rate) * mp.mpf(10) ** 6
        # the angle form only adds: to the last digit of an angle of this size
        allowed = abs(end) * (4e-16 if formulation == "angle" else 1e-9)
        assert abs(mp.mpf(float(found["bead.angle"][-1])) - end) <= allowed
    assert abs(found["constraint.drift"][-1]) < 1e-14
    assert found["bead.angular_velocity"][-1] == pytest.approx(rate, rel=1e-10)


def test_a_slow_pendulum_over_a_million_seconds() -> None:
    """Normal modes in 40 digits after 1e6 s, in steps of 1000 s, a multiple of no period."""
    found = run("pendulum", {"model.fidelity": "linear", "solver.method": "exact"}, 1e3, 1000)
    with mp.workdps(40):
        a = mp.matrix(4, 4)
        a[0, 2] = a[1, 3] = 1
        g = mp.mpf("9.81")
        a[2, 0], a[2, 1], a[3, 0], a[3, 1] = -2 * g, g, 2 * g, -2 * g
        # by the eigenvalues -w^2 = g (-2 +- sqrt 2)
        start = mp.mpf("0.5"), mp.mpf("0.5")
        root = mp.sqrt(2)
        one, two = (start[0] * root + start[1]) / 2, (start[1] - start[0] * root) / 2
        slow, fast = mp.sqrt(g * (2 - root)), mp.sqrt(g * (2 + root))
        t = mp.mpf(10) ** 6
        th = one * mp.cos(slow * t) + two * mp.cos(fast * t)
        u = (one * mp.cos(slow * t) - two * mp.cos(fast * t)) / root
        # 9.81 itself is rounded, by 4e-17 of itself: 1e-10 rad of phase
        assert float(found["slider.u"][-1]) == pytest.approx(float(u), abs=2e-9)
        assert float(found["pendulum.angle"][-1]) == pytest.approx(float(th), abs=2e-9)
    assert np.abs(found["energy.residual"]).max() < 1e-9


@pytest.mark.parametrize("method", ["rk4", "implicit", "adaptive"])
def test_turns_behind_do_not_matter(method: str) -> None:
    """The same swing a million turns on, but for the rounding of the angle where it started."""
    values = {"bead.angle_start": 1.0, "model.formulation": "angle", "solver.method": method}
    values |= {"solver.tolerance": 1e-11}
    here = run("bead", values, 0.1, 100)
    turns = 2.0 * math.pi * 2**20
    there = run("bead", {**values, "bead.angle_start": 1.0 + turns}, 0.1, 100)
    assert there["bead.angle"] - turns == pytest.approx(here["bead.angle"], abs=5e-9)
    assert there["bead.vx"] == pytest.approx(here["bead.vx"], abs=5e-8)
    assert there["solver.steps"][-1] == pytest.approx(here["solver.steps"][-1], rel=0.01)

"""A piece of the campaign: random motions against Taylor series in extended precision."""

from __future__ import annotations

import random

import numpy as np
import pytest
from campaign import PLANTS, Exact, campaign, difference, exact
from campaign_motions import Motion

pytest.importorskip("heyoka")


@pytest.mark.parametrize(
    ("name", "number", "hints"),
    [
        pytest.param("pendulum", 230, True, id="a guess told the size of the rates"),
        pytest.param("pendulum", 552, False, id="likewise, without hints"),
        pytest.param("bead", 80, True, id="sweeps that gain little were left too early"),
        pytest.param("bead", 319, True, id="likewise, at steps ten times as long"),
        pytest.param("bead", 1488, False, id="a thrown guess set the sizes"),
        pytest.param("pendulum", 174, False, id="likewise, after inputs that jump"),
        pytest.param("pendulum", 1551, False, id="likewise, by fifty times what is allowed"),
    ],
)
def test_motions_that_were_once_wrong(name: str, number: int, hints: bool) -> None:
    (outcome,) = campaign(name, 1, 1, number, (hints,))
    assert outcome.verdict == "right"


@pytest.mark.slow
@pytest.mark.parametrize("name", PLANTS)
def test_no_motion_is_wrong_in_silence(name: str) -> None:
    """With and without what models say of their motion beforehand."""
    outcomes = campaign(name, 150, 5)
    bad = [one for one in outcomes if one.verdict in ("wrong", "failed", "dear")]
    assert not bad
    assert sum(one.verdict == "doubtful" for one in outcomes) <= 2
    assert sum(one.verdict == "no reference" for one in outcomes) <= 30


def test_the_reference_has_the_known_digits() -> None:
    """45-digit Taylor series, 15 digits kept."""
    values = {
        "gravity.x": 0.0,
        "gravity.y": -9.81,
        "parabola.coefficient_start": 0.5,
        "slider.mass": 1.0,
        "pendulum.mass": 1.0,
        "pendulum.length": 1.0,
        "slider.damping": 0.0,
        "pendulum.damping": 0.0,
        "slider.u_start": 0.5,
        "pendulum.angle_start": 0.5,
        "slider.u_rate_start": 0.0,
        "pendulum.angular_velocity_start": 0.0,
    }
    found = exact(PLANTS["pendulum"], Motion(values, [[0.0] * 7] * 20, 0.5, 1e-9))
    assert found is not None
    known = (-0.112074121556804, -0.295201431642521, 1.11389439174177, 1.11460636851215)
    assert found.states[-1].astype(float) == pytest.approx(known, abs=3e-14)


def test_differences_are_relative_to_what_moves() -> None:
    motion = PLANTS["bead"].draw(random.Random(1))
    states = np.linspace(0.0, 0.5, 42).reshape(21, 2)
    other = states.copy()
    other[7, 1] += 0.25
    for largest in (0.5, 2.0):  # there, or between
        reference = Exact(states, np.array([0.5, largest]), 1)
        assert difference(PLANTS["bead"], motion, reference, states) == 0.0
        assert difference(PLANTS["bead"], motion, reference, other) == 0.25 / largest

"""What errors grow to where a motion is unstable: rates, stretches and advice by closed forms."""

from __future__ import annotations

import math
from types import SimpleNamespace
from typing import Any

import pytest

from curvebound.kernel.growth import LEAST, MET, UNIT_ROUNDOFF, Growth, Stretch, growth_rate


def model(**slopes: float) -> Any:
    """Accelerations with these derivatives, a0_q1 and so on; the others are zero."""
    names = [f"a{i}_{x}{k}" for i in (0, 1) for x in "qv" for k in (0, 1)]
    given = dict.fromkeys(names, 0.0) | slopes
    return SimpleNamespace(
        **given, q0=0.0, q1=0.0, v0=0.0, v1=0.0, jacobian=lambda t, q0, q1, v0, v1: None
    )


@pytest.mark.parametrize(
    ("slopes", "rate"),
    [
        ({"a0_q0": 4.0}, 2.0),
        ({"a1_q1": 9.0, "a0_q0": 4.0}, 3.0),
        # 1 and 3 are the roots of the square of what [[2, 1], [1, 2]] makes of the coordinates
        ({"a0_q0": 2.0, "a1_q1": 2.0, "a0_q1": 1.0, "a1_q0": 1.0}, math.sqrt(3.0)),
        ({"a0_q0": 1.0, "a1_q1": 4.0, "a0_q1": 2.0, "a1_q0": 5.0}, math.sqrt(6.0)),
        # x'' = 4 x - 3 x' has exp(t)
        ({"a0_q0": 4.0, "a0_v0": -3.0, "a1_v1": -3.0}, 1.0),
        # the coordinate that is damped less decides, and what drives is no damping
        ({"a0_q0": 4.0, "a0_v0": -3.0, "a1_v1": -9.0}, 1.0),
        ({"a0_q0": 4.0, "a0_v0": 3.0, "a1_v1": -3.0}, 2.0),
        # rests that are stable, and turns about them
        ({"a0_q0": -4.0}, 0.0),
        ({"a0_q1": 1.0, "a1_q0": -1.0}, 0.0),
        # rounding of something large
        ({"a0_q0": -1e6, "a1_q1": 0.9}, 0.0),
        ({"a0_q0": -1e6, "a1_q1": 1.21}, 1.1),
    ],
)
def test_rates_of_growth(slopes: dict[str, float], rate: float) -> None:
    assert growth_rate(model(**slopes), 0.0) == pytest.approx(rate, rel=1e-10)


def test_no_rate_is_known_where_there_is_no_jacobian() -> None:
    for error in (NotImplementedError, ZeroDivisionError, ValueError):

        def fail(*_: Any, error: type[Exception] = error) -> None:
            raise error

        one = model(a0_q0=4.0)
        one.jacobian = fail
        assert growth_rate(one, 0.0) == 0.0


def test_a_stretch_adds_up_what_the_motion_shows() -> None:
    """Where coordinate and acceleration change alike, by the root of their ratio."""
    stretch = Stretch()
    assert not stretch.move(0.5, 0.25, 1.0, 3.0, 1e-6, 10.0, 2.0)
    assert (stretch.shown, stretch.span, stretch.way) == (1.0, 0.5, 0.25)
    assert (stretch.first, stretch.grown) == (2.0, 1.0)
    assert stretch.off == pytest.approx(MET * 1e-6 * 0.25**2, rel=1e-12, abs=0.0)
    assert stretch.made == pytest.approx(MET * 1e-6 * 3.0**2, rel=1e-12, abs=0.0)
    # the first rate stays, the way is at most there and back, the largest errors count
    assert not stretch.move(0.25, -9.0, -144.0, 1.0, 1e-7, 4.5, 7.0)
    assert (stretch.shown, stretch.span, stretch.way) == (2.0, 0.75, 9.0)
    assert stretch.first == 2.0
    assert stretch.off == pytest.approx(MET * 1e-7 * 9.0**2, rel=1e-12, abs=0.0)
    assert stretch.made == pytest.approx(MET * 1e-6 * 3.0**2, rel=1e-12, abs=0.0)
    stretch.move(0.25, 9.0, 9.0, 1.0, 1e-7, 4.5, 7.0)
    assert stretch.way == 9.0
    assert stretch.move(0.25, 1e-3, 1e-3, 1.0, 1e-7, 4.5, 7.0)
    # what goes back ends it, and its errors of steps stay known
    assert not stretch.move(0.25, 1.0, -1.0, 1.0, 1e-7, 4.5, 7.0)
    assert (stretch.shown, stretch.span, stretch.first, stretch.grown) == (0.0, 0.0, 0.0, 1.0)
    assert stretch.made > 0.0
    assert stretch.way > 0.0


def test_errors_grow_by_the_less_of_what_is_shown_and_what_the_slopes_allow() -> None:
    stretch = Stretch()
    stretch.span, stretch.shown, stretch.first, stretch.made = 2.0, 3.0, 4.0, 8e-6
    stretch.grow(rate=1.0, fast=100.0, noise=1e-12, strain=1e-7)
    grown = math.exp(2.0)
    assert stretch.grown == pytest.approx(grown)
    assert stretch.error == pytest.approx(UNIT_ROUNDOFF * 4.0 * grown + 2e-12, rel=1e-12, abs=0.0)
    assert stretch.slack == pytest.approx(2e-6 * grown + 2e-7, rel=1e-12)
    assert (stretch.shown, stretch.span) == (0.0, 0.0)
    before = stretch.slack
    stretch.span, stretch.shown = 2.0, 0.5
    stretch.grow(rate=1.0, fast=1e6, noise=1e-12, strain=1e-7)
    assert stretch.grown == pytest.approx(grown * math.exp(0.5))
    # rounding of the fastest rate so far counts anew
    assert stretch.error == pytest.approx(
        UNIT_ROUNDOFF * 1e6 * math.exp(0.5) + 2e-12, rel=1e-12, abs=0.0
    )
    assert stretch.slack == pytest.approx(before * math.exp(0.5) + 2e-7, rel=1e-12)
    stretch.span, stretch.shown = 1.0, 1e4
    stretch.grow(rate=1e4, fast=1.0, noise=0.0, strain=0.0)
    assert stretch.grown == pytest.approx(grown * math.exp(100.5))


def test_steps_are_held_closer_by_the_square_of_the_motions_growth() -> None:
    noted: list[tuple[float, float]] = []
    rounding: Any = SimpleNamespace(
        doubt=1e-9, note=lambda error, fast: noted.append((error, fast))
    )
    growth, stretch = Growth(), Stretch()
    stretch.error, stretch.slack, stretch.first = 1e-9, 1e-4, 0.1
    stretch.grown = LEAST
    growth.note(stretch, rounding, 5.0)
    assert (growth.closer, growth.lost, noted) == (1.0, 0.0, [])
    stretch.grown = 60.0
    growth.note(stretch, rounding, 5.0)
    assert noted == [(1e-9, 5.0)]
    assert growth.lost == pytest.approx(2e-5)
    assert growth.closer == pytest.approx((50.0 / LEAST) ** 2)
    stretch.grown = 30.0  # less than before changes nothing
    growth.note(stretch, rounding, 5.0)
    assert growth.closer == pytest.approx((50.0 / LEAST) ** 2)
    stretch.slack = 20.0  # all of the motion is lost, and no more than that
    growth.note(stretch, rounding, 5.0)
    assert growth.lost == 1.0
    rounding.doubt = 1.0 / 30.0  # rounding leaves nothing of it
    growth.note(stretch, rounding, 5.0)
    assert growth.closer == 1.0


def test_growth_is_kept_and_taken_as_a_whole() -> None:
    growth = Growth()
    state = [float(k) for k in range(1, 21)]
    growth.set_state(state)
    assert growth.get_state() == state
    other = Growth()
    other.take(growth)
    assert other.get_state() == state
    assert other.stretch1.first == 18.0
    growth.leave()
    left = growth.get_state()
    assert left[:3] == [1.0, 2.0, 3.0]
    assert left[3:9] == [0.0, 0.0, 0.0, 0.0, 1.0, 0.0]
    growth.forget()
    assert growth.get_state() == Growth().get_state()

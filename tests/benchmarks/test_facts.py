"""The known facts of the two systems, as the command benchmarks.facts measures them."""

from __future__ import annotations

import math

import pytest
from benchmarks.facts import (
    drift_law,
    exact_errors,
    fall_time,
    form_ratio,
    linear_bound,
    step_limit,
)

pytest.importorskip("mpmath")


def test_the_angle_is_about_800_times_as_accurate_at_the_same_step() -> None:
    assert form_ratio((1e-2,))[1e-2] == pytest.approx(800.0, rel=0.05)


def test_drift_grows_with_the_fourth_power_of_the_step_and_the_square_of_time() -> None:
    coefficient, step, time = drift_law((4e-3, 8e-3), stop=150.0)
    assert coefficient == pytest.approx(3.6e-5, rel=0.03)
    assert step == pytest.approx(4.0, abs=0.02)
    assert time == pytest.approx(2.0, abs=0.02)


@pytest.mark.parametrize(
    ("step", "falls_at"),
    [(1.0 / 60.0, 356.0), pytest.param(1e-2, 989.0, marks=pytest.mark.slow)],
)
def test_the_unstabilised_bead_falls_into_the_centre(step: float, falls_at: float) -> None:
    assert fall_time(step, longest=falls_at + 5.0) == pytest.approx(falls_at, abs=0.5)


def test_exact_is_free_of_error_at_any_macro_step() -> None:
    assert max(exact_errors((0.1, 2.5, 10.0)).values()) < 1e-14


LIMITS = {
    (("slider.mass", 1.0),): 0.30,
    (("slider.mass", 1e-2),): 6.3e-2,
    (("slider.mass", 1e-4),): 2.8e-3,
    (("slider.mass", 1e-6),): 3.6e-5,
    (("parabola.coefficient_start", 5.0),): 1.1e-2,
    (("parabola.coefficient_start", 50.0),): 4.9e-4,
    (("parabola.coefficient_start", 500.0),): 3.1e-5,
}
LONG = (1e-2, 1e-4, 1e-6, 5.0, 50.0, 500.0)


@pytest.mark.parametrize(
    ("case", "limit"),
    [
        pytest.param(
            case, limit, id=f"{case[0][0]}={case[0][1]:g}",
            marks=[pytest.mark.slow] if case[0][1] in LONG else [],
        )
        for case, limit in LIMITS.items()
    ],
)  # fmt: skip
def test_what_rk4_can_hold(case: tuple[tuple[str, float], ...], limit: float) -> None:
    """The boundary is ragged by 30 %: where motion is irregular, chance says which steps hold."""
    found = step_limit(dict(case), above=2.0 * limit)
    assert limit / 1.5 < found < limit * 1.5


def test_the_linear_bound_overstates_what_rk4_can_hold() -> None:
    """18 times at a mass ratio of 1e6. Curvature: 130 at a = 50, but 650, not 165, at a = 500."""
    assert linear_bound({}) == pytest.approx(2.0 * math.sqrt(2.0) / 5.78735129803610, rel=1e-12)
    over = {
        case[0]: linear_bound(dict(case)) / limit for case, limit in LIMITS.items()
    }  # 2.83 / omega over the limits that the test above measures
    assert over[("slider.mass", 1e-6)] == pytest.approx(18.0, rel=0.03)
    assert over[("parabola.coefficient_start", 50.0)] == pytest.approx(130.0, rel=0.03)
    assert over[("parabola.coefficient_start", 500.0)] == pytest.approx(650.0, rel=0.03)

"""When the live measures are looked at, and what they advise: the rules by themselves."""

from __future__ import annotations

import re

import pytest

from curvebound.fmi.watch import Watch


def test_looks_are_due_when_the_steps_have_grown_by_a_quarter() -> None:
    watch = Watch()
    looks = [steps for steps in range(1, 41) if watch.due(steps)]
    assert looks == [1, 2, 3, 4, 5, 6, 7, 8, 10, 12, 15, 18, 22, 27, 33]
    # and at the latest after 512, however long the communication steps are
    watch = Watch()
    assert watch.due(100_000)
    assert [steps for steps in range(100_000, 101_100, 4) if watch.due(steps)] == [100_512, 101_024]


def moved(energy: float, steps: int = 0) -> Watch:
    """After some steps, of a motion of this energy (J)."""
    watch = Watch()
    watch.moved, watch.seen = energy, steps
    return watch


@pytest.mark.parametrize(
    ("order", "growth", "better"),
    [(1, 1.0, "0.0006"), (1, 2.0, "0.0003"), (2, 1.0, "0.002"), (4, 1.0, "0.005")],
)
def test_the_step_to_try_follows_from_the_order(order: int, growth: float, better: str) -> None:
    """100 mJ of 2 J are 16.7 times three tenths of what is allowed: the step by 16.7^(1/order)."""
    watch = moved(2.0)
    message = watch.energy(0.1, growth, order, "solver.step", 1e-2, 3.0)
    assert f"try solver.step = {better} instead of 0.01" in message
    assert "energy.residual = 0.1 J at time 3 s" in message
    assert watch.said_energy
    assert moved(0.0).energy(0.1, growth, order, "solver.step", 1e-2, 3.0) == ""


def test_a_hundredth_of_the_energy_that_moves_is_allowed() -> None:
    for sign in (1.0, -1.0):
        assert not moved(2.0).exceeds(sign * 0.0199, 0.0)
        assert moved(2.0).exceeds(sign * 0.0201, 0.0)


def test_what_rounding_explains_is_allowed() -> None:
    """16 roundings of what adds up to the residual, and one per root of the number of steps."""
    noise = 2.0**-53 * (16.0 + 30.0) * 1e12
    assert not moved(1e-9, 900).exceeds(0.99 * noise, 1e12)
    assert moved(1e-9, 900).exceeds(1.01 * noise, 1e12)


def test_a_drift_is_judged_by_the_size_of_the_curve() -> None:
    watch = Watch()
    assert watch.drift(-1.9e-3, 2.0, "hold it", 1.0) == ""
    assert "hold it" in watch.drift(-2.1e-3, 2.0, "hold it", 1.0)
    assert watch.drift(-1.0, 2.0, "hold it", 1.0) == ""


def test_the_linear_model_is_beyond_its_range_at_three_tenths() -> None:
    watch = Watch()
    assert watch.linear(0.299, "choose the other", 1.0) == ""
    assert "choose the other" in watch.linear(0.301, "choose the other", 1.0)
    assert watch.linear(9.0, "choose the other", 1.0) == ""


def test_rounding_is_told_with_a_tolerance_that_is_not_told_again() -> None:
    watch = Watch()
    limit = 1e-8
    assert watch.rounding(0.99 * limit, 1e-8, "solver.tolerance", "", 1.0) == ""
    message = watch.rounding(1.01 * limit, 1e-8, "solver.tolerance", "choose less; ", 1.0)
    assert "choose less; raise solver.tolerance to 2e-08" in message
    assert watch.rounding(9.0 * limit, 1e-8, "solver.tolerance", "", 1.0) == ""
    enough = float(re.findall(r"to (\S+)$", message)[0])
    assert Watch().rounding(1.01 * limit, enough, "solver.tolerance", "", 1.0) == ""


def test_where_rounding_decides_no_tolerance_is_advised() -> None:
    message = Watch().rounding(0.3, 1e-8, "solver.tolerance", "", 1.0)
    assert "start farther from" in message
    assert "raise" not in message


def test_errors_of_steps_that_grow_name_the_tolerance_that_would_do() -> None:
    watch = Watch()
    assert watch.growth(1e-8, 1e-8, "solver.tolerance", 1.0) == ""
    message = watch.growth(2e-6, 1e-8, "solver.tolerance", 1.0)
    assert "to 2e-06 of it, more than solver.tolerance = 1e-08" in message
    assert message.endswith("lower it to 3e-11")
    assert watch.growth(2e-6, 1e-8, "solver.tolerance", 1.0) == ""
    assert Watch().growth(1.0, 1e-8, "solver.tolerance", 1.0).endswith("lower it to 1e-14")

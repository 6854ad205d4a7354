"""When the live measures are looked at, and what they advise: the rules by themselves."""

from __future__ import annotations

import re

import pytest

from curvebound.fmi.watch import Watch


def test_looks_become_rarer_up_to_every_64th_step() -> None:
    watch = Watch()
    looks = [step for step in range(1, 401) if watch.due()]
    assert looks == [16, 32, 64, 128, 192, 256, 320, 384]


def energy(watch: Watch, residual: float, order: int = 1, change: float = 2.0) -> str:
    return watch.energy(1.0, change, residual, order, "solver.step", 1e-2, 3.0)


@pytest.mark.parametrize(("order", "better"), [(1, "0.0002"), (2, "0.001"), (4, "0.004")])
def test_the_step_to_try_follows_from_the_order(order: int, better: str) -> None:
    """100 mJ of 2 J are 50 times a tenth of what is allowed: a step 50^(1/order) times shorter."""
    message = energy(Watch(), 0.1, order)
    assert f"try solver.step = {better} instead of 0.01" in message
    assert "energy.residual = 0.1 J at time 3 s" in message


def test_a_hundredth_of_the_energy_that_moves_is_allowed() -> None:
    watch = Watch()
    assert energy(watch, 0.0199) == ""
    assert energy(watch, -0.0201) != ""
    assert energy(watch, 5.0) == ""  # said once


def test_the_energy_that_moves_is_the_largest_so_far() -> None:
    for most in (-2.0, 2.0):
        watch = Watch()
        assert energy(watch, 0.0, change=most) == ""
        assert watch.energy(0.1, 0.1, 0.0199, 1, "solver.step", 1e-2, 4.0) == ""
        assert watch.energy(0.1, 0.1, 0.0201, 1, "solver.step", 1e-2, 5.0) != ""
    still = Watch()
    assert still.energy(0.0, 0.0, 0.0, 1, "solver.step", 1e-2, 0.0) == ""


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
    """Half an ulp of 1, magnified: above 1e4 times the tolerance it is said."""
    watch = Watch()
    limit = 1e4 * 1e-8 / 2.0**-53
    assert watch.rounding(0.99 * limit, 1e-8, "solver.tolerance", "", 1.0) == ""
    message = watch.rounding(1.01 * limit, 1e-8, "solver.tolerance", "choose less; ", 1.0)
    assert "choose less; raise solver.tolerance to 2e-08" in message
    assert watch.rounding(9.0 * limit, 1e-8, "solver.tolerance", "", 1.0) == ""
    enough = float(re.findall(r"to (\S+)$", message)[0])
    assert Watch().rounding(1.01 * limit, enough, "solver.tolerance", "", 1.0) == ""

"""The work of inputs and damping is integrated at the order of each method."""

from __future__ import annotations

import itertools
import math

import pytest
from small_models import Oscillator, march

from curvebound.kernel.methods import METHODS, create

CASES = {
    "explicit_euler": (1, (4_000, 8_000, 16_000)),
    "semi_implicit_euler": (1, (4_000, 8_000, 16_000)),
    "rk4": (4, (1_600, 3_200, 6_400)),
}


def driven() -> Oscillator:
    return Oscillator(damping=0.3, push=2.0, outer=1.5)


@pytest.mark.parametrize("name", CASES)
def test_order_of_the_energy_balance(name: str) -> None:
    order, steps = CASES[name]
    residuals = []
    for n in steps:
        model = driven()
        march(create(METHODS.index(name) + 1), model, count=n)
        assert abs(model.work) > 0.5
        residuals.append(abs(model.residual()))
    for coarse, fine in itertools.pairwise(residuals):
        assert math.log2(coarse / fine) == pytest.approx(order, abs=0.2)
    assert residuals[-1] < (5e-2 if order == 1 else 1e-8)


def test_gauss_legendre_balances_quadratic_energies_exactly() -> None:
    """Its quadrature is that of its steps, so that on a linear model nothing is left over."""
    model = driven()
    march(create(5), model, count=50)
    assert abs(model.work) > 0.5
    assert abs(model.residual()) < 1e-13
    assert model.error(10.0) > 1e-4


@pytest.mark.parametrize(("tolerance", "allowed"), [(1e-6, 1e-6), (1e-9, 1e-9), (1e-12, 1e-12)])
@pytest.mark.parametrize("pieces", [1, 40])
def test_adaptive_work_keeps_to_the_tolerance(
    tolerance: float, allowed: float, pieces: int
) -> None:
    model = driven()
    march(create(4), model, pieces=pieces, tolerance=tolerance)
    assert abs(model.residual()) < 5 * allowed


@pytest.mark.parametrize("pieces", [1, 10, 1000])
def test_exact_work(pieces: int) -> None:
    model = driven()
    march(create(6), model, pieces=pieces)
    assert abs(model.residual()) < 1e-12
    assert model.error(10.0) < 1e-12

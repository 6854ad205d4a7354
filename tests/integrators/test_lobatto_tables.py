"""Identities of the Lobatto method's constants and of the functions made of them.

B(14), C(8) and D(6) together make the order 14 (Butcher 1964; Hairer, Norsett, Wanner 1993,
theorem II.7.4).
"""

from __future__ import annotations

import itertools
import math
import random

import numpy as np
import pytest
from numpy.polynomial import legendre

from curvebound.kernel import lobatto, lobatto_tables, polynomial
from curvebound.kernel.course import OPEN

NODES = np.array(lobatto_tables.NODES)
A = np.reshape(lobatto_tables.BY_ROWS, (8, 8))
R = np.reshape(lobatto_tables.SQUARE, (8, 8))
B = A[7]


def test_nodes_are_the_lobatto_points() -> None:
    derivative = legendre.legder([0.0] * 7 + [1.0])
    inner = (np.sort(legendre.legroots(derivative)) + 1) / 2
    assert NODES[1:7] == pytest.approx(inner, abs=1e-14)


def test_row_sums() -> None:
    assert A.sum(axis=1) == pytest.approx(NODES, abs=2e-16)
    assert R.sum(axis=1) == pytest.approx(NODES**2 / 2, abs=2e-16)


@pytest.mark.parametrize("k", range(1, 9))
def test_stages_collocate(k: int) -> None:
    """C(8): sum_j A_ij c_j^(k-1) = c_i^k / k."""
    assert A @ NODES ** (k - 1) == pytest.approx(NODES**k / k, abs=1e-15)


@pytest.mark.parametrize("k", range(1, 15))
def test_weights_have_order_14(k: int) -> None:
    """B(14): sum_j b_j c_j^(k-1) = 1 / k."""
    assert B @ NODES ** (k - 1) == pytest.approx(1 / k, abs=1e-15)


def test_weights_have_no_higher_order() -> None:
    assert abs(B @ NODES**14 - 1 / 15) > 1e-9


@pytest.mark.parametrize("k", range(1, 7))
def test_simplifying_condition_of_the_weights(k: int) -> None:
    """D(6): sum_i b_i c_i^(k-1) A_ij = b_j (1 - c_j^k) / k."""
    assert (B * NODES ** (k - 1)) @ A == pytest.approx(B * (1 - NODES**k) / k, abs=1e-15)


def test_second_integrals_are_the_square() -> None:
    assert pytest.approx(A @ A, abs=1e-16) == R


def test_the_method_is_symmetric() -> None:
    assert pytest.approx(B[::-1], abs=1e-16) == B
    assert A + A[::-1, ::-1] == pytest.approx(np.tile(B, (8, 1)), abs=2e-16)


def test_extrapolation_is_exact_for_degree_7() -> None:
    rng = random.Random(1)
    for ratio in (0.1, 0.7, 1.0, 1.5):
        c = [rng.uniform(-1, 1) for _ in range(8)]
        old = np.polyval(c, NODES)
        new = polynomial.extrapolated(old.tolist(), float(old[7]), 2 * ratio)
        truth = np.polyval(c, 1 + ratio * NODES[1:])
        assert np.array(new) == pytest.approx(truth, rel=1e-9)
        shifted = polynomial.extrapolated(old.tolist(), float(old[7]) + 3.0, 2 * ratio)
        assert np.array(shifted) == pytest.approx(truth + 3, rel=1e-9)


@pytest.mark.parametrize(
    ("weights", "first", "count"),
    [
        (lobatto_tables.LAGRANGE_1, 1, 1),
        (lobatto_tables.LAGRANGE_1_2, 1, 2),
        (lobatto_tables.LAGRANGE_1_TO_4, 1, 4),
        (lobatto_tables.LAGRANGE_3_4, 3, 2),
    ],
)
def test_an_extended_guess_is_exact_for_a_degree_more_with_each_value(
    weights: list[float], first: int, count: int
) -> None:
    rng = random.Random(1)
    for ratio, degree in itertools.product((0.3, 1.0, 1.5), (7, 7 + count, 8 + count)):
        c = [rng.uniform(-1, 1) for _ in range(degree + 1)]
        old = np.polyval(c, NODES)
        truth = np.polyval(c, 1 + ratio * NODES)
        guess = [truth[0], *polynomial.extrapolated(old.tolist(), float(old[7]), 2 * ratio)]
        nodal, missed = [0.0] * 8, [0.0] * 8
        polynomial.span(2 * ratio, nodal)
        k = truth.copy()
        k[first + count :] = math.nan
        polynomial.miss(guess, nodal, k, missed, first, first + count)
        polynomial.extend(guess, nodal, missed, weights, first, count, k, first + count, 8)
        assert (k == pytest.approx(truth, rel=1e-8)) == (degree <= 7 + count)


def test_the_nodal_polynomial_is_zero_at_the_points_of_the_step_before() -> None:
    nodal = [0.0] * 8
    polynomial.span(1.0, nodal)
    x = 1.0 + NODES[1:]
    points = 2.0 * NODES - 1.0
    assert np.array(nodal[1:]) == pytest.approx([np.prod(at - points) for at in x], rel=1e-13)


def test_tail_sees_the_two_highest_legendre_coefficients() -> None:
    smooth = legendre.legval(2 * NODES - 1, [5.0, 100.0, 10.0])
    spread = polynomial.tail(0.0, *smooth.tolist())
    assert spread == pytest.approx(0.0, abs=1e-25)
    for degree, weight in ((7, polynomial.HIGHEST), (6, polynomial.NEXT), (5, 0.0), (3, 0.0)):
        small = legendre.legval(2 * NODES - 1, [0.0] * degree + [1e-4])
        size = polynomial.tail(0.0, *(smooth + small).tolist())
        # the values spread over 100 (2 + 2 * 0.59 ...) plus 10 (...)
        assert size * 300 == pytest.approx(weight * 1e-8, rel=0.5, abs=1e-20)


def test_tail_is_proportional_and_at_most_of_the_size_of_what_is_not_smooth() -> None:
    values = np.sin(3 * NODES)
    size = polynomial.tail(0.0, *values.tolist())
    assert 0.0 < size < 1e-6
    assert polynomial.tail(0.0, *(1e-9 * values).tolist()) == pytest.approx(1e-9 * size, rel=1e-6)
    jump = polynomial.tail(0.0, *(NODES > 0.5).astype(float).tolist())
    assert 1e-2 < jump < 1.0
    assert polynomial.tail(0.0, *[7.0] * 8) < 1e-16
    assert polynomial.tail(0.0, *[0.0] * 8) == 0.0


def test_tail_exceeds_the_error_of_the_quadrature() -> None:
    for w in (1.0, 2.0, 4.0, 6.0):
        for phase in (0.0, 0.5, 1.0):
            k = np.sin(w * NODES + phase)
            truth = (np.cos(phase) - np.cos(w + phase)) / w
            assert abs(B @ k - truth) < polynomial.tail(0.0, *k.tolist()) + 1e-16


def test_end_of_the_step() -> None:
    k = np.polyval([1.0, 2.0, 3.0], NODES)
    x, w = [0.5] + 7 * [0.0], [-1.0] + 7 * [0.0]
    lobatto.follow(True, 0.2, k.tolist(), x, w, 7, 8)
    assert w[7] == pytest.approx(-1 + 0.2 * (1 / 3 + 2 / 2 + 3), abs=1e-15)
    assert x[7] == pytest.approx(0.5 - 0.2 + 0.04 * (1 / 12 + 2 / 6 + 3 / 2), abs=1e-15)


def test_a_last_stage_that_is_thrown_far_is_a_change_that_tells_nothing() -> None:
    """It sets the size of the rate, and changes the mean by its weight."""
    assert lobatto_tables.WEIGHTS[-1] > OPEN

"""Algebraic loops: solved to the tolerance whatever their gain, or told why not."""

from __future__ import annotations

import numpy as np
import pytest

from curvebound.cosim.loops import LoopFailed, LoopSolver


def solved(g, start, tolerance=1e-9):
    """The solution of x = g(x), from `start`."""
    x = np.array(start, dtype=float)

    def evaluate():
        x[:] = g(x.copy())

    names = [f"a.y{i}" for i in range(len(x))]

    def run(calls):
        for call in calls:
            call()

    LoopSolver(range(len(x)), names, [1.0] * len(x), x, [evaluate], run, tolerance)()
    return x


@pytest.mark.parametrize("gain", [0.5, -3.0, 20.0, 0.999, 1.0 - 1e-5, -1e6])
@pytest.mark.parametrize("start", [0.0, 1.0, 1e3])
def test_the_error_is_within_the_tolerance_whatever_the_gain(gain, start):
    exact = 1.0 / (1.0 - gain)
    (found,) = solved(lambda x: gain * x + 1.0, [start])
    assert abs(found - exact) <= 2e-9 * max(1.0, abs(exact))


def test_scales_far_apart_are_no_singularity():
    found = solved(lambda x: np.array([1e6 * x[1] + 1.0, 0.9e-6 * x[0]]), [0.0, 0.0])
    assert found == pytest.approx([10.0, 9e-6], rel=1e-6)


@pytest.mark.parametrize(
    ("g", "start"),
    [
        (lambda x: x + 1.0, [0.0]),  # no solution
        (lambda x: x, [0.3]),  # any is one
        (lambda x: np.array([2.0 * x[1] + 1.0, 0.5 * x[0]]), [0.0, 0.0]),
        (lambda x: np.array([1e6 * x[1] + 1.0, 1e-6 * x[0]]), [0.0, 0.0]),
    ],
)
def test_a_singular_loop_is_told_and_what_helps(g, start):
    with pytest.raises(LoopFailed, match="the gain around it is 1") as caught:
        solved(g, start)
    assert "change a gain" in str(caught.value)
    assert "loop_tolerance" not in str(caught.value)


def test_loosening_is_advised_where_it_helps():
    noise = np.random.default_rng(1)

    def g(x):
        return 0.5 * x + 1.0 + 1e-6 * noise.standard_normal(1)

    with pytest.raises(LoopFailed, match="raise loop_tolerance to") as caught:
        solved(g, [0.0], 1e-9)
    advised = float(str(caught.value).rpartition(" ")[2])
    assert solved(g, [0.0], advised) == pytest.approx([2.0], abs=1e-4)


def test_a_loop_without_solution_is_told_so():
    with pytest.raises(LoopFailed, match="no values were found that fulfil it"):
        solved(lambda x: x * x + 1.0, [0.0])

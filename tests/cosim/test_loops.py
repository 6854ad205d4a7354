"""Algebraic loops: solved to the tolerance whatever their gain, or told why not."""

from __future__ import annotations

import numpy as np
import pytest

from curvebound.cosim import Scene
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


def ring(**settings):
    """Two beads, each pushed at once by what the other does to its wire."""
    scene = Scene("ring", stop_time=0.5, step=0.01, loop_tolerance=1e-10, **settings)
    scene.add("a", "BeadOnWire", {"bead.angle_start": 0.7, "bead.mass": 2.0})
    scene.add("b", "BeadOnWire", {"bead.angle_start": -1.1, "model.formulation": "angle"})
    scene.connect("b.wire.fx", "a.wire.ax", 0.4).connect("b.wire.fy", "a.bead.fy", 2.0)
    scene.connect("a.constraint.force", "b.bead.fx", 0.3)
    return scene.record(*(f"{n}.{v}" for n in "ab" for v in ("wire.fx", "wire.fy", "bead.angle")))


@pytest.fixture
def counted(monkeypatch):
    """How each loop was solved: evaluations, and whether by Newton's method."""
    found = []
    made = LoopSolver.__call__

    def solve(solver):
        made(solver)
        found.append((solver.evaluations, solver._changes is not None))

    monkeypatch.setattr(LoopSolver, "__call__", solve)
    return found


@pytest.mark.parametrize("hold", ["zero", "first"])
def test_a_ring_of_two_plants_takes_two_evaluations(counted, monkeypatch, hold):
    scene = ring(hold=hold)
    found = scene.run()
    # initialization, its end, and each communication point
    assert len(counted) == 52
    assert all(newton and evaluations <= 2 for evaluations, newton in counted)
    assert max(evaluations for evaluations, _ in counted) == 2
    monkeypatch.setattr("curvebound.cosim.schedule.changes_of", lambda *_: None)
    counted.clear()
    other = scene.run()
    assert not any(newton for _, newton in counted)
    assert np.mean([evaluations for evaluations, _ in counted]) > 3.0
    for name in found.names:
        assert found[name] == pytest.approx(other[name], rel=1e-8, abs=1e-8)


def test_a_loop_with_a_component_without_them_is_solved_as_before(counted, gain_fmu):
    scene = Scene("mixed", stop_time=0.1, step=0.01, loop_tolerance=1e-10)
    scene.add("a", "BeadOnWire", {"bead.angle_start": 0.7}).add("b", gain_fmu, {"gain": 0.5})
    scene.connect("a.wire.fx", "b.u", 1.0).connect("b.y", "a.bead.fx", 1.0).record("a.bead.angle")
    scene.run()
    assert counted
    assert not any(newton for _, newton in counted)


def test_newton_follows_what_is_not_affine():
    """x = cos(1.3 x), and a loop whose slope Newton's method does not get along with."""
    x = np.array([2.0])
    slope = [0.0]

    def evaluate():
        slope[0] = -1.3 * np.sin(1.3 * x[0])
        x[0] = np.cos(1.3 * x[0])

    def run(calls):
        for call in calls:
            call()

    solver = LoopSolver([0], ["a.y"], [1.0], x, [evaluate], run, 1e-12, lambda: np.array([slope]))
    solver()
    assert x[0] == pytest.approx(np.cos(1.3 * x[0]), abs=1e-12)
    assert solver.evaluations <= 8
    wrong = LoopSolver([0], ["a.y"], [1.0], x, [evaluate], run, 1e-12, lambda: np.array([[3.0]]))
    x[0] = 2.0
    wrong()
    assert x[0] == pytest.approx(np.cos(1.3 * x[0]), abs=1e-11)


@pytest.mark.filterwarnings("ignore:overflow")
def test_a_slope_that_is_not_finite_hides_no_solution():
    assert solved(lambda x: np.where(x > 0.3, 1e308, -1e308), [0.3]) == [-1e308]

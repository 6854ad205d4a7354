"""What a study runs: starts around a scene's own, and the grid of its settings."""

from __future__ import annotations

from dataclasses import replace
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

from curvebound.study import grid, starts
from curvebound.study.settings import Setting

NOTHING: Any = None


@pytest.fixture
def two(monkeypatch: pytest.MonkeyPatch) -> None:
    """A system with a value of 2 m, and an angle of 3 rad that feedback holds at 4 rad."""
    monkeypatch.setattr(starts, "initial_values", lambda _: {"a": 2.0, "b": 3.0})
    monkeypatch.setattr(starts, "set_points", lambda _: {"b": 4.0})


@pytest.mark.parametrize(("count", "corners"), [(0, 0), (1, 1), (2, 2), (3, 2), (7, 4), (20, 4)])
@pytest.mark.usefixtures("two")
def test_up_to_half_of_the_starts_are_corners_and_the_others_fill_the_box(
    count: int, corners: int
) -> None:
    found = starts.surrounding(NOTHING, 0.1, count)
    units = [(found["a"] - 2.0) / 0.2, (found["b"] - 3.0) / -0.1]
    points = np.array(units).T
    assert len(points) == 1 + count
    assert points[0].tolist() == [0.0, 0.0]
    if count > 0:
        assert points[1] == pytest.approx([1.0, 1.0])
    if count > 1:
        assert points[2] == pytest.approx([-1.0, -1.0])
    assert np.abs(points[1 : 1 + corners]) == pytest.approx(np.ones((corners, 2)))
    assert len({tuple(np.sign(point)) for point in points[1 : 1 + corners]}) == corners
    rest = points[1 + corners :]
    for column in rest.T:
        # one in each of as many equal parts
        cells = np.floor((np.sort(column) + 1.0) / 2.0 * len(column))
        assert cells.tolist() == list(range(len(column)))
    again = starts.surrounding(NOTHING, 0.1, count)
    assert all(np.array_equal(found[path], again[path]) for path in found)
    if count > 3:
        other = starts.surrounding(NOTHING, 0.1, count, seed=1)
        assert not np.array_equal(found["a"], other["a"])


@pytest.mark.usefixtures("two")
def test_unseen_starts_are_of_the_same_box() -> None:
    found = starts.unseen(NOTHING, 0.1, 400)
    for path, middle, half in (("a", 2.0, 0.2), ("b", 3.0, 0.1)):
        assert len(found[path]) == 400
        assert middle - half <= found[path].min() < middle - 0.95 * half
        assert middle + half >= found[path].max() > middle + 0.95 * half
    assert not np.array_equal(found["a"], starts.unseen(NOTHING, 0.1, 400, seed=2)["a"])


def test_numbers_of_micro_steps_and_tolerances() -> None:
    every = grid.divisions(False)
    assert every[:7] == [1, 2, 5, 10, 20, 50, 100]
    assert every[-1] == 50000
    assert grid.divisions(True) == [1, 3, 10, 30, 100, 300]
    assert grid.tolerances(False) == pytest.approx([10.0**-n for n in range(2, 15)])
    assert grid.tolerances(True) == pytest.approx([1e-2, 1e-5, 1e-8, 1e-11, 1e-14])


@pytest.mark.parametrize(
    ("sampled", "quick", "factors"),
    [
        (True, False, [5.0, 2.0, 0.5, 0.2]),
        (True, True, [2.0, 0.5]),
        (False, False, [10.0, 0.1]),
        (False, True, [10.0]),
    ],
)
def test_macro_steps_beside_the_scenes_own(sampled: bool, quick: bool, factors: Any) -> None:
    scene: Any = SimpleNamespace(step=0.5, start_time=1.0, stop_time=6.0)
    found = grid.macro_steps(scene, sampled, quick)
    assert found == pytest.approx([0.5 * factor for factor in factors])
    scene.stop_time = 1.9
    assert grid.macro_steps(scene, sampled, quick) == [s for s in found if s <= 0.9]


class Space:
    """A scene with one body: by `rk4`, `adaptive` and `exact`, of one structure."""

    structures = ("own",)

    def __init__(self, laws: tuple[str, ...] = (), signals: tuple[str, ...] = ()) -> None:
        self.plants = ["body"]
        self.system = SimpleNamespace(nodes=dict.fromkeys(["body", *laws]), signals=signals)

    def families(self, step: float, algorithm: str, hold: str) -> list[Any]:
        return [Setting("own", method, 0.0, step, algorithm, hold)
                for method in ("rk4", "adaptive", "exact")]  # fmt: skip


def test_what_is_held_over_a_macro_step_is_part_of_the_result() -> None:
    scene: Any = NOTHING
    assert not grid.is_sampled(scene, Space())  # type: ignore[arg-type]
    assert grid.is_sampled(scene, Space(laws=("law",)))  # type: ignore[arg-type]
    assert grid.is_sampled(scene, Space(signals=("body.fx",)))  # type: ignore[arg-type]


def test_the_grid_of_a_scene_that_holds_nothing() -> None:
    scene: Any = SimpleNamespace(
        step=0.5, start_time=0.0, stop_time=8.0, algorithm="gauss_seidel", hold="zero"
    )
    families = list(grid.grid(scene, Space(), quick=True))  # type: ignore[arg-type]
    assert {family.purpose for family in families} == {"micro"}
    found = [(f.settings[0].method, f.settings[0].step, len(f.settings)) for f in families]
    assert found == [
        ("rk4", 0.5, 6), ("adaptive", 0.5, 5), ("exact", 0.5, 2),
        ("rk4", 5.0, 6), ("adaptive", 5.0, 5), ("exact", 5.0, 1),
    ]  # fmt: skip
    sizes = [setting.size for setting in families[0].settings]
    assert sizes == pytest.approx([0.5 / n for n in (1, 3, 10, 30, 100, 300)])
    assert [setting.size for setting in families[1].settings] == pytest.approx(
        [1e-2, 1e-5, 1e-8, 1e-11, 1e-14]
    )
    whole = families[2].settings[1]
    assert whole == replace(families[2].settings[0], step=8.0)


def test_the_grid_of_a_scene_that_holds_values(monkeypatch: pytest.MonkeyPatch) -> None:
    scene: Any = SimpleNamespace(
        step=0.5, start_time=0.0, stop_time=8.0, algorithm="gauss_seidel", hold="zero"
    )
    pairs = [("gauss_seidel", "zero"), ("jacobi", "first")]
    monkeypatch.setattr(grid, "couplings", lambda *_: pairs)
    families = list(grid.grid(scene, Space(laws=("law",)), quick=True))  # type: ignore[arg-type]
    assert [f.purpose for f in families] == ["micro"] * 3 + ["macro"] * 2
    assert [len(f.settings) for f in families] == [6, 5, 1, 3, 3]
    for family, (algorithm, hold) in zip(families[3:], pairs, strict=True):
        assert list(family.settings) == [
            Setting("own", "adaptive", 1e-12, step, algorithm, hold) for step in (1.0, 0.5, 0.25)
        ]

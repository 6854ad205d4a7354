"""The figures that the README states are those that were measured, and hold for the code today."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import pytest
from harness import Extracted
from measured import groups
from measured.groups import GROUPS, PICTURES, SPEED
from measured.random_points import motions_again, points_again
from measured.text import BLOCKS, DOCUMENTS, block, blocks_in

ENTRIES: dict[str, Any] = json.loads(
    (Path(__file__).parent / "measured" / "figures.json").read_text(encoding="utf-8")
)
STEADY = ("demo", "errors", "models")


def stated() -> dict[str, str]:
    """The blocks of all documents, by name."""
    found: dict[str, str] = {}
    for document in DOCUMENTS:
        found |= blocks_in(document.read_text(encoding="utf-8"))
    return found


def test_every_group_that_does_not_depend_on_speed_is_measured_and_stated() -> None:
    assert set(stated()) == set(BLOCKS)
    assert {group for group, _ in BLOCKS.values()} == set(GROUPS)
    assert set(STEADY) <= set(ENTRIES)
    for entry in ENTRIES.values():
        assert entry["date"]
        assert entry["machine"]


@pytest.mark.parametrize("name", sorted(BLOCKS))
def test_what_is_stated_is_what_was_measured(name: str) -> None:
    """Nobody has written a figure by hand."""
    measured = block(name, ENTRIES)
    assert measured in (None, stated()[name]), f"python tests/measured {BLOCKS[name][0]}"


def differences(before: Any, now: Any, path: str = "") -> list[str]:
    """Where two sets of figures differ by more than another compiler and math library explain."""
    if isinstance(before, dict):
        if before.keys() != now.keys():
            return [f"{path}: {sorted(before)} were stated, there is {sorted(now)}"]
        return [
            d
            for k in before
            if k not in SPEED
            for d in differences(before[k], now[k], f"{path}.{k}")
        ]
    if isinstance(before, list) and len(before) == len(now):
        return [d for i, (x, y) in enumerate(zip(before, now, strict=True))
                for d in differences(x, y, f"{path}[{i}]")]  # fmt: skip
    if isinstance(before, float) and isinstance(now, float):
        small = 1e-13 if path.endswith(("residual", "drift", "exact")) else 0.0
        near = abs(before - now) <= small or 1 / 3 <= now / before <= 3.0
        return [] if near else [f"{path}: {before:.2e} was stated, it is {now:.2e}"]
    if path.endswith("kB"):
        return [] if abs(before - now) <= 0.2 * before else [f"{path}: {before}, now {now}"]
    if path.startswith(("points", "motions")) and path.endswith(("evaluations", "steps")):
        return [] if abs(before - now) <= 0.1 * before else [f"{path}: {before}, now {now}"]
    if path.endswith("how"):
        return []  # this interpreter and compiler
    return [] if before == now else [f"{path}: {before} was stated, it is {now}"]


@pytest.mark.usefixtures("one_reference")
@pytest.mark.parametrize("name", STEADY)
def test_figures_that_do_not_depend_on_speed_are_those_of_today(
    name: str, extracted: dict[str, Extracted], monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(groups, "_fmus", lambda: extracted)
    assert differences(ENTRIES[name]["figures"], GROUPS[name](), name) == []


@pytest.mark.parametrize("seeds", [(1,), pytest.param((1, 2), marks=pytest.mark.slow)])
def test_extreme_random_points_are_those_of_today(seeds: tuple[int, ...]) -> None:
    """The least accurate and the dearest ones; the thousands of others take minutes."""
    whole = ENTRIES["points"]["figures"]
    stated = {**whole, "samples": [one for one in whole["samples"] if one["seed"] in seeds]}
    assert {one["seed"] for one in stated["samples"]} == set(seeds)
    assert differences(stated, points_again(stated), "points") == []


@pytest.mark.slow
def test_extreme_random_motions_are_those_of_today() -> None:
    pytest.importorskip("heyoka")
    stated = ENTRIES["motions"]["figures"]
    assert differences(stated, motions_again(stated), "motions") == []


def test_a_figure_that_has_changed_is_named() -> None:
    before = {"scenes": {"a": {"wall": 1.0, "residual": 1.6e-8, "steps": 10, "drift": None}}}
    now = {"scenes": {"a": {"wall": 9.0, "residual": 1.4e-10, "steps": 10, "drift": None}}}
    assert differences(before, before, "demo") == []
    assert differences(before, now, "demo") == [
        "demo.scenes.a.residual: 1.60e-08 was stated, it is 1.40e-10"
    ]


def test_the_pictures_are_there() -> None:
    for name in PICTURES:
        assert (DOCUMENTS[0].parent / "scenarios" / f"{name}.png").is_file()

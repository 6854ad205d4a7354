"""Which plots a picture shows first, and which a page offers."""

from __future__ import annotations

from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest
from motions import table

from curvebound.fmi.drawing import Drawing, Plot
from curvebound.view import picture, write_replay
from curvebound.view.model import _MOST_OTHERS, _OTHERS_SHOWN

FIRST, ENERGY, REST = Plot("First", ("a",)), Plot("Energy", ("energy.total",)), Plot("Rest", ("b",))
RESIDUAL = Plot("Residual", ("energy.residual",), error=True)
DRIFT = Plot("Drift", ("drift",), error=True)
HIDDEN = Plot("Hidden", ("c",), shown=False)
PLOTS = (FIRST, HIDDEN, ENERGY, RESIDUAL, REST, DRIFT)


def choice(actors: int) -> list[list[Plot]]:
    cast: Any = SimpleNamespace(actors=[None] * actors, drawings=lambda: [Drawing(plots=PLOTS)])
    return picture._choice(cast)


def test_the_most_telling_plots_come_first() -> None:
    errors = [DRIFT, RESIDUAL]
    assert choice(1) == [[FIRST], [ENERGY], errors, [REST], errors]
    assert choice(2) == [errors, [FIRST], [REST]]
    assert choice(0) == [[plot] for plot in PLOTS]


@pytest.mark.parametrize("more", [0, 3])
def test_columns_that_nobody_knows_are_offered_up_to_a_number(tmp_path, more: int) -> None:
    columns = {f"engine.c{k}": np.arange(3.0) * k for k in range(_MOST_OTHERS + more)}
    page = write_replay([("own", table({"time": np.arange(3.0), **columns}))], tmp_path / "a.html")
    text = page.read_text(encoding="utf-8")
    assert ("more columns are not offered" in text) == (more > 0)
    assert (f"{more} more columns are not offered as plots." in text) == (more > 0)
    plots = [f'"title":"engine.c{k}"' in text for k in range(_MOST_OTHERS + more)]
    assert plots == [True] * _MOST_OTHERS + [False] * more
    assert text.count('"shown":true') == _OTHERS_SHOWN


def cast_of(*columns: dict[str, Any]) -> Any:
    """A cast of bodies named one and two whose results have these columns."""
    owners = []
    for owner, colour, given in zip(("one", "two"), ("red", "blue"), columns, strict=False):
        time = np.arange(3.0)
        data = table({"time": time, **{f"plant.arm.{k}": v for k, v in given.items()}})
        owners.append((owner, {"plant.": Drawing(plots=PLOTS)}, data, colour))
    return SimpleNamespace(actors=owners, owners=lambda: owners)


def lines(plot: Plot, *columns: dict[str, Any]) -> list[tuple[str, str, int]]:
    found = picture._lines(cast_of(*columns), plot)
    return [(line.label, line.colour, line.dash) for line in found]


def test_lines_are_told_apart_by_colour_and_dash() -> None:
    """Of one body by colours; of several by its colour, and its quantities by dashes."""
    both, moves = Plot("Both", ("arm.a", "arm.b")), {"a": [0.0, 1.0, 2.0], "b": [3.0, 4.0, np.nan]}
    one = [picture.colour_of(0), picture.colour_of(1)]
    assert lines(both, moves) == [("arm.a", one[0], 0), ("arm.b", one[1], 1)]
    assert lines(both, moves, moves) == [
        ("one: arm.a", "red", 0),
        ("one: arm.b", "red", 1),
        ("two: arm.a", "blue", 0),
        ("two: arm.b", "blue", 1),
    ]
    assert lines(Plot("A", ("arm.a",)), moves, moves) == [("one", "red", 0), ("two", "blue", 0)]
    gone = {"a": [np.nan] * 3, "b": [np.inf] * 3}
    assert lines(both, moves, gone) == [("one: arm.a", "red", 0), ("one: arm.b", "red", 1)]


def test_plots_without_news_are_left_out() -> None:
    """What rests, where a plot is of motion; errors of the size of rounding."""
    rests, moves = {"a": [1.0, 1.0, np.nan]}, {"a": [1.0, 1.0, 1.0 + 1e-12]}
    plot = Plot("A", ("arm.a",), moving=True)
    assert [len(lines(plot, columns)) for columns in (rests, moves)] == [0, 1]
    assert len(lines(plot._replace(moving=False), rests)) == 1
    small, large = 0.9 * picture._ROUNDING, -1.1 * picture._ROUNDING
    for size, count in ((small, 0), (large, 1)):
        assert len(lines(Plot("A", ("arm.a",), error=True), {"a": [0.0, np.nan, size]})) == count

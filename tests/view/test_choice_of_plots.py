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

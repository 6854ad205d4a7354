"""Figures of studies: how their panels are laid out, and their axes of times."""

from __future__ import annotations

from types import SimpleNamespace
from typing import Any

import pytest

from curvebound.study.figures import COLOURS, heading, logarithmic, new_figure
from curvebound.study.precision.plots import _colour, _floor, _legend, _times

pytest.importorskip("matplotlib")


@pytest.mark.parametrize(
    ("count", "stacked", "size", "grid"),
    [
        (1, False, (8.6, 2.0), (1, 1)),
        (2, False, (8.6, 2.0), (1, 2)),
        (3, False, (12.0, 2.0), (1, 3)),
        (4, False, (12.0, 4.0), (2, 3)),
        (4, True, (4.6, 8.0), (4, 1)),
    ],
)
def test_panels_stand_three_in_a_row_or_one_below_the_other(
    count: int, stacked: bool, size: tuple[float, float], grid: tuple[int, int]
) -> None:
    figure, panels = new_figure(4.0, 2.0, count, stacked=stacked)
    assert tuple(figure.get_size_inches()) == size
    assert len(panels) == len(figure.axes) == count
    assert panels[0].get_subplotspec().get_gridspec().get_geometry() == grid
    places = [panel.get_subplotspec().num1 for panel in panels]
    assert places == list(range(count))
    shown = {side: spine.get_visible() for side, spine in panels[0].spines.items()}
    assert shown == {"left": True, "bottom": True, "top": False, "right": False}
    assert panels[0].get_axisbelow() is True
    assert all(line.get_visible() for line in panels[0].get_xgridlines())


@pytest.mark.parametrize(
    ("high", "ticks"),
    [
        (30.0, [1.0, 2.0, 5.0, 10.0, 20.0]),
        (33.0, [1.0, 3.0, 10.0, 30.0]),
        (990.0, [1.0, 3.0, 10.0, 30.0, 100.0, 300.0]),
        (1010.0, [1.0, 10.0, 100.0, 1000.0]),
    ],
)
def test_few_decades_have_several_ticks_each(high: float, ticks: list[float]) -> None:
    """Up to a decade and a half three, below three decades two, then one."""
    _, (panel,) = new_figure(4.0, 2.0)
    panel.set_xlim(1e-6, high * 1e-6)
    _times(panel.xaxis)
    low, top = panel.get_xlim()
    found = [1e6 * x for x in panel.xaxis.get_majorticklocs() if low <= x <= top * (1 + 1e-9)]
    assert found == pytest.approx(ticks)
    assert panel.get_xscale() == "log"
    assert panel.xaxis.get_major_formatter()(2e-6, None) == "2 us"
    assert list(panel.xaxis.get_minorticklocs()) == []


def test_a_logarithmic_axis_is_the_one_that_was_asked_for() -> None:
    figure, (panel,) = new_figure(4.0, 2.0)
    logarithmic(panel.yaxis)
    assert (panel.get_xscale(), panel.get_yscale()) == ("linear", "log")
    assert panel.yaxis.get_major_formatter()(1e-8, None) == "1e-8"
    heading(figure, "word " * 20, stacked=True)
    assert figure._suptitle.get_text().count("\n") == 2


def test_errors_of_zero_are_drawn_a_third_of_the_smallest() -> None:
    rows = [{"error": error} for error in (0.0, 4e-9, 2e-10)]
    assert _floor(rows, "error") == pytest.approx(6e-11, rel=1e-12, abs=0.0)
    assert _floor(rows[:1], "error") == pytest.approx(3e-17, rel=1e-12, abs=0.0)
    assert _floor([{"error": 1e-20}], "error") == 1e-17


def test_every_method_has_a_colour() -> None:
    for method, colour in COLOURS.items():
        assert _colour(method) == colour
    assert _colour("ba") == _colour("ab") != _colour("aa")


@pytest.mark.parametrize("forms", [["angle"], ["angle", "projection"]], ids=len)
def test_a_legend_tells_forms_apart_where_there_are_several(forms: list[str]) -> None:
    told: list[str] = []

    def legend(*, handles: list[Any], ncols: int, **_: Any) -> None:
        told.extend(handle.get_label() for handle in handles)
        assert ncols == min(len(handles), 3)

    _legend(SimpleNamespace(legend=legend), forms, ["rk4", "adaptive"], 3)
    assert told == ["rk4", "adaptive", *(forms if len(forms) > 1 else [])]

"""Plots of more samples than pixels: quick to draw, and at rest while time moves."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from browsing import Tab
from motions import bead

from curvebound.view import write_replay

#: the plot of this title, redrawn: width and dashes of each line, and the data it was given
PLOT = """(async (title) => {
  const plot = curvebound.plots.find(({ spec }) => spec.title === title);
  plot.refresh();
  await null;
  await null;
  return { lines: plot.chart.series.slice(1).map(({ width, dash }) => [width, dash]),
           data: plot.chart.data.map((values) => Array.from(values, (v) => v ?? NaN)) };
})"""


@pytest.fixture(scope="module")
def page(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A smooth angle; energies that go up and down 20 times a second, kinetic against potential."""
    data = bead(10.0, 1 / 500)
    shaken = np.sin(2 * np.pi * 20.0 * data["time"])
    data["bead.energy.kinetic"] += 5.0 * shaken
    data["bead.energy.potential"] -= 5.0 * shaken
    return write_replay([("bead", data)], tmp_path_factory.mktemp("dense") / "bead.html")


def test_a_line_that_fills_its_columns_is_thin_and_solid(tab: Tab, page: Path) -> None:
    """Stroking it dashed takes a tenth of a second for each picture."""
    tab.open(page)
    assert tab.run(f"{PLOT}('Angle')")["lines"] == [[1.5, []]]
    kinetic, potential, total = tab.run(f"{PLOT}('Energy')")["lines"]
    assert kinetic == [1, []]
    assert potential == [1, []]
    assert total == [1.5, [2, 3]]
    tab.run("curvebound.setWindow(2, 2.3)")  # here its turns are apart
    assert tab.run(f"{PLOT}('Energy')")["lines"] == [[1.5, []], [1.5, [7, 4]], [1.5, [2, 3]]]


def test_columns_stay_where_they_are_while_time_moves(tab: Tab, page: Path) -> None:
    tab.open(page)
    tab.run("curvebound.setWindow(1, 9)")
    columns = {}
    for shift in (0.0, 0.3, 1.4):
        width = 8.0 / tab.run("Math.max(curvebound.plots[0].chart.width - 88, 80)")
        tab.run(f"curvebound.setWindow({1 + shift * width}, {9 + shift * width})")
        x, low_high, *_ = tab.run(f"{PLOT}('Energy')")["data"]
        columns[shift] = dict(zip(np.round(np.array(x) / width, 2), low_high, strict=True))
    for shift in (0.3, 1.4):
        shared = sorted(set(columns[0.0]) & set(columns[shift]))[4:-4]
        assert len(shared) > 600
        assert [columns[0.0][x] for x in shared] == [columns[shift][x] for x in shared]

"""A sweep over two parameters as heat maps, one per metric."""

from __future__ import annotations

import math
from collections.abc import Sequence
from pathlib import Path
from typing import Any

import numpy as np

from ...errors import CurveboundError
from ..figures import GREY, INK, logarithmic, new_figure, save
from .design import Design
from .store import read_sweep

__all__ = ["draw_heat_map", "require_map"]

_MOST = 4  # metrics beside each other


def require_map(design: Design) -> None:
    """Raise CurveboundError unless exactly two numeric parameters vary: before the sweep."""
    if len(design.axes) != 2 or any(one.items for one in design.axes):
        raise CurveboundError("A heat map needs two parameters that vary between numbers.")


def draw_heat_map(table: Path, design: Design, metrics: Sequence[str], out: Path) -> list[Path]:
    """Draw the metrics of a sweep's CSV over its two numeric axes to OUT.png and OUT.svg.

    A grid is drawn as cells, a sample as points; failed points stay white, with a cross. Raises
    CurveboundError unless exactly two numeric parameters vary.
    """
    require_map(design)
    header, rows = read_sweep(table)
    x, y = design.axes
    columns = [np.array([row[header.index(a.path)] for row in rows], dtype=float) for a in (x, y)]
    shown = {
        metric: np.array([row[header.index(metric)] for row in rows], dtype=float)
        for metric in list(metrics)[:_MOST]
    }
    return save(lambda _: _drawn(design, columns, shown), out, narrow=False)


def _drawn(design: Design, columns: list[Any], shown: dict[str, Any]) -> Any:
    x, y = design.axes
    figure, axes = new_figure(4.2, 3.9, len(shown))
    for one, (metric, values) in zip(axes, shown.items(), strict=True):
        drawn = _draw(one, design, columns, values)
        if drawn is not None:
            bar = figure.colorbar(drawn, ax=one, shrink=0.9)
            bar.ax.tick_params(labelsize=7, colors=GREY)
        failed = ~np.isfinite(values)
        one.plot(columns[0][failed], columns[1][failed], "x", color=GREY, markersize=4)
        one.grid(False)
        one.set_title(metric, fontsize=9, color=INK, loc="left")
        one.set_xlabel(x.path, fontsize=8, color=INK)
        one.set_ylabel(y.path, fontsize=8, color=INK)
        if x.logarithmic and x.low > 0.0:
            logarithmic(one.xaxis)
        if y.logarithmic and y.low > 0.0:
            logarithmic(one.yaxis)
    return figure


def _draw(axes: Any, design: Design, columns: list[Any], values: Any) -> Any:
    finite = values[np.isfinite(values)]
    if not len(finite):
        return None
    low, high = float(finite.min()), float(finite.max())
    colours: dict[str, Any] = {"cmap": "viridis", "vmin": low, "vmax": high}
    if low > 0.0 and high > 300.0 * low:
        from matplotlib.colors import LogNorm

        colours = {"cmap": "viridis", "norm": LogNorm(low, high)}
    if design.latin:
        return axes.scatter(*columns, c=values, s=18, linewidths=0, **colours)
    edges = [_edges(np.unique(column), a.logarithmic) for column, a in
             zip(columns, design.axes, strict=True)]  # fmt: skip
    grid = np.full((len(edges[1]) - 1, len(edges[0]) - 1), math.nan)
    places = [np.searchsorted(np.unique(column), column) for column in columns]
    grid[places[1], places[0]] = values
    return axes.pcolormesh(*edges, np.ma.masked_invalid(grid), rasterized=True, **colours)


def _edges(values: Any, logarithmic: bool) -> Any:
    """Limits of cells around the values of an axis."""
    positive = logarithmic and values[0] > 0.0
    at = np.log(values) if positive else values
    if len(at) == 1:
        edges = np.array([at[0] - 0.5, at[0] + 0.5])
    else:
        inner = 0.5 * (at[1:] + at[:-1])
        edges = np.concatenate([[2 * at[0] - inner[0]], inner, [2 * at[-1] - inner[-1]]])
    return np.exp(edges) if positive else edges

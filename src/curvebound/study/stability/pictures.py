"""The picture of a stability map: one panel for each method."""

from __future__ import annotations

import math
from collections.abc import Sequence
from pathlib import Path
from typing import Any

import numpy as np

from ...numbers import plain, quantity
from ..figures import GREY, INK, PALETTE, logarithmic, new_figure, save
from .probe import ACCURATE, FAILED, INACCURATE, UNKNOWN, UNSTABLE
from .stability_map import Column, StabilityMap

__all__ = ["draw"]

#: of the verdicts, told apart in grey as well
OUTCOME_COLOURS = {
    ACCURATE: PALETTE["accurate"],
    INACCURATE: PALETTE["inaccurate"],
    UNSTABLE: PALETTE["unstable"],
    FAILED: PALETTE["failed"],
    UNKNOWN: PALETTE["paper"],
}
STABLE = PALETTE["stable"]


def draw(maps: Sequence[StabilityMap], label: str, out: Path) -> list[Path]:
    """Write OUT.png and the SVGs beside it; `label` of the varied parameter, with its unit."""
    return save(lambda stacked: _drawn(maps, label, stacked), out)


def _drawn(maps: Sequence[StabilityMap], label: str, stacked: bool) -> Any:
    from matplotlib.colors import BoundaryNorm, ListedColormap

    figure, panels = new_figure(3.6, 3.9, len(maps), stacked=stacked)
    kinds = list(OUTCOME_COLOURS)
    colours = ListedColormap(list(OUTCOME_COLOURS.values()))
    norm = BoundaryNorm(np.arange(len(kinds) + 1) - 0.5, len(kinds))
    for i, (one, axes) in enumerate(zip(maps, panels, strict=True)):
        x = np.array([column.value for column in one.columns])
        scale = _scale(x)
        edges = _edges(x, scale)
        for k, column in enumerate(one.columns):
            y = np.array(column.sizes)
            grid = [[kinds.index(verdict.kind)] for verdict in column.verdicts.values()]
            axes.pcolormesh(edges[k : k + 2], _edges(y, "log"), grid, cmap=colours, norm=norm)
        axes.grid(False)
        _line(axes, one.columns, "accurate", INK, "-", 1.6)
        _line(axes, one.columns, "stable", STABLE, "-", 1.6)
        _line(axes, one.columns, "at_rest", INK, "--", 1.1)
        _line(axes, one.columns, "in_motion", INK, ":", 1.3)
        if scale == "log":
            logarithmic(axes.xaxis)
        elif scale == "symlog":
            # zero is as far from the least value as a decade
            axes.set_xscale("symlog", linthresh=_least(x), linscale=1.0)
            axes.set_xticks([v for v in x if v == 0.0 or round(math.log10(abs(v) / _least(x))) % 2])
            axes.xaxis.set_major_formatter(lambda value, _: plain(value))
        axes.set_xlim(edges[0], edges[-1])
        logarithmic(
            axes.yaxis, (lambda x: quantity(x, "s")) if one.size_is != "tolerance" else plain
        )
        axes.set_ylim(
            min(column.sizes[0] for column in one.columns),
            max(column.sizes[-1] for column in one.columns),
        )
        axes.set_xlabel(label, fontsize=8.5, color=INK)
        first = axes.get_subplotspec().is_first_col()
        if first or one.size_is != maps[i - 1].size_is:
            axes.set_ylabel(one.size_is.removesuffix(" (s)"), fontsize=8.5, color=INK)
        axes.set_title(one.method, fontsize=9.5, color=INK, loc="left")
        axes.minorticks_off()
        axes.tick_params(axis="x", labelrotation=0 if scale == "linear" else 45)
    _legend(figure, 2 if stacked else 5)
    return figure


def _scale(x: Any) -> str:
    """The scale of ascending values: logarithmic in size where they spread over decades."""
    if len(x) < 3 or np.abs(x).max() < 30.0 * _least(x):
        return "linear"
    return "log" if x[0] > 0.0 else "symlog"


def _least(x: Any) -> float:
    sizes = np.abs(x[x != 0.0])
    return float(sizes.min()) if len(sizes) else 1.0


def _edges(values: Any, scale: str) -> Any:
    """Edges of cells about ascending values."""
    if scale == "linear":
        at = values
    elif scale == "log":
        at = np.log(values)
    else:  # a decade is as wide as the gap about zero
        least = _least(values)
        at = np.sign(values) * (np.log10(np.maximum(np.abs(values), least) / least) + 1.0)
        at = np.where(values == 0.0, 0.0, at)
    if len(at) == 1:
        edges = np.array([at[0] - 0.5, at[0] + 0.5])
    else:
        middle = 0.5 * (at[1:] + at[:-1])
        edges = np.concatenate([[2 * at[0] - middle[0]], middle, [2 * at[-1] - middle[-1]]])
    if scale == "linear":
        return edges
    if scale == "log":
        return np.exp(edges)
    grown = np.abs(edges)
    return np.sign(edges) * least * np.where(grown < 1.0, grown, 10.0 ** (grown - 1.0))


def _line(
    axes: Any, columns: Sequence[Column], what: str, colour: str, dashes: str, width: float
) -> None:
    """A boundary, at the rim where it lies beyond the steps tried."""
    found = [getattr(column, what) for column in columns]
    theory = what in ("at_rest", "in_motion")
    if all(math.isnan(value) for value in found):
        return
    y = [
        min(max(v, c.sizes[0]), c.sizes[-1])
        if not math.isnan(v)
        else math.nan
        if theory
        else c.sizes[0]
        for v, c in zip(found, columns, strict=True)
    ]
    axes.plot([c.value for c in columns], y, dashes, color=colour, linewidth=width)


def _legend(figure: Any, columns: int) -> None:
    from matplotlib.lines import Line2D
    from matplotlib.patches import Patch

    handles: list[Any] = [
        Patch(facecolor=colour, edgecolor=GREY, linewidth=0.4, label=kind)
        for kind, colour in OUTCOME_COLOURS.items()
    ]
    handles += [
        Line2D([], [], color=INK, label="accurate below"),
        Line2D([], [], color=STABLE, label="stable below"),
        Line2D([], [], color=INK, linestyle="--", label="linear theory at rest"),
        Line2D([], [], color=INK, linestyle=":", label="linear theory along the motion"),
    ]
    figure.legend(
        handles=handles, loc="outside lower center", ncols=columns, fontsize=8, frameon=False,
        labelcolor=INK,
    )  # fmt: skip

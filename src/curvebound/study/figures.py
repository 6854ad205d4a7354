"""Figures as all studies draw them: colours of the methods, axes, PNG and SVG files."""

from __future__ import annotations

from pathlib import Path
from typing import Any

from ..errors import CurveboundError
from ..files import write_whole
from ..pages import palette

__all__ = ["COLOURS", "GREY", "GRID", "INK", "PALETTE", "new_figure", "save"]

#: colours of the pages' light theme, which follow the theme in an SVG
PALETTE = palette()
INK, GREY, GRID, PAPER = (PALETTE[name] for name in ("ink", "muted", "line", "paper"))
COLOURS = {
    "explicit_euler": PALETTE["result-3"],
    "semi_implicit_euler": PALETTE["result-4"],
    "rk4": PALETTE["result-0"],
    "adaptive": PALETTE["result-1"],
    "implicit": PALETTE["result-2"],
    "exact": PALETTE["result-7"],
}


def new_figure(width: float, height: float, columns: int = 1) -> tuple[Any, list[Any]]:
    """A figure in inches with `columns` axes beside each other, none of the user's settings used.

    Raises CurveboundError where matplotlib is not installed.
    """
    try:
        from matplotlib.backends.backend_agg import FigureCanvasAgg
        from matplotlib.figure import Figure
    except ImportError as error:
        raise CurveboundError(
            "Plots need matplotlib, which is not installed. "
            "Install it with `pip install 'curvebound[plots]'`, or leave them out with --no-plots."
        ) from error
    figure = Figure(figsize=(width, height), layout="constrained", facecolor="white")
    FigureCanvasAgg(figure)
    axes = figure.subplots(1, columns, squeeze=False)[0]
    for one in axes:
        one.grid(True, which="major", color=GRID, linewidth=0.6)
        one.set_axisbelow(True)
        for side in ("top", "right"):
            one.spines[side].set_visible(False)
        for side in ("left", "bottom"):
            one.spines[side].set_color(GREY)
        one.tick_params(colors=GREY, labelsize=8, which="both")
    return figure, list(axes)


def save(figure: Any, out: Path) -> list[Path]:
    """Write OUT.png and OUT.svg; the SVG's text stays text."""
    from matplotlib import rc_context

    base = out.with_suffix("") if out.suffix in (".png", ".svg") else out
    png = write_whole(
        base.with_name(base.name + ".png"), lambda path: figure.savefig(path, dpi=130)
    )
    with rc_context({"svg.fonttype": "none", "svg.hashsalt": "curvebound"}):
        svg = write_whole(
            base.with_name(base.name + ".svg"),
            lambda path: figure.savefig(path, metadata={"Date": None}),
        )
    return [png, svg]

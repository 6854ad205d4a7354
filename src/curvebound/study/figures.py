"""Figures as all studies draw them: colours of the methods, axes, PNG and SVG files."""

from __future__ import annotations

import math
import textwrap
from collections.abc import Callable
from pathlib import Path
from typing import Any

from ..errors import CurveboundError
from ..files import write_whole
from ..numbers import plain
from ..pages import NARROW, palette, themed

__all__ = [
    "COLOURS",
    "GREY",
    "GRID",
    "INK",
    "PALETTE",
    "heading",
    "logarithmic",
    "new_figure",
    "save",
]

#: colours of the pages' light theme; in an SVG they follow the theme
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
# panels beside each other, and the width of a figure in inches: letters keep their size in a page
_COLUMNS, _WIDTH, _STACKED = 3, 8.6, 4.6


def new_figure(
    width: float, height: float, count: int = 1, *, stacked: bool = False
) -> tuple[Any, list[Any]]:
    """A figure with `count` panels of that size in inches, none of the user's settings used.

    stacked: one below the other, for narrow screens; otherwise at most three side by side.
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
    columns = 1 if stacked else min(count, _COLUMNS)
    rows = math.ceil(count / columns)
    size = (_STACKED if stacked else max(_WIDTH, width * columns), height * rows)
    figure = Figure(figsize=size, layout="constrained", facecolor=PAPER)
    FigureCanvasAgg(figure)
    panels = list(figure.subplots(rows, columns, squeeze=False).flat)
    for unused in panels[count:]:
        unused.remove()
    for one in panels[:count]:
        one.set_facecolor(PAPER)
        one.grid(True, which="major", color=GRID, linewidth=0.6)
        one.set_axisbelow(True)
        for side in ("top", "right"):
            one.spines[side].set_visible(False)
        for side in ("left", "bottom"):
            one.spines[side].set_color(GREY)
        one.tick_params(colors=GREY, labelsize=8, which="both")
    return figure, panels[:count]


def logarithmic(axis: Any, write: Callable[[float], str] = plain) -> None:
    """Make an axis of a panel logarithmic, its ticks written as everywhere: 0.01, 1e-8."""
    axis.axes.set(**{f"{axis.axis_name}scale": "log"})
    axis.axes.minorticks_off()
    axis.set_major_formatter(lambda x, _: write(x))


def heading(figure: Any, text: str, *, stacked: bool) -> None:
    """The title of a figure."""
    lines = textwrap.fill(text, 42) if stacked else text
    figure.suptitle(lines, fontsize=11, x=0.01, ha="left", color=INK)


def save(draw: Callable[[bool], Any], out: Path, *, narrow: bool = True) -> list[Path]:
    """Write OUT.png, OUT.svg and, if `narrow`, stacked OUT_narrow.svg; an SVG's text stays text.

    draw: makes the figure, told whether to stack its panels; None where there is nothing to draw.
    """
    from matplotlib import rc_context

    base = out.with_suffix("") if out.suffix in (".png", ".svg") else out
    written: list[Path] = []
    for stacked in (False, True) if narrow else (False,):
        figure = draw(stacked)
        if figure is None:
            return []
        if not stacked:
            png = base.with_name(base.name + ".png")
            written.append(write_whole(png, lambda path, one=figure: one.savefig(path, dpi=130)))  # type: ignore[misc]
            figure.set_layout_engine("none")  # it is laid out now
        svg = base.with_name(base.name + (NARROW if stacked else "") + ".svg")
        with rc_context({"svg.fonttype": "none", "svg.hashsalt": "curvebound"}):
            written.append(write_whole(svg, lambda path, one=figure: _write_svg(one, path)))  # type: ignore[misc]
    return written


def _write_svg(figure: Any, path: Path) -> None:
    figure.savefig(path, format="svg", metadata={"Date": None})
    path.write_text(themed(path.read_text(encoding="utf-8")), encoding="utf-8", newline="\n")

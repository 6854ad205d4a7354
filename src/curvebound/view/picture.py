"""A result as a still picture: its motion as by a stroboscope, and what matters over time."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

import numpy as np

from ..errors import CurveboundError
from ..files import write_whole
from ..fmi.drawing import FRAME, Drawing, Plot
from .actors import Actor, Floats, split_name
from .geometry import distances
from .quantities import plots_of, quantity
from .quivers import Quivers, strip_for
from .reading import Results
from .stage import INK, Cast, Stage, as_floats, colour_of, figure, save_small

__all__ = ["dark_of", "write_picture"]

_FLASHES = 10
_PLOTS = 3
_DASHES = ("-", (0, (4, 2)), (0, (1, 1.5)))
_DPI = 100
_STACKED = 3.9  # inches, about the width of a phone
_ROUNDING = 1e-13


def write_picture(
    results: Results,
    out: Path,
    title: str | None = None,
    known: Sequence[Drawing] = (),
    arrows: str = "",
    *,
    stacked: bool = False,
    dark: bool = False,
) -> Path:
    """Draw results to the PNG `out`: one Result or structured array, or pairs of a label and one.

    Columns are `time` in s and `component.variable` in SI units; those of a structured array are
    recognised as a system's of the package or of the drawings `known`. Several results share the
    picture, each in its colour. `arrows`: of velocities and forces, by their names with commas
    between, or "all", at the last instant that is drawn. stacked: the plots below the drawing, for
    cards and phones. dark: the same in the colours of the dark theme beside it, in the file that
    `dark_of` names. Raises CurveboundError where matplotlib is missing, there is nothing to draw,
    or what an arrow needs is not recorded.
    """
    cast = Cast(results, known)
    plots = _plots(cast)[: _PLOTS if cast.actors else 4]
    if not cast.actors and not plots:
        raise CurveboundError(
            "There is nothing to draw: no column besides `time` holds numbers that vary."
        )
    layout = _stacked if stacked else _beside
    drawn, grid = layout(bool(cast.actors), len(plots), title is not None)
    if title:
        drawn.suptitle(title, x=0.015, ha="left", fontsize=11, fontweight="bold", color=INK)
    if cast.actors:
        if not plots:
            grid = drawn.add_gridspec(1, 1)
        _strobe(drawn.add_subplot(grid[0, 0] if stacked else grid[:, 0]), cast, arrows)
    above = int(stacked and bool(cast.actors))
    for row, (heading, unit, logarithmic, series) in enumerate(plots):
        axes = drawn.add_subplot(grid[row + above, -1])
        _over_time(axes, heading, unit, logarithmic, series)
        if row == len(plots) - 1:
            axes.set_xlabel("time in s", fontsize=7.5, color=INK, labelpad=1)
    if dark:
        write_whole(dark_of(out), lambda path: save_small(drawn, path, dark=True))
    return write_whole(out, lambda path: save_small(drawn, path))


def dark_of(picture: Path) -> Path:
    """Where the dark variant of a picture lies."""
    return picture.with_name(f"{picture.stem}_dark{picture.suffix}")


def _beside(actors: bool, plots: int, titled: bool) -> tuple[Any, Any]:
    """A figure, and the grid in it: the drawing on the left, plots on the right."""
    drawn = figure(9.0 if actors else 6.4, 4.6, _DPI)
    grid = drawn.add_gridspec(
        max(plots, 1), 2 if actors else 1, width_ratios=(1.15, 1.0) if actors else None,
        left=0.05 if actors else 0.12, right=0.985, bottom=0.1, top=0.9 if titled else 0.95,
        wspace=0.17, hspace=0.45,
    )  # fmt: skip
    return drawn, grid


def _stacked(actors: bool, plots: int, titled: bool) -> tuple[Any, Any]:
    """The same, one below the other."""
    ratios = [2.4] * actors + [1.0] * plots
    height = 1.15 * sum(ratios) + 0.45 + 0.3 * titled
    drawn = figure(_STACKED, height, 2 * _DPI)
    grid = drawn.add_gridspec(
        len(ratios), 1, height_ratios=ratios, left=0.13, right=0.97, bottom=0.4 / height,
        top=1.0 - (0.25 + 0.25 * titled) / height, hspace=0.5,
    )  # fmt: skip
    return drawn, grid


def _strobe(axes: Any, cast: Cast, arrows: str) -> None:
    stage = Stage(axes, [one.actor for one in cast.actors], strip_for(cast, arrows))
    first = cast.actors[0]
    start, end = float(first.time[0]), float(first.time[-1])
    until = min(start + _swing(first.time, first.actor), end)
    flashes = np.linspace(start, until, _FLASHES)
    if len(cast.actors) > 1:  # side by side their paths and their ends tell more
        flashes = flashes[:0]
    flashed = []
    for one in cast.actors:
        stage.trace(one.actor, one.colour)
        samples = np.unique([one.sample(t) for t in flashes]) if len(flashes) else [one.last]
        for order, at in enumerate(samples):
            fade = (order + 1) / len(samples)
            stage.bodies(one.actor, int(at), one.colour, 0.12 + 0.88 * fade * fade)
        flashed = list(samples)
    if len(flashed) > 1:
        step = (until - start) / (_FLASHES - 1)
        words = f"t = {start:.3g} … {until:.3g} s, every {step:.2g} s"
    else:
        words = f"t = {end:.4g} s"
    if stage.relative:
        words += ", seen from the frame"
    axes.set_title(f"{words}; m", fontsize=7.5, color=INK, loc="left", pad=4)
    stage.legend(cast)
    Quivers(stage, cast, arrows).move(until if len(flashes) else None)


def _swing(time: Floats, actor: Actor) -> float:
    """Time from one end of the motion to the other, where no flash hides another; or all."""
    *_, before, last = FRAME, *(point.name for point in actor.drawing.points)
    swing = actor.at(last)[0] - actor.at(before)[0]
    good = np.isfinite(swing)
    whole = float(time[-1] - time[0])
    if good.sum() < 3:
        return whole
    above = swing[good] > np.mean(swing[good])
    rises = time[good][1:][above[1:] & ~above[:-1]]
    return float(np.median(np.diff(rises))) / 2.0 if len(rises) > 1 else whole


@dataclass(frozen=True)
class _Line:
    """One line of a plot over time."""

    label: str
    unit: str
    time: Floats
    values: Floats
    colour: str
    dash: int


_Chart = tuple[str, str, bool, list[_Line]]  # title, unit, logarithmic, lines


def _plots(cast: Cast) -> list[_Chart]:
    """The plots to show, the most telling first."""
    found: dict[str, _Chart] = {}
    if len(cast.actors) > 1:
        apart = _apart(cast)
        if apart:
            found["distance"] = (f"Distance from {cast.actors[0].label}", "m", True, apart)
    for plots in _choice(cast):
        for plot in plots:
            if plot.title in found:
                continue
            lines = _lines(cast, plot)
            if lines:
                found[plot.title] = (plot.title, lines[0].unit, plot.error, lines)
                break
    if not found:
        for number, result in enumerate(cast.results):
            data, time = result.data, as_floats(result.data["time"])
            for name in data.dtype.names or ():
                values = as_floats(data[name])
                if name != "time" and _varies(values):
                    line = _Line("", "", time, values, colour_of(number), 0)
                    found.setdefault(name, (name, "", False, []))[3].append(line)
    return list(found.values())


def _choice(cast: Cast) -> list[list[Plot]]:
    """What tells most about a run, in this order; each of the lists is good for one plot."""
    plots = plots_of(cast.drawings())
    if not cast.actors:
        return [[plot] for plot in plots]
    others = [plot for plot in plots if plot.shown and not plot.error]
    # the energy's residual is every system's: what is its own tells more
    errors = sorted((plot for plot in plots if plot.error), key=_is_of_energy)
    energies = [plot for plot in others[1:] if _is_of_energy(plot)]
    rest = [[plot] for plot in others[1:] if plot not in energies]
    if len(cast.actors) > 1:
        return [errors, others[:1], *rest]
    return [others[:1], energies, errors, *rest, errors]


def _is_of_energy(plot: Plot) -> bool:
    return plot.names[0].startswith("energy.")


def _apart(cast: Cast) -> list[_Line]:
    """Distance of every body from the first, where they are of one kind."""
    first, *others = cast.actors
    lines = []
    for one in others:
        if one.actor.kind != first.actor.kind:
            continue
        time, pairs = distances(first.actor, first.time, one.actor, one.time)
        for dash, (point, values) in enumerate(pairs):
            label = f"{one.label}: {point}" if len(pairs) > 1 else one.label
            if len(others) == 1:
                label = point
            if np.isfinite(values).any() and np.nanmax(values) > 0.0:
                lines.append(_Line(label, "m", time, values, one.colour, dash))
    return lines


def _lines(cast: Cast, plot: Plot) -> list[_Line]:
    """The lines of one plot: the colour tells bodies apart, or quantities where there is one."""
    many = len(cast.actors) > 1
    lines: list[_Line] = []
    kinds: list[str] = []
    for owner, drawings, data, colour in cast.owners():
        for name in data.dtype.names or ():
            prefix, variable = split_name(name)
            if variable not in plot.names or prefix not in drawings:
                continue
            values = as_floats(data[name])
            if not np.isfinite(values).any():
                continue
            told = quantity(variable, drawings[prefix])
            what = told.label
            if what not in kinds:
                kinds.append(what)
            shade = colour if many else colour_of(len(lines))
            label = f"{owner}: {what}" if many else what
            time, dash = as_floats(data["time"]), kinds.index(what)
            lines.append(_Line(label, told.unit, time, values, shade, dash))
    if many and len(kinds) == 1:
        lines = [replace(line, label=line.label.rpartition(": ")[0]) for line in lines]
    if plot.error:  # at rounding level there is nothing to see
        return lines if any(np.nanmax(np.abs(line.values)) > _ROUNDING for line in lines) else []
    return lines if not plot.moving or any(_varies(line.values) for line in lines) else []


def _varies(values: Floats) -> bool:
    good = values[np.isfinite(values)]
    return bool(good.size and np.ptp(good) > 0.0)


def _over_time(axes: Any, title: str, unit: str, logarithmic: bool, lines: list[_Line]) -> None:
    heading = f"|{title}|" if logarithmic else title
    if unit not in ("", "1"):
        heading += f", {unit.replace('s2', 's²')}"
    # Where one line may hide another, the later is the thinner.
    stacked = len({line.colour for line in lines}) > 1 and len({line.dash for line in lines}) == 1
    for order, line in enumerate(lines):
        values = line.values
        if logarithmic:
            values = np.where(values == 0.0, np.nan, np.abs(values))
        axes.plot(
            line.time, values, color=line.colour, label=line.label,
            linewidth=max(2.2 - order, 1.0) if stacked else 1.0,
            linestyle=_DASHES[line.dash % 3], marker="o" if len(values) == 1 else None,
        )  # fmt: skip
    if logarithmic:
        _decades(axes, lines)
    axes.set_title(heading, fontsize=8, color=INK, loc="left", pad=3)
    if 1 < len(lines) <= 3:
        axes.legend(
            fontsize=6.5, ncols=3, frameon=False, loc="lower right", bbox_to_anchor=(1.01, 0.97),
            borderaxespad=0.0, handlelength=1.8, columnspacing=1.0,
        )  # fmt: skip
    axes.margins(x=0.0)
    axes.grid(color="#e9edf2", linewidth=0.7)
    axes.tick_params(labelcolor=INK, labelsize=7, length=2, color="#d5dbe3")
    for spine in axes.spines.values():
        spine.set_color("#d5dbe3")


def _decades(axes: Any, lines: list[_Line]) -> None:
    """A logarithmic axis that starts no deeper than is worth looking at."""
    from matplotlib.ticker import LogLocator, NullFormatter, NullLocator

    sizes = np.abs(np.concatenate([line.values for line in lines]))
    sizes = sizes[np.isfinite(sizes) & (sizes > 0.0)]
    low = max(0.5 * float(sizes.min()), 1e-8 * float(sizes.max()))
    axes.set_ylim(low, max(2.0 * float(sizes.max()), 30.0 * low))
    axes.set_yscale("log")
    axes.yaxis.set_major_locator(LogLocator(numticks=5))
    axes.yaxis.set_minor_locator(NullLocator())
    axes.yaxis.set_minor_formatter(NullFormatter())

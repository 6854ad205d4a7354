"""Arrows of velocities and forces on matplotlib axes, as the pages draw them."""

from __future__ import annotations

from typing import Any

import numpy as np

from .arrows import Kind, Vector, kinds_of, vectors_of, wanted
from .stage import INK, Cast, Role, Stage, colour_of

__all__ = ["Quivers", "strip_for"]

_REACH = 0.22  # of the smaller side of the axes, for the greatest
_CUT = 2.0  # times that: what is longer is cut there, and says so
_COLOURS = (6, 7, 4, 5, 3, 2, 1, 0)  # those that bodies take last
_LINE = 0.15  # inches, of the legend
_TICKS = 0.18  # inches, of the ticks' labels


def strip_for(cast: Cast, asked: str) -> float:
    """The inches that the legend takes below the axes, for the Stage; raises as Quivers does."""
    return _LINE * len(_chosen(cast, asked)[1])


def _chosen(cast: Cast, asked: str) -> tuple[list[Kind], list[Kind]]:
    """All kinds, and those that are asked for."""
    kinds = kinds_of((one.label, one.actor, one.data) for one in cast.actors)
    return kinds, wanted(asked, kinds) if asked else []


class Quivers:
    """Arrows of the kinds that `asked` names, of all that a cast shows on a stage.

    Raises CurveboundError where a kind is not there, or what it needs is not recorded.
    """

    def __init__(self, stage: Stage, cast: Cast, asked: str) -> None:
        self._stage = stage
        kinds, chosen = _chosen(cast, asked)
        (left, right), (low, high) = stage.axes.get_xlim(), stage.axes.get_ylim()
        self._reach = _REACH * min(right - left, high - low)
        self._moving: list[tuple[Role, Vector, float, Any, Any]] = []
        vectors = [
            (one, vector)
            for one in (cast.actors if chosen else ())
            for vector in vectors_of(one.actor, one.data)
        ]
        for number, kind in enumerate(kinds):
            if kind in chosen:
                greatest = max(one.size for one in chosen if one.unit == kind.unit) or 1.0
                key = (kind.name, kind.unit)
                own = [one for one in vectors if (one[1].arrow.name, one[1].arrow.unit) == key]
                self._add(own, self._reach / greatest, colour_of(_COLOURS[number % 8]))
        self._legend()

    def _add(self, vectors: list[tuple[Role, Vector]], scale: float, colour: str) -> None:
        """The arrows of one kind; scale: metres for one of its unit."""
        for one, vector in vectors:
            quiver = self._stage.axes.quiver(
                [0.0], [0.0], [0.0], [0.0], color=colour, angles="xy", scale_units="xy",
                scale=1.0, width=0.006, minlength=0.0, zorder=5,
            )  # fmt: skip
            letter = self._stage.axes.text(
                0.0, 0.0, "", color=INK, fontsize=8, fontweight="bold", ha="center",
                va="center", zorder=6, clip_on=True,
            )  # fmt: skip
            self._moving.append((one, vector, scale, quiver, letter))

    def move(self, time: float | None = None) -> None:
        """Draw them at a time in s, or at the end."""
        for one, vector, scale, quiver, letter in self._moving:
            at = one.last if time is None else one.sample(time)
            x, y = (path[at] for path in self._stage.path(one.actor, vector.arrow.at))
            along = scale * np.array([vector.x[at], vector.y[at]])
            length = float(np.hypot(*along))
            if not length > 0.01 * self._reach:
                quiver.set_UVC([0.0], [0.0])
                letter.set_text("")
                continue
            longest = _CUT * self._reach
            drawn = along * min(1.0, longest / length)
            quiver.set_offsets([[x, y]])
            quiver.set_UVC([drawn[0]], [drawn[1]])
            tip = np.array([x, y]) + drawn + 0.13 * self._reach * along / length
            letter.set_position(tip)
            more = f" \N{MULTIPLICATION SIGN}{length / longest:.2g}" if length > longest else ""
            letter.set_text(vector.arrow.symbol + more)

    def _legend(self) -> None:
        """A key of each kind: an arrow of a round number, what it is and how much.

        They stand in the stage's strip, below the ticks, so that they cover nothing.
        """
        seen: set[tuple[str, str]] = set()
        axes = self._stage.axes
        box, dpi = axes.get_window_extent(), axes.figure.dpi
        metre = box.width / dpi / np.ptp(axes.get_xlim())  # inches
        ticks = _TICKS if axes.xaxis.get_tick_params()["labelbottom"] else 0.0
        left, top = box.x0 / dpi + 0.05, box.y0 / dpi - ticks
        for _, vector, scale, quiver, _ in self._moving:
            key = (vector.arrow.name, vector.arrow.unit)
            if key in seen:
                continue
            value = _round(0.3 * self._reach / scale)
            words = f"{vector.arrow.symbol} {vector.arrow.name}, {value:g} {vector.arrow.unit}"
            axes.quiverkey(
                quiver, left + value * scale * metre, top - (len(seen) + 0.5) * _LINE,
                value * scale, words, coordinates="inches", labelpos="E", labelcolor=INK,
                fontproperties={"size": 7.5}, zorder=6,
            )  # fmt: skip
            seen.add(key)


def _round(least: float) -> float:
    """1, 2 or 5 times a power of ten, the nearest above."""
    power = 10.0 ** np.floor(np.log10(least))
    return float(next(k * power for k in (1.0, 2.0, 5.0, 10.0) if k * power >= least * 0.999999))

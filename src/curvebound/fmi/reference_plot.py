"""The plots of the reference result in an FMU's documentation: one SVG for each variable."""

from __future__ import annotations

from html import escape

from ..numbers import plain, ticks
from ..units import labelled
from .declaration import Fmu
from .reference import ReferenceResult

__all__ = ["reference_plots"]

# of a plot, in pixels: they stand beside each other as far as the page is wide
_WIDTH, _HEIGHT = 360, 190
_LEFT, _RIGHT, _TOP, _BOTTOM = 52, 10, 26, 36
_COLOURS = 8  # --result-0 and so on


def reference_plots(fmu: Fmu, result: ReferenceResult) -> str:
    """The outputs named in the declaration over time, as HTML."""
    units = {v.name: v.unit for v in fmu.variables}
    plots = [
        _plot(labelled(name, units[name]), result.time, result.outputs[name], number % _COLOURS)
        for number, name in enumerate(fmu.plotted)
    ]
    return f'<div class="plots">{"".join(plots)}</div>'


def _plot(title: str, time: list[float], values: list[float], colour: int) -> str:
    end, low, high = time[-1], min(values), max(values)
    if high - low <= 1e-12 * max(abs(low), abs(high)):  # constant but for rounding
        low, high = low - 1.0, high + 1.0
    right, bottom = _WIDTH - _RIGHT, _HEIGHT - _BOTTOM

    def across(t: float) -> float:
        return _LEFT + (right - _LEFT) * t / end

    def up(value: float) -> float:
        return _TOP + (bottom - _TOP) * (high - value) / (high - low)

    shapes = [f'<text class="title" x="{_LEFT}" y="17">{escape(title)}</text>']
    for value in ticks(low, high):
        y = f"{up(value):.1f}"
        shapes.append(
            f'<path class="grid" d="M{_LEFT} {y}H{right}"/>'
            f'<text x="{_LEFT - 6}" y="{up(value) + 4:.1f}" text-anchor="end">'
            f"{plain(value, 12)}</text>"
        )
    for t in ticks(0.0, end):
        x = f"{across(t):.1f}"
        shapes.append(
            f'<path class="grid" d="M{x} {_TOP}V{bottom}"/>'
            f'<text x="{x}" y="{bottom + 15}" text-anchor="middle">{plain(t, 12)}</text>'
        )
    points = " ".join(
        f"{across(t):.1f},{up(value):.1f}" for t, value in zip(time, values, strict=True)
    )
    return (
        f'<svg viewBox="0 0 {_WIDTH} {_HEIGHT}" role="img" '
        f'aria-label="{escape(title)} over time">{"".join(shapes)}'
        f'<text x="{(_LEFT + right) // 2}" y="{_HEIGHT - 5}" text-anchor="middle">time (s)</text>'
        f'<polyline class="result-{colour}" points="{points}"/></svg>'
    )

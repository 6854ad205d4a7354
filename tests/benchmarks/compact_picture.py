"""The maps of an FMU in one small picture (SVG of a few kB), for the documentation it carries."""

from __future__ import annotations

import math
import re
from collections.abc import Sequence
from pathlib import Path

from curvebound.files import write_whole
from curvebound.numbers import plain, quantity
from curvebound.pages import themed
from curvebound.study.figures import COLOURS, GREY, GRID, INK, PALETTE
from curvebound.study.stability.maps import Request
from curvebound.study.stability.stability_map import StabilityMap
from curvebound.units import labelled

from .catalogue import Named

__all__ = ["write_compact"]

#: of a panel, in pixels; panels in a row
WIDTH, HEIGHT, LEFT, TOP, GAP, ROW = 250, 130, 52, 30, 34, 2


def write_compact(
    found: Sequence[tuple[Request, Sequence[StabilityMap]]], folder: Path
) -> list[Path]:
    """Write NAME/stability.svg for each FMU of the catalogue's maps; NAME is that of its folder."""
    by_fmu: dict[str, list[tuple[Named, Sequence[StabilityMap]]]] = {}
    for request, maps in found:
        if isinstance(request, Named):
            by_fmu.setdefault(request.fmu, []).append((request, maps))
    paths = []
    for fmu, own in by_fmu.items():
        stem = re.sub(r"(?<=[a-z0-9])(?=[A-Z])", "_", fmu).lower()
        text = _picture(own)
        paths.append(
            write_whole(
                folder / stem / "stability.svg",
                lambda out, text=text: out.write_text(text, encoding="utf-8"),  # type: ignore[misc]
            )
        )
    return paths


def _picture(found: Sequence[tuple[Named, Sequence[StabilityMap]]]) -> str:
    methods = [one.method for one in found[0][1] if one.method != "adaptive"]
    rows = math.ceil(len(found) / ROW)
    width = ROW * (LEFT + WIDTH) + 12
    height = rows * (TOP + HEIGHT + GAP) + 24
    panels = []
    for number, (request, maps) in enumerate(found):
        row, place = divmod(number, ROW)
        x, y = place * (LEFT + WIDTH) + LEFT, row * (TOP + HEIGHT + GAP) + TOP
        panels.append(f'<g transform="translate({x},{y})">{_panel(request, maps)}</g>')
    legend = []
    for i, method in enumerate(methods):
        x = LEFT + 140 * i
        legend.append(
            f'<path class="{method}" d="M{x} {height - 12}h18"/>'
            f'<text x="{x + 23}" y="{height - 8}">{method}</text>'
        )
    lines = "".join(f".{method}{{stroke:{COLOURS[method]}}}" for method in methods)
    return themed(
        f'<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 {width} {height}" '
        f'font-family="sans-serif" font-size="10" fill="none" stroke-width="1.5" role="img" '
        'aria-label="largest accurate and stable steps over parameters">'
        f"<style>text{{fill:{INK};stroke:none}}.u{{stroke-dasharray:4 3}}{lines}"
        f".box{{stroke:{GREY};stroke-width:.7}}.grid{{stroke:{GRID};stroke-width:.5}}"
        f".paper{{fill:{PALETTE['paper']}}}</style>"
        f'<rect class="paper" width="{width}" height="{height}"/>'
        f"{''.join(panels)}{''.join(legend)}</svg>\n"
    )


def _panel(request: Named, maps: Sequence[StabilityMap]) -> str:
    """Largest accurate step (solid) and stable step (dashed) of each method, at equidistant values;
    at the rim where it lies beyond the steps tried."""
    shown = [one for one in maps if one.method != "adaptive"]
    columns = shown[0].columns
    low = min(math.log10(c.sizes[0]) for c in columns)
    high = max(math.log10(c.sizes[-1]) for c in columns)

    def across(i: int) -> float:
        return WIDTH * (i + 0.5) / len(columns)

    def up(size: float) -> float:
        return HEIGHT * (high - math.log10(size)) / (high - low)

    name = labelled(request.axis.path.partition(".")[2], request.unit)
    parts = [
        f'<text x="0" y="-6" font-size="11">{name}</text>'
        f'<rect class="box" width="{WIDTH}" height="{HEIGHT}"/>'
    ]
    for decade in range(math.ceil(low), math.floor(high) + 1):
        if decade % 2 == 0 or high - low < 4:
            y = up(10.0**decade)
            parts.append(
                f'<path class="grid" d="M0 {y:.1f}h{WIDTH}"/>'
                f'<text x="-4" y="{y + 3:.1f}" text-anchor="end">'
                f"{quantity(10.0**decade, 's')}</text>"
            )
    every = math.ceil(len(columns) / 7)
    middle = next((i for i, c in enumerate(columns) if c.value == 0.0), 0)
    for i, column in enumerate(columns):
        if (i - middle) % every == 0:
            text = plain(column.value, 1)
            parts.append(
                f'<text x="{across(i):.1f}" y="{HEIGHT + 12}" text-anchor="middle">{text}</text>'
            )
    for one in shown:
        for what, style in (("stable", " u"), ("accurate", "")):
            points = " ".join(
                f"{across(i):.0f},{up(_within(getattr(c, what), c.sizes)):.0f}"
                for i, c in enumerate(one.columns)
            )
            parts.append(f'<polyline class="{one.method}{style}" points="{points}"/>')
    return "".join(parts)


def _within(size: float, sizes: Sequence[float]) -> float:
    if math.isnan(size):
        return sizes[0]
    return min(size, sizes[-1])

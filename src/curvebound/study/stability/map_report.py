"""What stability maps leave on disk: CSV, pictures and pages."""

from __future__ import annotations

import html
import math
from collections.abc import Sequence
from pathlib import Path
from typing import Any
from urllib.parse import quote

from ...files import inside, remove
from ...numbers import plain, quantity
from ...pages import figure, report, table, write_page
from ...units import labelled
from ..data_files import write_rows
from .maps import Request
from .pictures import draw
from .probe import FAILED, UNKNOWN
from .stability_map import RESOLUTION, Column, StabilityMap

__all__ = ["files_of", "nothing_known", "write_index", "write_map"]


_WORDS = (
    "Unstable: the energy is wrong by more than ten times all that is at stake in the exact "
    "motion, or an output is ten times as large as it may be. The exact motion is that of adaptive "
    "at a tolerance of 1e-11, where its energy balance holds to a millionth (unknown otherwise), "
    "with the macro step of the scene where it is coupled. The boundaries were found by bisection "
    f"to {RESOLUTION - 1.0:.0%}; adaptive is mapped over its tolerance, since it chooses its step. "
    "Linear theory: where the method lets the energy of a mode grow to 21 times itself within the "
    "run, for the equations in minimal coordinates linearised at rest, and along the exact motion "
    "at its worst moment."
)


def nothing_known(maps: Sequence[StabilityMap]) -> str:
    """Why not one run could be judged at any value; empty where one could."""
    verdicts = [v for one in maps for column in one.columns for v in column.verdicts.values()]
    return verdicts[0].message if all(v.kind == UNKNOWN for v in verdicts) else ""


def files_of(request: Request, folder: Path) -> list[Path]:
    """The page, the grid and the boundaries of a map, as write_map writes them into `folder`."""
    endings = (".html", ".csv", "_boundaries.csv")
    return [inside(folder, request.axis.path, ending) for ending in endings]


def write_map(
    request: Request,
    maps: Sequence[StabilityMap],
    scene: str,
    unit: str,
    folder: Path,
    *,
    plots: bool = True,
) -> Path:
    """Write grid and boundaries as CSV, the picture, and the page that shows them; the page."""
    path = request.axis.path
    page, grid, boundaries = files_of(request, folder)
    write_rows(_grid(maps, path), grid)
    write_rows(_boundaries(maps, path), boundaries)
    label = labelled(path, unit)
    picture = ""
    if plots:
        _, svg, narrow = draw(maps, label, page.with_suffix(".png"))
        picture = figure(svg, "verdicts over value and step, one panel for each method")
        remove(svg)
        remove(narrow)
    title = f"{scene}: step against {label}"
    durations = sorted({column.duration for column in maps[0].columns})
    runs = quantity(durations[0], "s")
    if len(durations) > 1:
        runs = f"{runs} to {quantity(durations[-1], 's')} (see the column duration of the CSV)"
    changes = "".join(f", {name} = {value}" for name, value in request.changes)
    body = (
        f"<main><h1>{html.escape(title)}</h1>"
        f"<p>Runs of {runs}{html.escape(changes)}. Accurate: relative error at most "
        f"{plain(request.accuracy)}. {_WORDS}</p>"
        f"{picture}<h2>Largest steps</h2>{_steps(maps, label)}{_failures(maps)}</main>"
    )
    return write_page(page, report(title, body, "Made by curvebound stability."))


def write_index(pages: Sequence[tuple[str, Path]], folder: Path) -> Path:
    """A page that leads to the maps; (title, page) of each."""
    addresses = [quote(page.relative_to(folder).as_posix()) for _, page in pages]
    items = "".join(
        f'<li><a href="{html.escape(address)}">{html.escape(title)}</a>'
        for address, (title, _) in zip(addresses, pages, strict=True)
    )
    body = f"<main><h1>Stability maps</h1><ul>{items}</ul></main>"
    text = report("Stability maps", body, "Made by curvebound stability.")
    return write_page(folder / "index.html", text)


def _grid(maps: Sequence[StabilityMap], path: str) -> list[dict[str, Any]]:
    return [
        {
            "method": one.method,
            path: column.value,
            "duration": column.duration,
            "size_is": one.size_is,
            "size": size,
            "verdict": verdict.kind,
            "error": None if math.isnan(verdict.error) else verdict.error,
            "energy": None if math.isnan(verdict.energy) else verdict.energy,
            "run": "assumed" if size in column.assumed else "run",
            "message": verdict.message,
        }
        for one in maps
        for column in one.columns
        for size, verdict in column.verdicts.items()
    ]


def _boundaries(maps: Sequence[StabilityMap], path: str) -> list[dict[str, Any]]:
    """Empty where the smallest step tried is not so, inf where the largest is."""
    return [
        {
            "method": one.method,
            path: column.value,
            "size_is": one.size_is,
            **{
                name: None if math.isnan(value) else value
                for name, value in (
                    ("accurate_below", column.accurate),
                    ("stable_below", column.stable),
                    ("theory_at_rest", column.at_rest),
                    ("theory_in_motion", column.in_motion),
                )
            },
        }
        for one in maps
        for column in one.columns
    ]


def _size(x: float, column: Column, unit: str) -> str:
    if any(verdict.kind == UNKNOWN for verdict in column.verdicts.values()):
        return "unknown"
    if math.isnan(x):
        return f"< {quantity(column.sizes[0], unit)}"
    return f"≥ {quantity(column.sizes[-1], unit)}" if math.isinf(x) else quantity(x, unit)


def _steps(maps: Sequence[StabilityMap], label: str) -> str:
    """The table of largest accurate and stable steps, two columns for each method."""
    head = [label]
    for one in maps:
        head += [f"{one.method}, accurate", "stable"]
    rows = []
    for i, column in enumerate(maps[0].columns):
        row = [plain(column.value, 4)]
        for one in maps:
            own, unit = one.columns[i], "" if one.size_is == "tolerance" else "s"
            row += [_size(own.accurate, own, unit), _size(own.stable, own, unit)]
        rows.append(row)
    return table(head, rows)


def _failures(maps: Sequence[StabilityMap]) -> str:
    """The first message of each method that fails, and of an unknown reference."""
    items = []
    for kind, words in ((FAILED, "failed"), (UNKNOWN, "are unknown")):
        for one in maps:
            found = [
                (column.value, verdict.message)
                for column in one.columns
                for verdict in column.verdicts.values()
                if verdict.kind == kind
            ]
            if found:
                value, message = found[0]
                items.append(
                    f"<li>{one.method}: {len(found)} of the runs {words}, for example at "
                    f"{plain(value, 4)}: {html.escape(message)}</li>"
                )
    return f"<h2>Messages</h2><ul>{''.join(items)}</ul>" if items else ""

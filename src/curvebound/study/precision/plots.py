"""The pictures of a study, as PNG and SVG."""

from __future__ import annotations

import math
from collections.abc import Iterable, Sequence
from pathlib import Path
from typing import Any

from ...numbers import quantity
from ...units import labelled
from ..figures import COLOURS, GREY, INK, PALETTE, heading, logarithmic, new_figure, save
from .lessons import pareto, usable

__all__ = ["draw_macro", "draw_precision", "draw_trust", "draw_work"]

Row = dict[str, Any]

_OTHERS = tuple(PALETTE[f"result-{number}"] for number in (0, 1, 2, 3, 4, 5, 7))
_MARKS = ("o", "s", "^", "D", "v", "P", "X", "*")
_DASHES: tuple[Any, ...] = ("-", (0, (5, 2)), (0, (2, 1.5)), (0, (1, 1.5)))


def _log(axes: Any, x: str, y: str, title: str) -> None:
    logarithmic(axes.xaxis)
    logarithmic(axes.yaxis)
    axes.set_xlabel(x, fontsize=8.5, color=INK)
    axes.set_ylabel(y, fontsize=8.5, color=INK)
    axes.set_title(title, fontsize=9.5, color=INK, loc="left")


def _times(axis: Any) -> None:
    """Make an axis of times logarithmic, with several ticks to a decade where there are few."""
    from matplotlib.ticker import LogLocator

    low, high = axis.get_view_interval()
    decades = math.log10(high / low)
    subs = (1.0, 2.0, 5.0) if decades < 1.5 else (1.0, 3.0) if decades < 3.0 else (1.0,)
    logarithmic(axis, lambda x: quantity(x, "s"))
    axis.set_major_locator(LogLocator(subs=subs))


def _families(rows: Iterable[Row]) -> dict[tuple[str, str], list[Row]]:
    found: dict[tuple[str, str], list[Row]] = {}
    for row in rows:
        found.setdefault((row["form"], row["method"]), []).append(row)
    return found


def _floor(rows: Sequence[Row], error: str) -> float:
    """What an error of exactly zero is drawn as."""
    return max(1e-17, 0.3 * min((r[error] for r in rows if r[error] > 0.0), default=1e-16))


def _legend(figure: Any, forms: Sequence[str], methods: Sequence[str], columns: int) -> None:
    """One legend under the figure: colours are methods, marks are forms."""
    from matplotlib.lines import Line2D

    handles = [
        Line2D([], [], color=_colour(method), marker="o", markersize=4, label=method)
        for method in methods
    ]
    if len(forms) > 1:
        handles += [
            Line2D([], [], color=GREY, linestyle=_DASHES[i % 4], marker=_MARKS[i % 8],
                   markersize=5, label=form)
            for i, form in enumerate(forms)
        ]  # fmt: skip
    figure.legend(
        handles=handles, loc="outside lower center", ncols=min(len(handles), columns), fontsize=8,
        frameon=False, labelcolor=INK,
    )  # fmt: skip


def _colour(method: str) -> str:
    return COLOURS.get(method) or _OTHERS[sum(map(ord, method)) % len(_OTHERS)]


def _line(axes: Any, rows: Sequence[Row], x: str, error: str, form: int, floor: float) -> None:
    axes.plot(
        [row[x] for row in rows], [max(row[error], floor) for row in rows],
        color=_colour(rows[0]["method"]), linestyle=_DASHES[form % 4], marker=_MARKS[form % 8],
        markersize=4 if len(rows) > 1 else 6, linewidth=1.2,
    )  # fmt: skip


def draw_work(rows: Sequence[Row], out: Path, title: str, unit: str) -> list[Path]:
    """Error over cost, one panel per macro step, with the Pareto front."""
    return save(lambda stacked: _work(rows, title, unit, stacked), out)


def _work(rows: Sequence[Row], title: str, unit: str, stacked: bool) -> Any:
    good = [row for row in usable(rows) if row["error"] < 1e3]
    steps = sorted({row["macro_step"] for row in good if row["method"] != "exact"}, reverse=True)
    shown = [s for s in steps if any(r["macro_step"] == s for r in good)][:3] or steps
    if not shown:
        return None
    forms = list(dict.fromkeys(row["form"] for row in rows))
    methods = [m for m in COLOURS if any(row["method"] == m for row in good)]
    figure, axes = new_figure(3.8, 4.6, len(shown), stacked=stacked)
    floor = _floor(good, "error")
    for one, step in zip(axes, shown, strict=True):
        _log(one, "CPU time per simulated s", labelled("largest error", unit),
             f"macro step {quantity(step, 's')}")  # fmt: skip
        here = [row for row in good if row["macro_step"] == step]
        front = pareto(here)
        if front:
            one.plot(
                [r["cpu"] for r in front], [max(r["error"], floor) for r in front],
                color=GREY, linewidth=7, alpha=0.35, solid_capstyle="round", zorder=1,
                drawstyle="steps-post",
            )  # fmt: skip
        for (form, _), family in _families(here).items():
            _line(one, family, "cpu", "error", forms.index(form), floor)
        _times(one.xaxis)
    for one in axes[1:]:
        one.sharey(axes[0])
        if not stacked:
            one.set_ylabel("")
    heading(figure, f"{title}: work and precision (grey: Pareto front)", stacked=stacked)
    _legend(figure, forms, methods, 2 if stacked else 5)
    return figure


def draw_precision(rows: Sequence[Row], out: Path, title: str, unit: str) -> list[Path]:
    """Numerical error over micro step, and over tolerance."""
    return save(lambda stacked: _precision(rows, title, unit, stacked), out)


def _precision(rows: Sequence[Row], title: str, unit: str, stacked: bool) -> Any:
    good = [row for row in usable(rows, error="numerical") if row["numerical"] < 1e3]
    steps = sorted({row["macro_step"] for row in good})
    if not good:
        return None
    forms = list(dict.fromkeys(row["form"] for row in rows))
    methods = [m for m in COLOURS if any(row["method"] == m for row in good)]
    figure, (left, right) = new_figure(4.3, 4.6, 2, stacked=stacked)
    floor = _floor(good, "numerical")
    _log(left, "micro step (s)", labelled("largest numerical error", unit), "fixed steps")
    _log(right, "tolerance", left.get_ylabel() if stacked else "", "adaptive")
    merged: dict[tuple[str, str], dict[float, Row]] = {}
    for step in steps:  # of the same micro step, that with the longest macro step
        for row in good:
            if row["macro_step"] == step and row["size"]:
                own = merged.setdefault((row["form"], row["method"]), {})
                own[float(f"{row['size']:.6g}")] = row
    for (form, method), own in merged.items():
        family = [own[size] for size in sorted(own, reverse=True)]
        axes = right if method == "adaptive" else left
        _line(axes, family, "size", "numerical", forms.index(form), floor)
    tolerances = [row["size"] for row in good if row["size_is"] == "tolerance"]
    if tolerances:
        ends = [min(tolerances), max(tolerances)]
        right.plot(ends, ends, color=GREY, linewidth=0.8, linestyle=(0, (1, 3)))
        right.annotate(
            "error = tolerance", (ends[0], ends[0]), (4, -2), textcoords="offset points",
            fontsize=8, color=GREY, va="top",
        )  # fmt: skip
    right.sharey(left)
    heading(figure, f"{title}: what step and tolerance give", stacked=stacked)
    _legend(figure, forms, methods, 2 if stacked else 5)
    return figure


def draw_macro(rows: Sequence[Row], out: Path, title: str, unit: str) -> list[Path]:
    """Error over macro step for each coupling: to the scene as it stands, to continuous action."""
    return save(lambda stacked: _macro(rows, title, unit, stacked), out)


def _macro(rows: Sequence[Row], title: str, unit: str, stacked: bool) -> Any:
    good = usable(rows, purpose="macro")
    if not good:
        return None
    figure, (left, right) = new_figure(4.3, 4.2, 2, stacked=stacked)
    error = labelled("largest error", unit)
    _log(left, "macro step (s)", error, "to the scene at its own macro step")
    _log(right, "macro step (s)", error if stacked else "", "to action without holding")
    couplings = list(dict.fromkeys(row["coupling"] for row in good))
    for i, coupling in enumerate(couplings):
        own = [row for row in good if row["coupling"] == coupling]
        style = {
            "color": _OTHERS[i % 7], "marker": _MARKS[i % 8], "linestyle": _DASHES[i % 4],
            "markersize": 5, "linewidth": 1.2, "label": coupling,
        }  # fmt: skip
        for axes, what in ((left, "error"), (right, "from_continuous")):
            axes.plot([r["macro_step"] for r in own], [max(r[what], 1e-16) for r in own], **style)
    heading(figure, f"{title}: macro step and coupling", stacked=stacked)
    handles, labels = left.get_legend_handles_labels()
    figure.legend(handles, labels, loc="outside lower center", ncols=2 if stacked else 3,
                  fontsize=8, frameon=False, labelcolor=INK)  # fmt: skip
    return figure


def draw_trust(found: Sequence[tuple[str, Sequence[Any]]], out: Path, title: str) -> list[Path]:
    """True error over what each measure said; found: (words, points) per measure."""
    return save(lambda stacked: _trust(found, title, stacked), out)


def _trust(found: Sequence[tuple[str, Sequence[Any]]], title: str, stacked: bool) -> Any:
    shown = [(words, points) for words, points in found if points]
    if not shown:
        return None
    figure, axes = new_figure(3.6, 4.2, len(shown), stacked=stacked)
    for one, (words, points) in zip(axes, shown, strict=True):
        _log(one, "what it said", "true relative error", words)
        one.set_title(words, fontsize=8.5, color=INK, loc="left", wrap=True)
        for method in [m for m in COLOURS if any(p.method == m for p in points)]:
            own = [p for p in points if p.method == method]
            one.plot(
                [p.said for p in own], [p.true for p in own], linestyle="none", marker="o",
                markersize=3.2, alpha=0.55, color=_colour(method), label=method,
                markeredgewidth=0,
            )  # fmt: skip
        low = min(min(p.said, p.true) for p in points)
        high = max(max(p.said, p.true) for p in points)
        ends = [10.0 ** math.floor(math.log10(low)), 10.0 ** math.ceil(math.log10(high))]
        one.plot(ends, ends, color=GREY, linewidth=0.9)
        below, above = [e / 10 for e in ends], [e * 10 for e in ends]
        one.fill_between(ends, below, above, color=GREY, alpha=0.1, linewidth=0)
    heading(figure, f"{title}: measures against the truth (band: within 10 times)", stacked=stacked)
    methods = [m for m in COLOURS if any(p.method == m for _, ps in shown for p in ps)]
    _legend(figure, [], methods, 2 if stacked else 5)
    return figure

"""The pictures of a study, as PNG and SVG."""

from __future__ import annotations

import math
from collections.abc import Iterable, Sequence
from pathlib import Path
from typing import Any

from ..figures import COLOURS, GREY, INK, new_figure, save
from .lessons import pareto, usable

__all__ = ["draw_macro", "draw_precision", "draw_trust", "draw_work"]

Row = dict[str, Any]

_OTHERS = ("#0072b2", "#d55e00", "#009e73", "#cc79a7", "#e69f00", "#56b4e9", "#000000")
_MARKS = ("o", "s", "^", "D", "v", "P", "X", "*")
_DASHES: tuple[Any, ...] = ("-", (0, (5, 2)), (0, (2, 1.5)), (0, (1, 1.5)))


def _log(axes: Any, x: str, y: str, title: str) -> None:
    axes.set_xscale("log")
    axes.set_yscale("log")
    axes.set_xlabel(x, fontsize=8.5, color=INK)
    axes.set_ylabel(y, fontsize=8.5, color=INK)
    axes.set_title(title, fontsize=9.5, color=INK, loc="left")
    axes.minorticks_off()


def _families(rows: Iterable[Row]) -> dict[tuple[str, str], list[Row]]:
    found: dict[tuple[str, str], list[Row]] = {}
    for row in rows:
        found.setdefault((row["form"], row["method"]), []).append(row)
    return found


def _floor(rows: Sequence[Row], error: str) -> float:
    """What an error of exactly zero is drawn as."""
    return max(1e-17, 0.3 * min((r[error] for r in rows if r[error] > 0.0), default=1e-16))


def _legend(figure: Any, forms: Sequence[str], methods: Sequence[str]) -> None:
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
        handles=handles, loc="outside lower center", ncols=min(len(handles), 5), fontsize=8,
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


def draw_work(rows: Sequence[Row], out: Path, title: str) -> list[Path]:
    """Error over cost, one panel per macro step, with the Pareto front."""
    good = [row for row in usable(rows) if row["error"] < 1e3]
    steps = sorted({row["macro_step"] for row in good if row["method"] != "exact"}, reverse=True)
    shown = [s for s in steps if any(r["macro_step"] == s for r in good)][:3] or steps
    if not shown:
        return []
    forms = list(dict.fromkeys(row["form"] for row in rows))
    methods = [m for m in COLOURS if any(row["method"] == m for row in good)]
    figure, axes = new_figure(3.6 * len(shown) + 0.6, 4.6, len(shown))
    floor = _floor(good, "error")
    for one, step in zip(axes, shown, strict=True):
        _log(one, "CPU time per simulated second in s", "largest error", f"macro step {step:.3g} s")
        here = [row for row in good if row["macro_step"] == step]
        front = pareto(here)
        if front:
            one.plot(
                [r["cpu"] for r in front], [max(r["error"], floor) for r in front],
                color="#9aa7b8", linewidth=7, alpha=0.45, solid_capstyle="round", zorder=1,
                drawstyle="steps-post",
            )  # fmt: skip
        for (form, _), family in _families(here).items():
            _line(one, family, "cpu", "error", forms.index(form), floor)
    for one in axes[1:]:
        one.set_ylabel("")
        one.sharey(axes[0])
    figure.suptitle(f"{title}: work and precision (grey: Pareto front)", fontsize=11, x=0.01,
                    ha="left", color=INK)  # fmt: skip
    _legend(figure, forms, methods)
    return save(figure, out)


def draw_precision(rows: Sequence[Row], out: Path, title: str) -> list[Path]:
    """Numerical error over micro step, and over tolerance."""
    good = [row for row in usable(rows, error="numerical") if row["numerical"] < 1e3]
    steps = sorted({row["macro_step"] for row in good})
    if not good:
        return []
    forms = list(dict.fromkeys(row["form"] for row in rows))
    methods = [m for m in COLOURS if any(row["method"] == m for row in good)]
    figure, (left, right) = new_figure(8.6, 4.6, 2)
    floor = _floor(good, "numerical")
    _log(left, "micro step in s", "largest numerical error", "fixed steps")
    _log(right, "tolerance", "", "adaptive")
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
            fontsize=7, color=GREY, va="top",
        )  # fmt: skip
    right.sharey(left)
    figure.suptitle(f"{title}: what step and tolerance give", fontsize=11, x=0.01, ha="left",
                    color=INK)  # fmt: skip
    _legend(figure, forms, methods)
    return save(figure, out)


def draw_macro(rows: Sequence[Row], out: Path, title: str) -> list[Path]:
    """Error over macro step for each coupling: to the scene as it stands, to continuous action."""
    good = usable(rows, purpose="macro")
    if not good:
        return []
    figure, (left, right) = new_figure(8.0, 4.2, 2)
    _log(left, "macro step in s", "largest error", "to the scene at its own macro step")
    _log(right, "macro step in s", "", "to action without holding")
    couplings = list(dict.fromkeys(row["coupling"] for row in good))
    for i, coupling in enumerate(couplings):
        own = [row for row in good if row["coupling"] == coupling]
        style = {
            "color": _OTHERS[i], "marker": _MARKS[i], "linestyle": _DASHES[i % 4],
            "markersize": 5, "linewidth": 1.2, "label": coupling,
        }  # fmt: skip
        for axes, error in ((left, "error"), (right, "from_continuous")):
            axes.plot([r["macro_step"] for r in own], [max(r[error], 1e-16) for r in own], **style)
    figure.suptitle(f"{title}: macro step and coupling", fontsize=11, x=0.01, ha="left", color=INK)
    handles, labels = left.get_legend_handles_labels()
    figure.legend(handles, labels, loc="outside lower center", ncols=3, fontsize=8, frameon=False)
    return save(figure, out)


def draw_trust(found: Sequence[tuple[str, Sequence[Any]]], out: Path, title: str) -> list[Path]:
    """True error over what each measure said; found: (words, points) per measure."""
    shown = [(words, points) for words, points in found if points]
    if not shown:
        return []
    figure, axes = new_figure(3.4 * len(shown) + 0.4, 4.2, len(shown))
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
    figure.suptitle(f"{title}: measures against the truth (band: within 10 times)", fontsize=11,
                    x=0.01, ha="left", color=INK)  # fmt: skip
    methods = [m for m in COLOURS if any(p.method == m for _, ps in shown for p in ps)]
    _legend(figure, [], methods)
    return save(figure, out)

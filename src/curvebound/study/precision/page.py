"""The pages of a study: one file each that loads nothing from anywhere."""

from __future__ import annotations

import html
import math
import re
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any
from urllib.parse import quote

from ...files import inside
from ...numbers import plain, quantity
from ...pages import Html, figure, report, table, write_page
from ...units import labelled
from .lessons import crossings, equals, lessons, name_of, pareto, size_of, spread_of, usable
from .live_measures import MEASURES, Statement

__all__ = ["overview_page", "study_page"]

Row = dict[str, Any]


_COST = "CPU time per simulated s"


def _setting(row: Row) -> list[Any]:
    size = Html(f'<span class="whole">{html.escape(size_of(row) or "-")}</span>')
    return [name_of(row), size, quantity(row["macro_step"], "s")]


def study_page(
    out: Path,
    *,
    name: str,
    description: str,
    rows: Sequence[Row],
    references: Sequence[Row],
    paths: Sequence[str],
    unit: str,
    complete: bool,
    statements: Sequence[Statement],
    footer: str,
) -> Path:
    """Write the page of one scene to `out`; pictures are taken from the files beside it.

    unit: of the errors, all of them where the outputs have several.
    """
    folder = out.parent
    parts = [
        f"<header><h1>{html.escape(name)}</h1><p class=muted>{html.escape(description)}; errors of "
        f"{html.escape(', '.join(paths))}, the largest of them.</p></header><main>"
    ]
    if not complete:
        parts.append("<p><b>Unfinished:</b> the same command goes on where it was stopped.</p>")
    taught = lessons(rows, unit)
    if taught:
        items = "".join(f"<li>{html.escape(text)}</li>" for text in taught)
        parts.append(f"<h2>What it teaches</h2><ul>{items}</ul>")
    parts.append("<h2>The cheapest setting for an error</h2>")
    parts.append(_cheapest(rows, unit))
    parts.append("<h2>Work and precision</h2>")
    parts.append(figure(folder / "work.svg", "error over CPU time for every setting"))
    parts.append(figure(folder / "precision.svg", "error over micro step and tolerance"))
    if (folder / "macro.svg").is_file():
        parts.append("<h2>Macro step and coupling</h2>")
        parts.append(
            "<p>Left, against the scene as it stands, which holds values over its own macro step: "
            "another macro step is another scene. Right, against control and inputs that act all "
            "the time: what holding costs.</p>"
        )
        parts.append(figure(folder / "macro.svg", "error over macro step for each coupling"))
    parts.append("<h2>Pareto front</h2>")
    parts.append(_front(rows, unit))
    parts.append("<h2>Live measures against the truth</h2>")
    parts.append(_TRUST_WORDS)
    parts.append(_trust_table(statements))
    parts.append(figure(folder / "trust.svg", "true error over live measures"))
    parts.append("<h2>References</h2>")
    parts.append(_references(references, rows))
    failed = [row for row in rows if row["failure"]]
    if failed:
        parts.append(f"<h2>Failed: {len(failed)} settings</h2>")
        parts.append(
            table(
                ["settings", "first of them", "size", "macro step", "message"],
                [[len(same), *_setting(same[0]), message] for message, same in _alike(failed)],
                words=(1, 2, 4),
            )
        )
    parts.append(
        '<p>All rows: <a href="study.csv">study.csv</a>, <a href="study.json">study.json</a>.</p>'
        "</main>"
    )
    return write_page(out, report(f"{name}: a study", "\n".join(parts), footer))


def _cheapest(rows: Sequence[Row], unit: str) -> str:
    good = usable(rows)
    return table(
        [labelled("error below", unit), "setting", "size", "macro step", labelled("error", unit),
         _COST, "not told apart"],
        [
            [plain(level), *(_setting(row) if row else ["none", "-", "-"]),
             row["error"] if row else None, spread_of(row) if row else None,
             ", ".join(map(name_of, equals(good, level))) or "-"]
            for level, row in crossings(rows)
        ],
        words=(1, 2, 6),
    )  # fmt: skip


def _front(rows: Sequence[Row], unit: str) -> str:
    return table(
        ["setting", "size", "macro step", labelled("error", unit), "numerical", "of the model",
         _COST, "evaluations", "energy residual (J)", "drift (m)"],
        [
            [*_setting(r), r["error"], r["numerical"], r["modelling"], quantity(r["cpu"], "s"),
             r["evaluations"], r["energy_residual"], r["drift"]]
            for r in pareto(usable(rows))
        ],
        words=(0, 1),
    )  # fmt: skip


def _alike(failed: Sequence[Row]) -> list[tuple[str, list[Row]]]:
    """Failed rows by what the FMU said, whatever the time at which it said it."""
    found: dict[str, list[Row]] = {}
    for row in failed:
        found.setdefault(re.sub(r"\d[\d.e+-]*", "#", row["failure"]), []).append(row)
    return [(same[0]["failure"], same) for same in found.values()]


def _references(references: Sequence[Row], rows: Sequence[Row]) -> str:
    known = []
    for reference in references:
        model = ", ".join(f"{path}={item}" for path, item in reference["model"].items())
        for path, doubt in reference["uncertainty"].items():
            known.append([reference["what"], model or "-", path, doubt, reference["how"]])
    body = table(
        ["reference", "model", "output", "uncertainty", "two computations"],
        known,
        words=(0, 1, 2, 4),
    )
    unjudged = [r for r in rows if not r["failure"] and not r["judged"]]
    untils = [r["judged_until"] for r in rows if r["judged_until"] is not None and r["judged"]]
    words = ""
    if unjudged:
        words += (
            f"<p>{len(unjudged)} rows are not judged: their error is less than 100 times the "
            "uncertainty of the reference.</p>"
        )
    if untils and min(untils) < max(untils):
        words += (
            "<p>The motion amplifies errors: some rows are judged up to t = "
            f"{quantity(min(untils), 's', 4)} only, where the reference still holds for them.</p>"
        )
    return body + words


_TRUST_WORDS = (
    "<p>What can be read while a simulation runs, set against the true error of that run. Errors "
    "are relative to the range of the output. solver.tolerance: that of adaptive; energy.residual: "
    "its largest size over the largest kinetic energy; both against the numerical error. "
    "model.acceleration_error: its largest value, against the error of the linear model.</p>"
)


def _trust_table(statements: Sequence[Statement]) -> str:
    return table(
        ["measure", "of", "runs", "true / said, median", "from (5 %)", "to (95 %)",
         "over 10 times", "rank correlation", "so it is"],
        [
            [MEASURES[t.measure], t.group, t.count, t.median, t.low, t.high, f"{t.under:.0%}",
             None if math.isnan(t.correlation) else round(t.correlation, 2), t.verdict]
            for t in statements
        ],
        words=(0, 1, 8),
    )  # fmt: skip


def overview_page(
    out: Path, studies: Mapping[str, Row], statements: Sequence[Statement], footer: str
) -> Path:
    """Write the page of all scenes studied so far: the cheapest settings, and the measures."""
    parts = [
        "<header><h1>Studies</h1><p class=muted>What each setting costs and gains, by scene; and "
        "how far the live error measures can be trusted, over all of them.</p></header><main>"
    ]
    rows = []
    for name, study in studies.items():
        for level, row in crossings(study["rows"]):
            if level in (1e-2, 1e-6, 1e-10):
                rows.append(
                    [
                        name,
                        labelled(plain(level), study.get("unit", "")),
                        *(_setting(row) if row else ["none", "-", "-"]),
                        quantity(row["cpu"], "s") if row else None,
                    ]
                )
    links = "".join(
        f'<li><a href="{html.escape(quote(inside(Path(), name).name))}/index.html">'
        f"{html.escape(name)}</a>: "
        f"{html.escape(study['description'])}</li>"
        for name, study in studies.items()
    )
    parts.append(f"<ul>{links}</ul><h2>The cheapest setting for an error</h2>")
    parts.append(
        table(
            ["scene", "error below", "setting", "size", "macro step", _COST], rows, words=(0, 2, 3)
        )
    )
    parts.append("<h2>Predicted against real: the live measures, over all scenes</h2>")
    parts.append(_TRUST_WORDS)
    said = "".join(f"<li>{html.escape(t.sentence)}</li>" for t in statements if t.group == "all")
    parts.append(f"<ul>{said}</ul>")
    parts.append(_trust_table(statements))
    parts.append(figure(out.parent / "trust.svg", "true error over live measures, all scenes"))
    parts.append("</main>")
    return write_page(out, report("Studies", "\n".join(parts), footer))

"""From the rows of a study to its files: tables, pictures, page."""

from __future__ import annotations

import html
from collections.abc import Mapping, Sequence
from contextlib import suppress
from pathlib import Path
from typing import Any

from ...errors import CurveboundError
from ..data_files import read_json, write_json, write_rows
from .live_measures import MEASURES, Measured, Statement, points, statement
from .page import overview_page, study_page
from .plots import draw_macro, draw_precision, draw_trust, draw_work
from .study import Study

__all__ = ["write_overview", "write_study"]

Row = dict[str, Any]


def _footer() -> str:
    from ...machine import machine

    return html.escape("; ".join(f"{name} {value}" for name, value in machine().items()))


def _statements(
    studies: Mapping[str, Sequence[Row]],
) -> tuple[list[Statement], list[list[Measured]]]:
    """Per measure: over everything, and by formulation; with the points."""
    said: list[Statement] = []
    found = []
    for measure in MEASURES:
        every = points(measure, studies)
        found.append(every)
        whole = statement(measure, every)
        if whole is not None:
            said.append(whole)
        groups = list(dict.fromkeys(p.form for p in every))
        if len(groups) > 1:
            for group in groups:
                one = statement(measure, [p for p in every if p.form == group], group)
                if one is not None:
                    said.append(one)
    return said, found


def write_study(study: Study, folder: Path, *, plots: bool = True) -> Path:
    """Write study.csv, study.json, the pictures and index.html; returns the page."""
    name = study.scene.name
    statements, found = _statements({name: study.rows})
    write_rows(study.rows, folder / "study.csv")
    write_json(
        {
            "scene": name,
            "description": study.scene.description,
            "outputs": study.paths,
            "unit": study.unit,
            "complete": study.complete,
            "references": study.references,
            "rows": study.rows,
        },
        folder / "study.json",
    )
    if plots:
        draw_work(study.rows, folder / "work", name, study.unit)
        draw_precision(study.rows, folder / "precision", name, study.unit)
        draw_macro(study.rows, folder / "macro", name, study.unit)
        draw_trust(list(zip(MEASURES.values(), found, strict=True)), folder / "trust", name)
    return study_page(
        folder / "index.html",
        name=name,
        description=study.scene.description,
        rows=study.rows,
        references=study.references,
        paths=study.paths,
        unit=study.unit,
        complete=study.complete,
        statements=statements,
        footer=_footer(),
    )


def write_overview(folder: Path, *, plots: bool = True) -> tuple[Path, list[str]] | None:
    """Write the page of all studies in the subfolders; None where there is none.

    Returns the page and a sentence on each live measure: how far it can be trusted.
    """
    studies: dict[str, Row] = {}
    for file in sorted(folder.glob("*/study.json")):
        with suppress(Exception):  # of another version, or no study at all
            data = read_json(file)
            for row in data["rows"]:  # infinity became null
                for key in ("error", "numerical"):
                    row[key] = float("inf") if row.get(key) is None else row[key]
            studies[data["scene"]] = data
    if not studies:
        return None
    statements, found = _statements({name: data["rows"] for name, data in studies.items()})
    if plots:
        with suppress(CurveboundError):
            draw_trust(
                list(zip(MEASURES.values(), found, strict=True)), folder / "trust", "all scenes"
            )
    page = overview_page(folder / "index.html", studies, statements, _footer())
    return page, [one.sentence for one in statements if one.group == "all"]

"""Where a sweep's rows go: a CSV that grows row by row, and Parquet from it at the end."""

from __future__ import annotations

import csv
import io
import json
import math
from collections.abc import Iterable, Sequence
from contextlib import suppress
from pathlib import Path
from typing import Any

from ...cells import cell, defused, undefused
from ...errors import CurveboundError, OutsideError, reading
from ...files import append, remove, require_as_left, write_whole
from .task import Row

__all__ = ["Store", "read_sweep"]


class Store:
    """The rows of a sweep on disk.

    out: FILE.csv, or FILE.parquet: the rows then stream to FILE.csv.part beside it.
    identity: of the sweep; a file of another sweep is not touched.
    columns: paths that vary, then metrics.
    """

    def __init__(
        self, out: Path, identity: str, paths: Sequence[str], metrics: Sequence[str]
    ) -> None:
        self.out = out
        self.parquet = out.suffix == ".parquet"
        if not self.parquet and out.suffix != ".csv":
            raise CurveboundError(f"{out}: give a file name that ends in .csv or .parquet.")
        if self.parquet:
            from ..extras import require

            require("parquet")
        self.stream = out.with_suffix(".csv.part") if self.parquet else out
        self.note = out.with_name(out.name + ".sweep.json")
        self.identity = identity
        self.paths = list(paths)
        self.metrics = list(metrics)
        self.header = ["point", *paths, *metrics, "message"]
        self._kept: list[list[str]] = []

    def look(self, *, restart: bool = False) -> set[int]:
        """Numbers of the points that are done (none on a restart); nothing is changed yet."""
        self._kept = []
        if restart:
            return set()
        if self.stream.is_file():
            if self._noted() != self.identity:
                raise CurveboundError(
                    f"{self.stream} is there and not of this sweep: choose another --out, or "
                    "--restart to overwrite it."
                )
            self._kept = self._whole_rows()
        elif self.parquet and self.out.is_file() and self._noted() == self.identity:
            raise CurveboundError(f"{self.out} is complete; --restart makes it anew.")
        return {int(row[0]) for row in self._kept}

    def open(self) -> None:
        """Begin or go on with the rows that `look` found."""
        # rewritten: a process that was killed may have left half a row
        write_whole(self.stream, lambda path: _write(path, [self._head(), *self._kept]))
        note = json.dumps({"identity": self.identity}) + "\n"
        write_whole(self.note, lambda path: path.write_text(note, encoding="utf-8"))

    def _head(self) -> list[str]:
        return [defused(name) for name in self.header]

    def _noted(self) -> str:
        with suppress(Exception):  # not there, or no note of a sweep
            return str(json.loads(self.note.read_text(encoding="utf-8"))["identity"])
        return ""

    def _whole_rows(self) -> list[list[str]]:
        with reading(self.stream, "Choose another --out, or --restart to overwrite it."):
            text = self.stream.read_text(encoding="utf-8")
            complete = text[: text.rfind("\n") + 1]
            rows = list(csv.reader(complete.splitlines()))
        return [row for row in rows[1:] if len(row) == len(self.header) and row[0].isdigit()]

    def add(self, rows: Iterable[Row], points: Any) -> None:
        """Append rows, all or none of them; they are kept for another time."""
        text = io.StringIO()
        table = csv.writer(text, lineterminator="\n")
        for number, values, message in rows:
            point = points[number]
            table.writerow(
                [
                    number,
                    *(_cell(point[path]) for path in self.paths),
                    *(_cell(value) for value in values),
                    cell(" ".join(message.split())),
                ]
            )
        append(self.stream, text.getvalue())

    def finish(self, count: int) -> Path:
        """All `count` points are done: rows in their order; returns the file.

        Raises CurveboundError where the file does not hold just these.
        """
        require_as_left(self.stream)
        rows = sorted(self._whole_rows(), key=lambda row: int(row[0]))
        found = [int(row[0]) for row in rows]
        if found != list(range(count)):
            missing = count - len(set(found) & set(range(count)))
            raise CurveboundError(
                f"{self.stream} holds {len(rows)} rows, and {missing} of {count} points are not "
                "among them: something else has changed it. Run the sweep again, into a file of "
                "its own."
            )
        if not self.parquet:
            return write_whole(self.out, lambda path: _write(path, [self._head(), *rows]))
        import importlib

        pyarrow = importlib.import_module("pyarrow")
        parquet = importlib.import_module("pyarrow.parquet")

        columns: dict[str, Any] = {}
        for i, name in enumerate(self.header):
            column = [row[i] for row in rows]
            columns[name] = _texts(column) if name == "message" else _typed(name, column)
        write_whole(self.out, lambda path: parquet.write_table(pyarrow.table(columns), path))
        remove(self.stream)
        return self.out


def _write(path: Path, rows: Iterable[Sequence[Any]]) -> None:
    with path.open("w", newline="", encoding="utf-8") as file:
        csv.writer(file, lineterminator="\n").writerows(rows)


def _cell(value: Any) -> str:
    return cell(float(value) if isinstance(value, int | float) else value)


def _typed(name: str, column: list[str]) -> list[Any]:
    if name == "point":
        return [int(text) for text in column]
    try:
        return [float(text) if text else None for text in column]
    except ValueError:
        return _texts(column)


def _texts(column: list[str]) -> list[str]:
    return [undefused(text) for text in column]


def read_sweep(path: Path) -> tuple[list[str], list[list[Any]]]:
    """Header and rows of a sweep's CSV; numbers as floats, NaN where a point failed."""
    with reading(path), path.open(newline="", encoding="utf-8") as file:
        rows = list(csv.reader(file))
    if not rows or rows[0][:1] != ["point"]:
        raise OutsideError(f"{path} is no table of a sweep.")
    header = _texts(rows[0])
    columns = []
    for i, name in enumerate(header):
        column = (
            _typed(name, [row[i] for row in rows[1:]])
            if name != "message"
            else _texts([row[i] for row in rows[1:]])
        )
        columns.append([math.nan if value is None else value for value in column])
    return header, [list(row) for row in zip(*columns, strict=True)]

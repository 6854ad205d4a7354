"""CSV, the format that results are kept in: every digit kept, read back as it was."""

from __future__ import annotations

import csv
import io
import re
from collections.abc import Mapping, Sequence
from contextlib import suppress
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ..cells import defused, undefused
from ..errors import at, reading
from ..files import write_whole
from ..units import number

__all__ = ["Table", "as_csv", "read_csv", "write_csv"]

#: a unit behind a column's name
_UNIT = re.compile(r" \[([^]]*)\]$")

Table = NDArray[Any]  # structured: time, then one column per variable


def write_csv(data: Table, path: Path | str, units: Mapping[str, str] | None = None) -> Path:
    """Write a structured array as CSV: a header of its names, then one line per row.

    units: what to write in brackets behind names, such as `time [s]`, which read_csv leaves out.

    Floats are written by repr, so that reading gives the same bits; integers and Booleans (as 0
    and 1) without a point. The file appears whole or not at all; CurveboundError where it cannot.
    """
    columns: dict[str, list[float]] = {}
    for name in data.dtype.names or ():
        column = data[name]
        head = f"{name} [{units[name]}]" if units and name in units else name
        columns[head] = (column.astype(int) if column.dtype.kind in "biu" else column).tolist()
    text = as_csv(columns)
    return write_whole(Path(path), lambda to: to.write_text(text, encoding="utf-8", newline="\n"))


def as_csv(columns: Mapping[str, Sequence[float]]) -> str:
    """The text of write_csv."""
    text = io.StringIO()
    csv.writer(text, lineterminator="\n").writerow(map(defused, columns))
    for row in zip(*columns.values(), strict=True):
        text.write(",".join(map(repr, row)) + "\n")
    return text.getvalue()


def read_csv(path: Path | str, units: Mapping[str, str | None] | None = None) -> Table:
    """The table that Result.write or write_csv wrote, or any CSV with a header of names.

    Parameters
    ----------
    path : Path or str
        The file.
    units : mapping of str to str, optional
        Units in which columns are wanted: one whose name states another is converted. The column
        time always is, to s.

    Returns
    -------
    structured array, shape (rows,)
        A column whose every entry is an integer literal is int64, any other float64.

    Raises
    ------
    CurveboundError
        Names file and line where it is not such a table, or a column is of another quantity.
    """
    with reading(f"{path} cannot be read as a table", "Give a CSV with a line of names."):
        return _table(Path(path), {"time": "s", **(units or {})})


def _table(path: Path, units: Mapping[str, str | None]) -> Table:
    with path.open(newline="", encoding="utf-8-sig") as file:  # spreadsheets write a mark before
        reader = csv.reader(file)
        lines, rows = [], []
        for row in reader:
            if row:
                lines.append(reader.line_num)
                rows.append(row)
    if not rows:
        raise ValueError("it is empty; a table begins with a line of column names")
    heads = [undefused(name).strip().strip('"') for name in rows[0]]
    names = [_UNIT.sub("", head) for head in heads]
    for place, name in enumerate(names, 1):
        if not name:
            raise ValueError(f"column {place} has no name in line 1")
        if names.index(name) != place - 1:
            raise ValueError(f"line 1 names the column {name} twice")
    for line, row in zip(lines, rows, strict=True):
        if len(row) != len(names):
            raise ValueError(
                f"line {line} has {len(row)} entries where the header names {len(names)}"
            )
    arrays = []
    for i, name in enumerate(names):
        with at(f"column {name}"):
            column = _column([row[i] for row in rows[1:]])
            arrays.append(_in_unit(column, _UNIT.search(heads[i]), units.get(name)))
    table = np.zeros(
        len(rows) - 1, dtype=[(n, a.dtype) for n, a in zip(names, arrays, strict=True)]
    )
    for name, array in zip(names, arrays, strict=True):
        table[name] = array
    return table


def _column(texts: list[str]) -> NDArray[Any]:
    if texts and all(text.strip().lstrip("+-").isdigit() for text in texts):
        with suppress(OverflowError):  # beyond 64 bits: as near as doubles come
            return np.array([int(text) for text in texts], dtype=np.int64)
    return np.array([float(text) for text in texts], dtype=np.float64)


def _in_unit(
    column: NDArray[Any], stated: re.Match[str] | None, wanted: str | None
) -> NDArray[Any]:
    """A column in the unit that is wanted; ValueError where the stated one is of something else."""
    unit = "" if stated is None else stated[1].strip()
    if wanted is None or unit in ("", "-", "1", wanted):
        return column
    try:
        factor = number(f"1 {unit}", wanted)
    except ValueError:
        raise ValueError(f"its unit, {unit}, is none of {wanted}") from None
    return column if factor == 1.0 else column * factor

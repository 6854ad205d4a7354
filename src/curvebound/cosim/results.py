"""What a run gives back, and the one file format that it is kept in."""

from __future__ import annotations

import csv
import io
import re
from collections.abc import Mapping, Sequence
from contextlib import suppress
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ..cells import defused, undefused
from ..errors import CurveboundError, at, reading
from ..files import write_whole
from ..fmi.drawing import Drawing

__all__ = ["Result", "RunFailed", "RunInterrupted", "as_csv", "read_csv", "write_csv"]

#: a unit behind a column's name
_UNIT = re.compile(r" \[[^]]*\]$")

Table = NDArray[Any]  # structured: time, then one column per variable


@dataclass
class Result:
    """A run of a scene.

    Attributes
    ----------
    data : structured array, shape (points,)
        Columns ``time`` (s) and ``component.variable`` in the units of `units`, one row for each
        recorded communication point, the initial one included.
    wall, stepping : float
        Seconds that the run took, loading and initialization included, and those spent between the
        initial point and the last, recording included.
    steps, trials, rejected : int
        Macro steps of the solution; those computed to find it (adaptive: every full and half step,
        rejected ones included, else `steps`); those taken back.
    units : dict of str to str
        Unit by path.
    drawings : dict of str to Drawing
        What to draw of each component, where its FMU tells.
    notes : list of str
        What the user should know once: warnings of the FMUs, inputs left at their start.
    settings : dict
        With what it was run.
    complete : bool
        False when the run ended before the stop time; `failure` then says why.
    """

    scene: str
    data: Table
    wall: float = 0.0
    stepping: float = 0.0
    steps: int = 0
    trials: int = 0
    rejected: int = 0
    units: dict[str, str] = field(default_factory=dict)
    drawings: dict[str, Drawing] = field(default_factory=dict)
    notes: list[str] = field(default_factory=list)
    settings: dict[str, Any] = field(default_factory=dict)
    complete: bool = True
    failure: str = ""

    @property
    def time(self) -> NDArray[np.float64]:
        """Communication points in s, shape (points,)."""
        return np.asarray(self.data["time"], dtype=np.float64)

    @property
    def names(self) -> list[str]:
        """The recorded variables, `component.variable`."""
        return [name for name in self.data.dtype.names or () if name != "time"]

    def __getitem__(self, name: str) -> NDArray[Any]:
        return np.asarray(self.data[name])

    def write(self, path: Path | str, *, with_units: bool = False) -> Path:
        """Keep the data as CSV, JSON, Parquet or NPZ: as the name ends, every digit kept.

        Parameters
        ----------
        path : Path or str
            The file, which appears whole or not at all: .csv, .json, .parquet or .npz.
        with_units : bool
            In a CSV, write units behind the names, as in ``a.x [m]``.

        Returns
        -------
        Path
            The same.

        Raises
        ------
        CurveboundError
            It cannot be written, or has another ending.
        """
        from .formats import write_table

        return write_table(self.data, Path(path), self.units, with_units=with_units)


class RunFailed(CurveboundError):
    """A run that ended before its time.

    Attributes
    ----------
    result : Result
        What was recorded up to there.
    component, cause : str
        Which component failed, and what it said.
    time : float
        When, in s.
    """

    def __init__(self, message: str, result: Result, component: str, time: float, cause: str):
        super().__init__(message)
        self.result = result
        self.component = component
        self.time = time
        self.cause = cause


class RunInterrupted(KeyboardInterrupt):
    """A run that the keyboard stopped; `time` in s, `result` holds what was recorded up to there.

    Not a RunFailed: what goes on after a failed run must stop here.
    """

    def __init__(self, failed: RunFailed):
        super().__init__(str(failed))
        self.result = failed.result
        self.time = failed.time


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


def read_csv(path: Path | str) -> Table:
    """The table that Result.write or write_csv wrote, or any CSV with a header of names.

    Parameters
    ----------
    path : Path or str
        The file.

    Returns
    -------
    structured array, shape (rows,)
        A column whose every entry is an integer literal is int64, any other float64.

    Raises
    ------
    CurveboundError
        Names file and line where it is not such a table.
    """
    with reading(f"{path} cannot be read as a table", "Give a CSV with a line of names."):
        return _table(Path(path))


def _table(path: Path) -> Table:
    with path.open(newline="", encoding="utf-8") as file:
        reader = csv.reader(file)
        lines, rows = [], []
        for row in reader:
            if row:
                lines.append(reader.line_num)
                rows.append(row)
    if not rows:
        raise ValueError("it is empty; a table begins with a line of column names")
    names = [_UNIT.sub("", undefused(name).strip().strip('"')) for name in rows[0]]
    for number, name in enumerate(names, 1):
        if not name:
            raise ValueError(f"column {number} has no name in line 1")
        if names.index(name) != number - 1:
            raise ValueError(f"line 1 names the column {name} twice")
    for number, row in zip(lines, rows, strict=True):
        if len(row) != len(names):
            raise ValueError(
                f"line {number} has {len(row)} entries where the header names {len(names)}"
            )
    arrays = []
    for i, name in enumerate(names):
        with at(f"column {name}"):
            arrays.append(_column([row[i] for row in rows[1:]]))
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

"""Reads a result file and says in words what is wrong with it.

A file as `curvebound run` writes it is read by `cosim.read_csv`; only what that refuses, another
tool's dialect or a damaged file, is looked at here.
"""

from __future__ import annotations

import csv
import re
from collections.abc import Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ..cells import undefused
from ..cosim.results import Result
from ..cosim.tables import read_csv
from ..errors import CurveboundError, OutsideError, reading
from ..fmi.drawing import Drawing
from .actors import drawings_of

__all__ = ["Opened", "Reading", "Results", "check_result", "opened", "read_result", "with_inputs"]

_MOST_LISTED = 12
_REMEDY = "Give the file that `curvebound run SCENE --out FILE.csv` wrote."
_TIME_NAMES = ("time", "t")
_UNIT_SUFFIX = re.compile(r"\s*[\[(][^\[\]()]*[\])]\s*$")
_WORDS = {"true": 1.0, "false": 0.0, "": float("nan")}


@dataclass(frozen=True)
class Reading:
    """A result as a structured array (`time` first), and what was odd about its file."""

    data: NDArray[Any]
    notes: tuple[str, ...] = field(default=())


#: a result of a run, or its structured array alone; or several with labels
Results = Result | NDArray[Any] | Sequence[tuple[str, Result | NDArray[Any]]]


@dataclass(frozen=True)
class Opened:
    """A result to be shown: its samples, and the drawings of its components by prefix."""

    label: str
    data: NDArray[Any]
    drawings: dict[str, Drawing]


def opened(results: Results, known: Sequence[Drawing]) -> list[Opened]:
    """The results with what is to be drawn of them.

    A Result tells the drawings of its components; columns alone are recognised as those of one of
    the drawings `known`. Raises CurveboundError where one is no result.
    """
    if isinstance(results, Result | np.ndarray):
        results = [("The result", results)]
    shown = []
    for label, given in results:
        data = np.atleast_1d(with_inputs(given) if isinstance(given, Result) else given)
        check_result(label, data)
        own = given.drawings if isinstance(given, Result) else {}
        shown.append(Opened(label, data, drawings_of(data, known, own)))
    return shown


def with_inputs(result: Result) -> NDArray[Any]:
    """The columns of a result, and those of the inputs that drawings show."""
    data = result.data
    more = {name: values for name, values in result.inputs.items() if name not in result.names}
    if not more:
        return data
    made = np.empty(data.shape, [*data.dtype.descr, *((name, np.float64) for name in more)])
    for name in data.dtype.names or ():
        made[name] = data[name]
    for name, values in more.items():
        made[name] = values
    return made


def read_result(path: Path) -> Reading:
    """Read the CSV file at `path`.

    The first line names the columns, one of which is `time` (`t` and a unit in brackets are
    understood too); commas, semicolons and tabulators separate. A last line that was cut off and
    columns that hold no numbers are left out and noted.

    Raises CurveboundError, naming the line, where the file is missing, empty, no table of numbers,
    or its time does not run forward.
    """
    with reading(f"{path} cannot be read", _REMEDY):
        return _read(path)


def _read(path: Path) -> Reading:
    try:
        ours = read_csv(path)
    except CurveboundError:
        pass
    else:
        if "time" in (ours.dtype.names or ()) and ours.size:
            check_result(str(path), ours)
            return Reading(ours)
    try:
        text = path.read_text(encoding="utf-8-sig")
    except FileNotFoundError:
        raise OutsideError(
            f"There is no file {path}. Write one with `curvebound run SCENE --out {path}`."
        ) from None
    except UnicodeDecodeError:
        raise OutsideError(f"{path} is not text, so not a result in CSV. {_REMEDY}") from None
    lines = text.splitlines()
    while lines and not lines[-1].strip():
        lines.pop()
    if not lines:
        raise OutsideError(
            f"{path} is empty: the run that should have written it did not finish. Run it again."
        )
    delimiter = max(",;\t", key=lines[0].count)
    header = next(csv.reader([lines[0]], delimiter=delimiter))
    names = [undefused(name).strip() for name in header]
    columns = _columns(path, names)
    if len(lines) == 1:
        raise OutsideError(
            f"{path} holds the names of {len(names)} columns and no sample: "
            "the run that wrote it failed before its first point. Run it again."
        )
    table, notes = _table(path, lines, len(names), delimiter)
    return _assemble(path, columns, table, notes)


def check_result(label: str, data: NDArray[Any]) -> None:
    """Raise CurveboundError where `data` is no result: no `time`, no sample, time not forward."""
    names = data.dtype.names
    if not names or "time" not in names:
        raise OutsideError(f"{label} has no column `time`. {_listed(list(names or ()))}")
    if not data.size:
        raise OutsideError(f"{label} holds no sample: the run failed before its first point.")
    time = np.atleast_1d(data)["time"]
    if not np.all(np.isfinite(time)):
        row = int(np.argmin(np.isfinite(time)))
        raise OutsideError(
            f"{label}: the time of sample {row + 1} is {time[row]!s}, not a number. "
            "Remove that sample or run the scene again."
        )
    back = np.flatnonzero(np.diff(time) < 0)
    if back.size:
        row = int(back[0]) + 1
        raise OutsideError(
            f"{label}: time goes back from {float(time[row - 1])!r} s to {float(time[row])!r} s at "
            f"sample {row + 1}. If the file holds several runs, split it and give each by itself."
        )


def _columns(path: Path, names: list[str]) -> list[str]:
    """The names without units, time called `time`; refuses what is no header of a result."""
    if all(_number(name) is not None for name in names):
        raise OutsideError(
            f"The first line of {path} holds numbers where the names of the columns belong. "
            "Put a line of names above it: time, then one per variable, e.g. `time,plant.x`."
        )
    plain = [_UNIT_SUFFIX.sub("", name) or f"column {i + 1}" for i, name in enumerate(names)]
    for wanted in _TIME_NAMES:
        hits = [i for i, name in enumerate(plain) if name.lower() == wanted]
        if hits:
            plain[hits[0]] = "time"
            break
    else:
        raise OutsideError(
            f"{path} has no column `time`. {_listed(plain)} Rename the one that holds the time in "
            "seconds to `time`."
        )
    twice = sorted({name for name in plain if plain.count(name) > 1})
    if twice:
        raise OutsideError(
            f"{path} names the column `{twice[0]}` {plain.count(twice[0])} times. "
            "Give each column a name of its own."
        )
    return plain


def _table(
    path: Path, lines: list[str], width: int, delimiter: str
) -> tuple[NDArray[np.float64], list[str]]:
    """All samples, one row each."""
    body = lines[1:]
    decimal_comma = delimiter != "," and any("," in line for line in body)
    if not decimal_comma:
        try:
            table = np.loadtxt(body, delimiter=delimiter, ndmin=2, comments=None)
            if table.shape[1] == width:
                return table, []
        except ValueError:
            pass  # something in it is no number: look closer, and slower
    rows: list[list[float]] = []
    for at, cells in enumerate(csv.reader(body, delimiter=delimiter), start=2):
        if not cells:
            continue
        if len(cells) != width:
            if at == len(lines) and len(cells) < width and rows:
                return np.array(rows), [
                    f"The last line has {len(cells)} of {width} values, so the file was cut off "
                    f"while it was written: the {len(rows)} whole samples before it are shown."
                ]
            raise OutsideError(
                f"Line {at} of {path} has {len(cells)} values, the first line names {width} "
                "columns: not a result in CSV, or a damaged one. Run the scene again."
            )
        if decimal_comma:
            cells = [cell.replace(",", ".") for cell in cells]
        rows.append([_value(cell) for cell in cells])
    return np.array(rows).reshape(len(rows), width), []


def _assemble(
    path: Path, columns: list[str], table: NDArray[np.float64], notes: list[str]
) -> Reading:
    first = columns.index("time")
    order = [first, *(i for i in range(len(columns)) if i != first)]
    kept = [i for i in order if i == first or not np.all(np.isnan(table[:, i]))]
    dropped = [columns[i] for i in order if i not in kept]
    if dropped:
        notes.append(f"Without a single number, so left out: {_names(dropped)}.")
    data = np.empty(len(table), dtype=[(columns[i], np.float64) for i in kept])
    for i in kept:
        data[columns[i]] = table[:, i]
    check_result(str(path), data)
    return Reading(data, tuple(notes))


def _number(cell: str) -> float | None:
    try:
        return float(cell)
    except ValueError:
        return None


def _value(cell: str) -> float:
    number = _number(cell)
    return _WORDS.get(cell.strip().lower(), float("nan")) if number is None else number


def _names(names: list[str]) -> str:
    more = len(names) - _MOST_LISTED
    return ", ".join(names[:_MOST_LISTED]) + (f" and {more} more" if more > 0 else "")


def _listed(names: list[str]) -> str:
    return f"Its columns: {_names(names)}." if names else "It names no columns."

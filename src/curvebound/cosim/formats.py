"""Results in the formats that other tools read, chosen by how a file's name ends."""

from __future__ import annotations

import json
from collections.abc import Callable, Mapping
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ..errors import CurveboundError
from ..files import write_whole
from .tables import write_csv

__all__ = ["write_npz", "write_table"]

_Write = Callable[[NDArray[Any], Path, Mapping[str, str]], object]


def write_table(
    data: NDArray[Any], path: Path, units: Mapping[str, str], *, with_units: bool = False
) -> Path:
    """Write a structured array of columns `time` (s) and others; returns `path`.

    .csv: see write_csv; with_units puts units behind the names.
    .json: {"units": {name: unit}, "columns": {name: [values]}}, every digit kept.
    .parquet: a column each, its unit as metadata of its field; needs pyarrow.
    .npz: an array each by its name, and one `units` of pairs (name, unit).

    The file appears whole or not at all. Raises CurveboundError for any other ending.
    """
    known = {"time": "s", **units}
    ending = path.suffix.lower()
    if ending == ".csv":
        return write_csv(data, path, known if with_units else None)
    if ending not in _WRITERS:
        raise CurveboundError(
            f"{path}: the name's ending is the format: .csv, {', '.join(_WRITERS)}."
        )
    return write_whole(path, lambda to: _WRITERS[ending](data, to, known))


def _columns(data: NDArray[Any]) -> dict[str, NDArray[Any]]:
    return {name: np.ascontiguousarray(data[name]) for name in data.dtype.names or ()}


def _json(data: NDArray[Any], path: Path, units: Mapping[str, str]) -> None:
    columns = {name: column.tolist() for name, column in _columns(data).items()}
    text = json.dumps({"units": dict(units), "columns": columns})
    path.write_text(text + "\n", encoding="utf-8")


def _parquet(data: NDArray[Any], path: Path, units: Mapping[str, str]) -> None:
    try:
        import pyarrow
        import pyarrow.parquet
    except ImportError as error:
        raise CurveboundError(
            "Parquet needs pyarrow, not installed here: pip install 'curvebound[sweep]'."
        ) from error
    columns = _columns(data)
    fields = [
        pyarrow.field(
            name, pyarrow.from_numpy_dtype(column.dtype), metadata={"unit": units.get(name, "")}
        )
        for name, column in columns.items()
    ]
    table = pyarrow.table(list(columns.values()), schema=pyarrow.schema(fields))
    pyarrow.parquet.write_table(table, path)


def write_npz(path: Path, arrays: Mapping[str, NDArray[Any]]) -> None:
    """Write arrays as .npz to just this path: np.savez would add an ending to some names."""
    with path.open("wb") as file:
        np.savez(file, **arrays)  # type: ignore[arg-type]


def _npz(data: NDArray[Any], path: Path, units: Mapping[str, str]) -> None:
    write_npz(path, {**_columns(data), "units": np.array([*units.items()], dtype=str)})


_WRITERS: dict[str, _Write] = {".json": _json, ".parquet": _parquet, ".npz": _npz}

"""What a study leaves on disk as data."""

from __future__ import annotations

import csv
import json
import math
from collections.abc import Sequence
from pathlib import Path
from typing import Any

from ..cells import cell, defused
from ..files import write_whole

__all__ = ["read_json", "write_json", "write_rows"]

Row = dict[str, Any]


def write_rows(rows: Sequence[Row], out: Path) -> Path:
    """Rows as CSV: the union of their keys, in order of appearance; floats by repr."""
    names = list(dict.fromkeys(name for row in rows for name in row))

    def write(path: Path) -> None:
        with path.open("w", newline="", encoding="utf-8") as file:
            table = csv.writer(file, lineterminator="\n")
            table.writerow(map(defused, names))
            for row in rows:
                table.writerow([cell(row.get(name)) for name in names])

    return write_whole(out, write)


def write_json(data: Any, out: Path) -> Path:
    """Plain data as JSON; infinity and NaN, which JSON lacks, become null."""
    text = json.dumps(_finite(data), indent=1, allow_nan=False) + "\n"
    return write_whole(out, lambda path: path.write_text(text, encoding="utf-8"))


def read_json(path: Path) -> Any:
    """Data that write_json wrote."""
    return json.loads(path.read_text(encoding="utf-8"))


def _finite(data: Any) -> Any:
    if isinstance(data, dict):
        return {key: _finite(value) for key, value in data.items()}
    if isinstance(data, list | tuple):
        return [_finite(value) for value in data]
    if isinstance(data, float) and not math.isfinite(data):
        return None
    return data

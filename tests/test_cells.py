"""Text in CSV files: no spreadsheet runs it, and reading gives back what was written."""

from __future__ import annotations

import csv
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from curvebound.cells import cell, defused, undefused
from curvebound.cosim import read_csv, write_csv
from curvebound.fmi.documentation import csv_text
from curvebound.study.data_files import write_rows
from curvebound.study.sweep.store import Store, read_sweep
from curvebound.view import read_result

FORMULAS = (
    "=cmd|' /C calc'!A0", "+1+cmd", "-2+3+cmd", "@SUM(1+1)", "\t=1", "\r=1", " =1", "x;=1", "x\n=1",
    "\uff1d1+1", "'=1", "-final(bead.y)", "-", "=",
)  # fmt: skip


def runs(text: str) -> bool:
    """Whether a spreadsheet that opens a file with this cell would run it."""
    for separator in (None, ";", "\t"):
        for part in [text] if separator is None else text.split(separator):
            for line in part.splitlines():
                if line.strip(" ")[:1] in {*"=+-@\uff1d\uff0b\uff0d\uff20"}:
                    return True
    return False


@pytest.mark.parametrize("text", FORMULAS)
def test_no_formula_is_left(text: str) -> None:
    assert not runs(defused(text))
    assert undefused(defused(text)) == text


@given(st.text(alphabet="=+-@'; \t\r\nab1\uff1d"))
def test_reading_gives_back_what_was_written(text: str) -> None:
    assert undefused(defused(text)) == text


@pytest.mark.parametrize("number", ["-1", "+3.5", "-1e-9", "-inf", "1"])
def test_numbers_stay(number: str) -> None:
    assert defused(number) == number
    assert cell(-0.5) == "-0.5"
    assert cell(None) == ""


def texts(path: Path) -> list[str]:
    with path.open(newline="") as file:
        return [text for row in csv.reader(file) for text in row]


def safe(path: Path) -> bool:
    return not any(runs(text) for text in texts(path) if text and not _is_number(text))


def _is_number(text: str) -> bool:
    try:
        float(text)
    except ValueError:
        return False
    return True


NAMES = [text for text in FORMULAS if "\n" not in text and text.strip() == text]


def test_results(tmp_path: Path) -> None:
    data = np.zeros(2, dtype=[("time", float), *((name, float) for name in NAMES)])
    data["time"] = [0.0, 1.0]
    out = write_csv(data, tmp_path / "r.csv")
    assert safe(out)
    assert list(read_csv(out).dtype.names or ()) == ["time", *NAMES]
    assert list(read_result(out).data.dtype.names or ()) == ["time", *NAMES]


def test_tables_of_studies_and_maps(tmp_path: Path) -> None:
    out = write_rows([dict.fromkeys(FORMULAS, text) for text in FORMULAS], tmp_path / "s.csv")
    assert safe(out)


def test_sweeps(tmp_path: Path) -> None:
    out = tmp_path / "a.csv"
    metric = "-final(bead.y)"
    store = Store(out, "x", ["=path"], [metric])
    store.look()
    store.open()
    store.add([(0, [-1.5], "=HYPERLINK(1)"), (1, [None], "-2+3")], [{"=path": "=a"}, {"=path": 1}])
    store.finish(2)
    assert safe(out)
    header, rows = read_sweep(out)
    assert header == ["point", "=path", metric, "message"]
    assert rows[0][1:] == ["=a", -1.5, "=HYPERLINK(1)"]
    again = Store(out, "x", ["=path"], [metric])
    assert again.look() == {0, 1}
    again.open()
    again.finish(2)
    assert read_sweep(out)[1][0][1:] == rows[0][1:]


def test_reference_results() -> None:
    assert csv_text({"=x": [1.0]}).splitlines()[0] == '"\'=x"'

"""The name's ending decides the format of a result; every digit and every unit comes back."""

from __future__ import annotations

import json
from pathlib import Path

import numpy as np
import pytest

from curvebound.cli import main
from curvebound.cosim import read_csv
from curvebound.cosim.formats import write_table
from curvebound.errors import CurveboundError

UNITS = {"a.x": "m", "a.n": "1"}


@pytest.fixture
def data() -> np.ndarray:
    rng = np.random.default_rng(3)
    table = np.zeros(20, dtype=[("time", float), ("a.x", float), ("a.n", np.int32), ("a.b", bool)])
    table["time"] = np.arange(20) / 3.0
    table["a.x"] = rng.normal(size=20) * 10.0 ** rng.integers(-300, 300, 20)
    table["a.n"] = rng.integers(-5, 5, 20)
    table["a.b"] = rng.integers(0, 2, 20)
    return table


def same(table: np.ndarray, columns) -> bool:
    return all(np.array_equal(table[name], columns[name]) for name in table.dtype.names)


def test_json(data: np.ndarray, tmp_path: Path) -> None:
    read = json.loads(write_table(data, tmp_path / "r.json", UNITS).read_text())
    assert read["units"] == {"time": "s", **UNITS}
    assert same(data, read["columns"])


def test_npz(data: np.ndarray, tmp_path: Path) -> None:
    with np.load(write_table(data, tmp_path / "r.npz", UNITS)) as read:
        assert same(data, read)
        assert dict(map(tuple, read["units"])) == {"time": "s", **UNITS}


def test_parquet(data: np.ndarray, tmp_path: Path) -> None:
    parquet = pytest.importorskip("pyarrow.parquet")
    read = parquet.read_table(write_table(data, tmp_path / "r.parquet", UNITS))
    assert same(data, {name: read[name].to_numpy() for name in read.column_names})
    assert read.schema.field("a.x").metadata == {b"unit": b"m"}
    assert read.schema.field("time").metadata == {b"unit": b"s"}


def test_csv_with_units_reads_as_one_without(data: np.ndarray, tmp_path: Path) -> None:
    path = write_table(data, tmp_path / "r.csv", UNITS, with_units=True)
    assert path.read_text().splitlines()[0] == "time [s],a.x [m],a.n [1],a.b"
    read = read_csv(path)
    assert read.dtype.names == data.dtype.names
    assert same(data, read)
    write_table(data, path, UNITS)
    assert path.read_text().splitlines()[0] == "time,a.x,a.n,a.b"


def test_other_endings_are_refused_before_anything_runs(
    data: np.ndarray, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    with pytest.raises(CurveboundError, match=r"format: \.csv, \.json, \.parquet, \.npz"):
        write_table(data, tmp_path / "r.xlsx", UNITS)
    with pytest.raises(SystemExit) as stop:
        main(["run", "bead_on_wire", "--out", str(tmp_path / "r.xlsx")])
    assert stop.value.code == 2
    assert "does not end in .csv or .json or .parquet or .npz" in capsys.readouterr().err
    assert list(tmp_path.iterdir()) == []

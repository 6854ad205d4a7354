"""The one file format: exact, whole, and refused when it is something else."""

from __future__ import annotations

import numpy as np
import pytest

from curvebound.cosim import read_csv, write_csv
from curvebound.cosim.results import Result
from curvebound.errors import CurveboundError


def test_floats_come_back_bit_for_bit(tmp_path):
    rng = np.random.default_rng(7)
    data = np.zeros(50, dtype=[("time", float), ("a.x", float), ("a.n", np.int32), ("a.b", bool)])
    data["time"] = np.arange(50) / 3.0
    data["a.x"] = rng.normal(size=50) * 10.0 ** rng.integers(-300, 300, 50)
    data["a.n"] = rng.integers(-5, 5, 50)
    data["a.b"] = rng.integers(0, 2, 50)
    path = write_csv(data, tmp_path / "deep" / "out.csv")
    assert path.read_text().splitlines()[0] == "time,a.x,a.n,a.b"
    back = read_csv(path)
    for name in data.dtype.names:
        assert np.array_equal(back[name], data[name])
    assert back["a.n"].dtype == np.int64
    assert [p.name for p in path.parent.iterdir()] == ["out.csv"]


def test_nan_is_kept(tmp_path):
    data = np.array([(0.0, np.nan)], dtype=[("time", float), ("x[1,2]", float)])
    back = read_csv(write_csv(data, tmp_path / "nan.csv"))
    assert np.isnan(back["x[1,2]"][0])


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("", "is empty"),
        ("time,a\n0.0\n", "line 2 has 1 entries"),
        ("time,time\n0,1\n", "twice"),
        ("time,a\n0.0,abc\n", "column a"),
    ],
)
def test_bad_files_are_named(tmp_path, text, message):
    path = tmp_path / "bad.csv"
    path.write_text(text)
    with pytest.raises(CurveboundError, match=message):
        read_csv(path)
    with pytest.raises(CurveboundError, match="cannot be read"):
        read_csv(tmp_path / "absent.csv")


def test_a_failed_write_leaves_the_old_file(tmp_path, monkeypatch):
    path = tmp_path / "out.csv"
    path.write_text("old")
    monkeypatch.setattr("os.replace", lambda *_: 1 / 0)
    with pytest.raises(ZeroDivisionError):
        write_csv(np.zeros(1, dtype=[("time", float)]), path)
    assert path.read_text() == "old"
    assert len(list(tmp_path.iterdir())) == 1


def test_a_place_that_cannot_be_written_is_named(tmp_path):
    (tmp_path / "file").write_text("")
    path = tmp_path / "file" / "out.csv"
    with pytest.raises(CurveboundError, match=r"out\.csv cannot be written: .*another place"):
        write_csv(np.zeros(1, dtype=[("time", float)]), path)


def test_a_result_says_what_it_is_and_has():
    data = np.zeros(3, dtype=[("time", float), ("plant.x", float), ("plant.angle", float)])
    result = Result("fall", data)
    assert repr(result) == "<Result of fall: 3 points, 0 to 0 s, plant.x, plant.angle>"
    with pytest.raises(CurveboundError, match=r"no plant\.angel.*did you mean plant\.angle"):
        result["plant.angel"]

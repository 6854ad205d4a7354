"""Result files of ours, of other tools, and damaged ones."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from motions import bead

from curvebound.cosim import write_csv
from curvebound.errors import CurveboundError
from curvebound.view import read_result


def write(folder: Path, text: str | bytes) -> Path:
    path = folder / "result.csv"
    path.write_bytes(text if isinstance(text, bytes) else text.encode())
    return path


def test_our_files_come_back_bit_for_bit(tmp_path: Path) -> None:
    data = bead(0.5, 0.01)
    reading = read_result(write_csv(data, tmp_path / "result.csv"))
    assert reading.notes == ()
    assert reading.data.dtype.names == data.dtype.names
    for name in data.dtype.names:
        assert np.array_equal(reading.data[name], data[name])


@pytest.mark.parametrize(
    "text",
    [
        '"time","bead.x"\n0,1\n0.5,2\n',
        "time;bead.x\n0;1\n0,5;2\n",
        "t [s]\tbead.x [m]\n0\t1\n0.5\t2\n",
        "\ufeffTime,bead.x\r\n0,1\r\n0.5,2\r\n\r\n",
        "bead.x,time\n1,0\n2,0.5\n",
    ],
    ids=["quoted", "decimal comma", "tabulators and units", "byte order mark", "time last"],
)
def test_dialects_of_other_tools(tmp_path: Path, text: str) -> None:
    data = read_result(write(tmp_path, text)).data
    assert data["time"].tolist() == [0.0, 0.5]
    assert data["bead.x"].tolist() == [1.0, 2.0]


def test_what_is_no_number_is_nan_and_what_has_none_is_left_out(tmp_path: Path) -> None:
    reading = read_result(write(tmp_path, "time,a,b,mode\n0,1,true,up\n1,,false,up\n2,x,1,up\n"))
    assert reading.data.dtype.names == ("time", "a", "b")
    assert np.isnan(reading.data["a"]).tolist() == [False, True, True]
    assert reading.data["b"].tolist() == [1.0, 0.0, 1.0]
    assert "mode" in reading.notes[0]


def test_a_file_cut_off_in_its_last_line_is_read_up_to_there(tmp_path: Path) -> None:
    reading = read_result(write(tmp_path, "time,a,b\n0,1,2\n1,1,2\n2,1"))
    assert reading.data["time"].tolist() == [0.0, 1.0]
    assert "cut off" in reading.notes[0]


@pytest.mark.parametrize(
    ("text", "said"),
    [
        ("", "is empty"),
        ("\n\n", "is empty"),
        ("time,bead.x\n", "no sample"),
        ("0,1\n1,2\n", "names of the columns"),
        ("x,y\n1,2\n", "no column `time`. Its columns: x, y."),
        ("time,a,a\n0,1,2\n", "2 times"),
        ("time,a\n0,1\n1,2,3\n2,3\n", "Line 3"),
        ("time,a\n0,1\n2,1\n1,1\n", "time goes back from 2.0 s to 1.0 s at sample 3"),
        ("time,a\n0,1\nnan,1\n", "sample 2 is nan"),
        (b"\xff\xfe\x00\x01PK", "is not text"),
    ],
)
def test_broken_files_are_refused_in_words(tmp_path: Path, text: str | bytes, said: str) -> None:
    path = write(tmp_path, text)
    with pytest.raises(CurveboundError) as caught:
        read_result(path)
    assert said in str(caught.value)
    assert "result.csv" in str(caught.value)
    assert "\n" not in str(caught.value)


def test_a_missing_file_and_a_folder(tmp_path: Path) -> None:
    with pytest.raises(CurveboundError, match=r"There is no file .*curvebound run"):
        read_result(tmp_path / "none.csv")
    with pytest.raises(CurveboundError, match="cannot be read"):
        read_result(tmp_path)

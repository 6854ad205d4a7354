"""Files: whole or not at all, by one process at a time, and as they should be at the end."""

from __future__ import annotations

import subprocess
import sys
import threading
import time
from pathlib import Path

import pytest

from curvebound import files
from curvebound.errors import CurveboundError
from curvebound.files import append, remove, sole_writer, write_whole

_HOLD = """
import sys, time
from pathlib import Path
from curvebound.files import sole_writer
with sole_writer(Path(sys.argv[1])):
    print("held", flush=True)
    sys.stdin.read()
"""


def holder(out: Path) -> subprocess.Popen[str]:
    """Another process that writes `out` until its standard input is closed."""
    process = subprocess.Popen(
        [sys.executable, "-c", _HOLD, str(out)],
        stdin=subprocess.PIPE,
        stdout=subprocess.PIPE,
        text=True,
    )
    assert process.stdout is not None
    assert process.stdout.readline() == "held\n"
    return process


def end(process: subprocess.Popen[str]) -> None:
    assert process.stdin is not None
    process.stdin.close()
    process.wait(20.0)


def test_a_second_writer_is_refused_and_told_by_whom(tmp_path: Path) -> None:
    out = tmp_path / "new" / "a.csv"
    other = holder(out)
    try:
        with (
            pytest.raises(CurveboundError, match=f"a.csv is being written by process {other.pid}"),
            sole_writer(out),
        ):
            pass
        with sole_writer(out.with_name("b.csv")):
            pass
    finally:
        end(other)
    with sole_writer(out):
        pass
    assert list(out.parent.iterdir()) == []


def test_a_second_writer_waits_where_it_may(tmp_path: Path) -> None:
    out = tmp_path / "a.csv"
    other = holder(out)
    threading.Timer(0.5, end, [other]).start()
    began = time.monotonic()
    with sole_writer(out, wait=True):
        assert time.monotonic() - began > 0.3


def test_a_process_that_was_killed_leaves_no_lock(tmp_path: Path) -> None:
    out = tmp_path / "a.csv"
    other = holder(out)
    other.kill()
    other.wait(20.0)
    with sole_writer(out):
        pass


@pytest.mark.parametrize("how", ["removed", "replaced", "appended"])
def test_what_others_did_to_a_file_is_seen_at_the_end(tmp_path: Path, how: str) -> None:
    out = tmp_path / "a.csv"

    def work() -> None:
        with sole_writer(out):
            write_whole(out, lambda path: path.write_text("mine"))
            if how == "removed":
                out.unlink()
            elif how == "replaced":
                (tmp_path / "b").write_text("mine")
                (tmp_path / "b").replace(out)
            else:
                out.write_text("mine and theirs")

    with pytest.raises(CurveboundError, match="was changed by something else"):
        work()


def test_files_in_a_folder_are_seen_too(tmp_path: Path) -> None:
    folder = tmp_path / "study"

    def work(*, lose: bool) -> None:
        with sole_writer(folder, folder=True):
            for name in ("a", "b"):
                write_whole(folder / name, lambda path: path.write_text("x"))
            remove(folder / "b")
            if lose:
                (folder / "a").unlink()

    work(lose=False)
    with pytest.raises(CurveboundError, match="was changed by something else"):
        work(lose=True)


def test_appending_sees_that_others_have_written(tmp_path: Path) -> None:
    out = tmp_path / "a.csv"
    write_whole(out, lambda path: path.write_text("head\n"))
    append(out, "1\n")
    append(out, "2\n")
    assert out.read_text() == "head\n1\n2\n"
    with out.open("a") as file:
        file.write("theirs\n")
    with pytest.raises(CurveboundError, match="was changed by something else"):
        append(out, "3\n")


def test_an_append_that_fails_leaves_no_half_row(tmp_path: Path) -> None:
    """A disk that fills up within a row: here, a file that may not grow beyond 1000 bytes."""
    script = (
        "import resource, signal, sys\n"
        "from pathlib import Path\n"
        "from curvebound.errors import CurveboundError\n"
        "from curvebound.files import append\n"
        "out = Path(sys.argv[1])\n"
        "append(out, 990 * 'a' + '\\n')\n"
        "signal.signal(signal.SIGXFSZ, signal.SIG_IGN)\n"
        "resource.setrlimit(resource.RLIMIT_FSIZE, (1000, 1000))\n"
        "try:\n"
        "    append(out, 20 * 'b' + '\\n')\n"
        "except CurveboundError as error:\n"
        "    print(error)\n"
    )
    out = tmp_path / "a.csv"
    done = subprocess.run(
        [sys.executable, "-B", "-c", script, str(out)], capture_output=True, text=True, check=True
    )
    assert (
        "a.csv cannot be written: File too large. Files may not be that large here" in done.stdout
    )
    assert out.read_text() == 990 * "a" + "\n"


def test_a_link_stays_a_link_and_a_device_is_refused(tmp_path: Path) -> None:
    (tmp_path / "real.csv").write_text("old")
    link = tmp_path / "link.csv"
    link.symlink_to("real.csv")
    write_whole(link, lambda path: path.write_text("new"))
    assert link.is_symlink()
    assert (tmp_path / "real.csv").read_text() == "new"
    for device in ("/dev/null", "/dev/full"):
        with pytest.raises(CurveboundError, match="it is no regular file"):
            write_whole(Path(device), lambda path: path.write_text("new"))
        with pytest.raises(CurveboundError, match="it is no regular file"):
            files.require_writable(Path(device))

"""An FMU that brings its Python: it runs where there is none."""

from __future__ import annotations

import re
import subprocess
import sys
import zipfile

import pytest
from source_copies import with_short_reference

from curvebound.errors import CurveboundError
from curvebound.fmi import bundled, documentation
from curvebound.fmi.build import build

from .conftest import unpacked
from .test_c_host import in_fmpy, rows, whole_run


@pytest.fixture(scope="module")
def with_python(tmp_path_factory):
    reason = bundled.why_not()
    if reason:
        pytest.skip(reason)
    folder = tmp_path_factory.mktemp("with_python")
    short = with_short_reference(documentation.reference_result)
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(documentation, "reference_result", short)
        path = build("BeadOnWire", folder, with_python=True).path
    assert path.stat().st_size < 6e6
    with zipfile.ZipFile(path) as archive:
        assert (
            b"PYTHON SOFTWARE FOUNDATION"
            in archive.read("documentation/licenses/python.txt").upper()
        )
    return unpacked(path, folder / "unpacked")


@pytest.fixture
def nowhere(tmp_path):
    """An environment in which no Python of the system is found."""
    for minor in range(10, 15):  # found before the system's, and not loadable
        (tmp_path / f"libpython3.{minor}.so.1.0").touch()
    return {"PATH": "/nowhere", "LD_LIBRARY_PATH": str(tmp_path)}


def test_without_any_python(host, with_python, nowhere):
    vrs = with_python.outputs()
    result = host(whole_run(with_python, vrs), {**nowhere, "LD_DEBUG": "files"})
    assert rows(result) == in_fmpy(with_python, vrs)
    loaded = re.findall(r"calling init: (\S*python\S*)", result.error)
    own = str(with_python.folder)
    assert loaded
    assert all(path.startswith(own) for path in loaded)


def test_states_and_failures_without_any_python(host, with_python, nowhere):
    ready = ["setup 0 - 0 -", "enter 0", "exit 0", "step 0 0 0.1"]
    again = ["save 0 0", "write 0 0 0", "read 0 0 1", "restore 0 1", "step 0 0.1 0.1"]
    result = host([*with_python.start(), *ready, *again, "step 0 0.2 -1"], nowhere)
    assert [a[0] for a in result.answers] == ["OK"] * 11 + ["Error"]
    assert "communicationStepSize = -1.0 s" in result.messages[0][3]


def test_a_python_that_is_there_already_is_used(with_python):
    script = (
        "import sys; from fmpy.fmi2 import FMU2Slave; folder, guid, name = sys.argv[1:]\n"
        "where = {'unzipDirectory': folder, 'modelIdentifier': name, 'instanceName': 'i'}\n"
        "fmu = FMU2Slave(guid=guid, **where)\n"
        "fmu.instantiate()\n"
        "maps = open('/proc/self/maps').read()\n"
        "assert folder in maps and 'resources/python' not in maps\n"
    )
    arguments = [str(with_python.folder), with_python.guid, with_python.identifier]
    done = subprocess.run(
        [sys.executable, "-c", script, *arguments], capture_output=True, text=True
    )
    assert done.returncode == 0, done.stderr


def test_a_python_that_cannot_be_brought_along(monkeypatch, tmp_path):
    monkeypatch.setattr(sys, "platform", "win32")
    with pytest.raises(CurveboundError, match="on Linux only"):
        bundled.bundled_python({}, "main", "Name")

"""One FMU file under each CPython from 3.10 on, in fmpy and in a C host: the bits of interpreted.

What it costs under each is measured by `python tests/benchmarks pythons`.
"""

from __future__ import annotations

import pytest
from pythons import VERSIONS, folder, in_fmpy, program

from curvebound.fmi.compile import why_not

from .test_c_host import loaded_python, rows, whole_run

pytestmark = [
    pytest.mark.slow,  # .ci/run waits for its installations before the slow tests
    pytest.mark.skipif(bool(why_not()), reason=f"not compiled: {why_not()}"),
]

SIZE, COUNT = 0.05, 20  # as whole_run


@pytest.fixture(scope="module")
def as_interpreted(interpreted_fmus, unpack, tmp_path_factory):
    """The FMUs without compiled code, unpacked."""
    return {
        path.stem: unpack(path, tmp_path_factory.mktemp(path.stem))
        for path in interpreted_fmus.glob("*.fmu")
    }


@pytest.mark.parametrize("version", VERSIONS)
@pytest.mark.parametrize("name", ["BeadOnWire", "ParabolaPendulum", "ParabolaDrive"])
def test_the_same_file_gives_the_same_bits(host, fmus, as_interpreted, name, version):
    python = program(version) or pytest.skip(f"no Python {version} with fmpy: run .ci/importers")
    fmu = fmus[name]
    slow, fast = (
        in_fmpy(python, one.folder, one.identifier, one.guid, SIZE, COUNT, *one.outputs())
        for one in (as_interpreted[name], fmu)
    )
    assert "runs interpreted" in " ".join(slow.messages)
    assert fast.messages == []
    assert len(slow.rows) == COUNT + 1
    assert fast.rows == slow.rows
    environment = {"PATH": folder(python), "LD_DEBUG": "files"}
    result = host(whole_run(fmu, fmu.outputs(), COUNT), environment)
    assert f"libpython{version}." in (loaded_python(result) or ""), result.messages
    assert result.messages == []  # nor that it runs interpreted
    assert rows(result) == slow.rows

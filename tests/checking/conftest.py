"""FMUs that are not ours: a small one in C, sound or with one fault."""

from __future__ import annotations

import shutil
import subprocess
import sys
import zipfile
from collections.abc import Callable
from pathlib import Path

import pytest

from curvebound.compiling.toolchain import compiler

HERE = Path(__file__).parent

DESCRIPTION = """<?xml version="1.0" encoding="UTF-8"?>
<fmiModelDescription fmiVersion="2.0" modelName="Oscillator" guid="{oscillator}">
  <CoSimulation modelIdentifier="Oscillator" canHandleVariableCommunicationStepSize="true"
    canGetAndSetFMUstate="true" canSerializeFMUstate="true"/>
  <DefaultExperiment startTime="0" stopTime="2" stepSize="0.1"/>
  <ModelVariables>
    <ScalarVariable name="x" valueReference="0" causality="output"><Real/></ScalarVariable>
    <ScalarVariable name="v" valueReference="1" causality="output"><Real/></ScalarVariable>
    <ScalarVariable name="k" valueReference="2" causality="parameter" variability="fixed">
      <Real start="1"/></ScalarVariable>
    <ScalarVariable name="x_start" valueReference="3" causality="parameter" variability="fixed">
      <Real start="1"/></ScalarVariable>
    <ScalarVariable name="u" valueReference="4" causality="input"><Real start="0"/></ScalarVariable>
  </ModelVariables>
  <ModelStructure>
    <Outputs><Unknown index="1" dependencies=""/><Unknown index="2" dependencies=""/></Outputs>
    <InitialUnknowns><Unknown index="1"/><Unknown index="2"/></InitialUnknowns>
  </ModelStructure>
</fmiModelDescription>
"""


def reference() -> str:
    """What the sound one gives, in the manner of the FMI Cross-Check."""
    x, v, rows = 1.0, 0.0, ["time,x,v", "0.0,1.0,0.0"]
    for k in range(1, 2001):
        x, v = x + 1e-3 * v, v - 1e-3 * x
        if k % 100 == 0:
            rows.append(f"{k / 1000},{x!r},{v!r}")
    return "\n".join(rows) + "\n"


@pytest.fixture(scope="session")
def foreign(tmp_path_factory: pytest.TempPathFactory) -> Callable[[str], Path]:
    """A function that makes the C FMU with the fault of that name; `NONE` is the sound one."""
    command = compiler()
    if command is None or sys.platform != "linux":
        pytest.skip("no C compiler on Linux here")
    made: dict[str, Path] = {}

    def make(fault: str) -> Path:
        if fault not in made:
            folder = tmp_path_factory.mktemp(fault)
            binary = folder / "Oscillator.so"
            subprocess.run(
                [*command, "-shared", "-fPIC", "-O1", f"-DFAULT={fault}",
                 str(HERE / "oscillator.c"), "-o", str(binary)],
                check=True,
            )  # fmt: skip
            path = folder / "Oscillator.fmu"
            with zipfile.ZipFile(path, "w") as archive:
                archive.writestr("modelDescription.xml", DESCRIPTION)
                archive.write(binary, "binaries/linux64/Oscillator.so")
            (folder / "Oscillator_ref.csv").write_text(reference())
            made[fault] = path
        return made[fault]

    return make


@pytest.fixture
def changed(tmp_path: Path) -> Callable[..., Path]:
    """A function that copies an FMU with one text replaced in the files of that ending."""

    def make(sound: Path, ending: str, old: str, new: str) -> Path:
        path = tmp_path / sound.name
        count = 0
        with zipfile.ZipFile(sound) as archive, zipfile.ZipFile(path, "w") as copy:
            for item in archive.infolist():
                data = archive.read(item)
                if item.filename.endswith(ending):
                    count += data.count(old.encode())
                    data = data.replace(old.encode(), new.encode())
                copy.writestr(item, data)
        assert count > 0, f"{old} is in no {ending}"
        return path

    return make


@pytest.fixture
def truncated(tmp_path: Path) -> Callable[[Path], Path]:
    """A function that copies the first half of a file."""

    def make(sound: Path) -> Path:
        path = tmp_path / sound.name
        shutil.copy(sound, path)
        with path.open("r+b") as file:
            file.truncate(path.stat().st_size // 2)
        return path

    return make

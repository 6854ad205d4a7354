"""The built FMUs in tools that other people use, all giving fmpy's numbers.

.ci/importers installs the tools; without one its test is skipped. The communication step is a power
of two, so that every tool arrives at the same times however it adds up.
"""

from __future__ import annotations

import csv
import os
import shutil
import subprocess
from pathlib import Path

import pytest
from fmpy import extract, read_csv, read_model_description
from fmpy.fmi2 import FMU2Slave

from curvebound.fmi.binaries import compile_binary, why_not
from curvebound.fmi.cross_check import write_cross_check
from curvebound.fmi.folder import names

#: .ci/run waits for its installations before the slow tests
pytestmark = pytest.mark.slow

HERE = Path(__file__).parent
TOOLS = Path(
    os.environ.get("CURVEBOUND_IMPORTERS") or Path.home() / ".cache" / "curvebound-importers"
)
STEP = 1 / 64
COUNT = 64
#: no variable of Python's, no LD_PRELOAD: whatever python3 the system has
PLAIN = {"PATH": "/usr/bin:/bin", "HOME": os.environ.get("HOME", "/")}
NAMES = ["BeadOnWire", "ParabolaPendulum", "ParabolaDrive"]


class Expected:
    """What fmpy gives: the Real outputs before the first step and after each."""

    def __init__(self, path: Path) -> None:
        self.path = path
        description = read_model_description(str(path))
        outputs = [
            v for v in description.modelVariables if v.causality == "output" and v.type == "Real"
        ]
        self.names = [v.name for v in outputs]
        self.references = [v.valueReference for v in outputs]
        folder = extract(str(path))
        slave = FMU2Slave(
            guid=description.guid,
            unzipDirectory=folder,
            modelIdentifier=description.coSimulation.modelIdentifier,
            instanceName="slave",
        )
        slave.instantiate()
        slave.setupExperiment(startTime=0.0)
        slave.enterInitializationMode()
        slave.exitInitializationMode()
        self.rows = [slave.getReal(self.references)]
        for k in range(COUNT):
            slave.doStep(k * STEP, STEP)
            self.rows.append(slave.getReal(self.references))
        slave.terminate()
        slave.freeInstance()
        shutil.rmtree(folder)


@pytest.fixture(scope="session")
def expected(fmus):
    if compile_binary() is None:
        pytest.skip(why_not())
    assert names() == sorted(NAMES)
    return {name: Expected(fmus / f"{name}.fmu") for name in NAMES}


def tool(path):
    if not path.exists():
        pytest.skip(f"{path} is not there: run .ci/importers")
    return str(path)


def run(command, folder, environment=PLAIN):
    done = subprocess.run(
        [str(c) for c in command],
        cwd=folder,
        env=environment,
        capture_output=True,
        text=True,
        timeout=300,
    )
    assert done.returncode == 0, f"{done.stdout[-3000:]}\n{done.stderr[-3000:]}"
    return done.stdout


def numbers(output):
    """The lines of numbers among what a tool says."""
    rows = []
    for line in output.splitlines():
        try:
            rows.append([float(word) for word in line.split()])
        except ValueError:
            continue
    return [row for row in rows if row]


@pytest.mark.parametrize("name", NAMES)
def test_libcosim(expected, name, tmp_path):
    python = tool(TOOLS / "python" / "bin" / "python")
    case = expected[name]
    command = [python, HERE / "run_libcosim.py", case.path, STEP, COUNT, *case.references]
    assert numbers(run(command, tmp_path)) == case.rows[1:]


@pytest.mark.parametrize("name", NAMES)
def test_ecospy(expected, name, tmp_path):
    python = tool(TOOLS / "python" / "bin" / "python")
    case = expected[name]
    command = [python, HERE / "run_ecos.py", case.path, STEP, COUNT, *case.names]
    assert numbers(run(command, tmp_path)) == case.rows[1:]


@pytest.mark.parametrize("name", NAMES)
@pytest.mark.parametrize("host", ["pathsim", "cofmupy"])
def test_python_hosts_that_read_all_outputs_as_reals(expected, host, name, tmp_path):
    python = tool(TOOLS / host / "bin" / "python")
    case = expected[name]
    command = [python, HERE / f"run_{host}.py", case.path, STEP, COUNT, *case.names]
    assert numbers(run(command, tmp_path)) == case.rows[1:]


@pytest.mark.parametrize("name", NAMES)
def test_ecos_command_line(expected, name, tmp_path):
    """A process that is not Python; it prints six decimals."""
    tool(TOOLS / "python" / "bin" / "python")
    found = list((TOOLS / "python").glob("lib/python3*/site-packages/ecospy/binaries/ecos"))
    program = tmp_path / "ecos"  # the wheel does not mark it as executable
    shutil.copy(found[0], program)
    program.chmod(0o755)
    case = expected[name]
    run([program, "simulate", "--path", case.path, "--stepSize", STEP, "--stopTime", 1], tmp_path)
    with open(next(tmp_path.glob("*.csv")), newline="") as stream:
        table = [[word.strip() for word in line] for line in csv.reader(stream)]
    columns = [table[0].index(f"instance::{n}[REAL]") for n in case.names]
    assert len(table) == COUNT + 2
    for line, row in zip(table[1:], case.rows, strict=True):
        assert [line[c].lstrip("-") for c in columns] == [f"{x:.6f}".lstrip("-") for x in row]


@pytest.mark.parametrize("name", NAMES)
def test_fmi4j(expected, name, tmp_path):
    jars = TOOLS / "fmi4j"
    tool(jars)
    java = shutil.which("java") or pytest.skip("no java")
    case = expected[name]
    command = [java, "-cp", f"{jars}/*", HERE / "Simulate.java", case.path, STEP, COUNT]
    assert numbers(run([*command, *case.references], tmp_path)) == case.rows


@pytest.mark.parametrize("name", NAMES)
def test_fmi_sim(expected, name, tmp_path):
    program = tool(TOOLS / "bin" / "fmi-sim")
    case = expected[name]
    result = tmp_path / "result.csv"
    times = ["-s", 0, "-f", 1, "--output-interval", STEP]
    run([program, "--model", case.path, "-o", result, "co-simulation", *times], tmp_path)
    with open(result, newline="") as stream:
        table = list(csv.reader(stream))
    columns = [table[0].index(n) for n in case.names]
    assert [[float(line[c]) for c in columns] for line in table[1:]] == case.rows


@pytest.mark.parametrize("name", NAMES)
def test_libcosim_reproduces_the_reference(name, tmp_path):
    """In the order that the folder states, from the default start values, inside the bounds."""
    python = tool(TOOLS / "python" / "bin" / "python")
    folder = write_cross_check(name, tmp_path)
    reference = read_csv(str(folder / f"{name}_ref.csv"))
    with open(folder / f"{name}_bounds.csv", newline="") as stream:
        bounds = dict(list(csv.reader(stream))[1:])
    names = [n for n in reference.dtype.names if n != "time"]
    command = [python, HERE / "run_reference_libcosim.py", folder / f"{name}.fmu"]
    command += [float(reference["time"][1]), folder / f"{name}_in.csv", *names]
    rows = numbers(run(command, tmp_path))
    assert len(rows) == len(reference) - 1
    for i, column in enumerate(names):
        errors = [abs(row[i] - x) for row, x in zip(rows, reference[column][1:], strict=True)]
        assert max(errors) <= float(bounds[column]), column

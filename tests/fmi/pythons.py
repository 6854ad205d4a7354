"""The CPythons that .ci/importers found here, each with fmpy in an environment of its own."""

from __future__ import annotations

import os
import subprocess
from pathlib import Path
from typing import NamedTuple

VERSIONS = ("3.10", "3.11", "3.12", "3.13")

TOOLS = Path(
    os.environ.get("CURVEBOUND_IMPORTERS") or Path.home() / ".cache" / "curvebound-importers"
)

# Arguments: folder, identifier and GUID of an extracted FMU, step size, number of steps, value
# references to read. Prints the values at the start and after each step, then CPU seconds per step.
IN_FMPY = """
import sys, time
from fmpy.fmi2 import FMU2Slave

folder, identifier, guid, size, count = sys.argv[1:6]
references = [int(text) for text in sys.argv[6:]]
size, count = float(size), int(count)
slave = FMU2Slave(guid=guid, unzipDirectory=folder, modelIdentifier=identifier, instanceName="i")
slave.instantiate()
slave.setupExperiment(startTime=0.0)
slave.enterInitializationMode()
slave.exitInitializationMode()
show = lambda: references and print("=", *map(float.hex, slave.getReal(references)))
show()
began = time.process_time()
for k in range(count):
    slave.doStep(k * size, size)
    show()
print("seconds", (time.process_time() - began) / count)
slave.terminate()
slave.freeInstance()
"""


def program(version: str) -> Path | None:
    """A Python of that version which has fmpy."""
    found = TOOLS / f"python{version}" / "bin" / "python"
    return found if found.exists() else None


def folder(python: Path) -> str:
    """The folder with the program of the installation to which an environment's Python belongs."""
    code = "import os, sys; print(os.path.join(sys.base_prefix, 'bin'))"
    done = subprocess.run([python, "-c", code], capture_output=True, text=True, check=True)
    return done.stdout.strip()


class Found(NamedTuple):
    """What a run in fmpy gave."""

    #: values of the variables read, at the start and after each step
    rows: list[list[float]]
    #: CPU time (s) of a step
    seconds: float
    #: lines of log messages
    messages: list[str]


def in_fmpy(python: Path, *arguments: object) -> Found:
    """Run an FMU in fmpy under that Python, with the arguments of IN_FMPY."""
    done = subprocess.run(
        [python, "-I", "-c", IN_FMPY, *map(str, arguments)],
        capture_output=True,
        text=True,
        timeout=300,
    )
    if done.returncode:
        raise RuntimeError(f"{python}: {done.stderr[-3000:]}")
    found = Found([], 0.0, [])
    for line in done.stdout.splitlines():
        first, _, rest = line.partition(" ")
        if first == "=":
            found.rows.append([float.fromhex(word) for word in rest.split()])
        elif first == "seconds":
            found = found._replace(seconds=float(rest))
        else:
            found.messages.append(line)
    return found

"""Section startup: what it takes until a first result."""

from __future__ import annotations

import os
import subprocess
import sys
import time
from collections.abc import Callable
from pathlib import Path

from ..errors import CurveboundError
from .fmu_section import load_ours, load_theirs
from .results import Section, Settings, Table, Target
from .timing import median

__all__ = ["startup_section"]

_NAME = "ParabolaPendulum"
_ROOT = __name__.partition(".bench.")[0]

_FIRST_RESULT = """
from pathlib import Path
from {root}.bench.ours import Loaded
slave = Loaded({name!r}, Path({folder!r})).slave()
slave.doStep(0.0, 1e-3)
slave.getReal([0])
"""

_INSTANTIATE = """
import time
from pathlib import Path
from {root}.bench.ours import Loaded
loaded = Loaded({name!r}, Path({folder!r}))
from fmpy.fmi2 import FMU2Slave
begin = time.perf_counter()
loaded.slave()
middle = time.perf_counter()
loaded.slave()
print(middle - begin, time.perf_counter() - middle)
"""

_BUILD = """
import sys, time
from pathlib import Path
begin = time.perf_counter()
from {root}.fmi.build import build
build({name!r}, Path({folder!r}))
print(time.perf_counter() - begin)
"""


def _python(code: str, **environment: str) -> tuple[float, list[float]]:
    """Wall-clock time of a fresh interpreter that runs `code` (s), and the figures it printed."""
    began = time.perf_counter()
    done = subprocess.run(
        [sys.executable, "-c", code],
        capture_output=True,
        text=True,
        check=False,
        env={**os.environ, **environment},
    )
    spent = time.perf_counter() - began
    if done.returncode:
        tail = "\n".join(done.stderr.splitlines()[-5:])
        raise CurveboundError(f"a start-up run failed (status {done.returncode}):\n{tail}")
    return spent, [float(word) for word in done.stdout.split()]


def startup_section(settings: Settings, advance: Callable[[], object], folder: Path) -> Section:
    """Measure in fresh processes; scratch files go to `folder`."""
    section = Section("startup", "Start-up: seconds of wall-clock time, each in a fresh process")
    sides = {"our FMU": load_ours(_NAME, folder)}
    try:
        sides["C FMU"] = load_theirs(_NAME, folder)
    except CurveboundError as error:
        section.notes.append(str(error))
    texts = {"root": _ROOT, "name": _NAME}
    cached = _BUILD.format(**texts, folder=str(folder / "again"))
    tasks: dict[str, Callable[[], list[float]]] = {
        "Python itself": lambda: [_python("pass")[0]],
        "import curvebound": lambda: [_python(f"import {_ROOT}")[0]],
        "import curvebound.fmi.build": lambda: [_python(f"import {_ROOT}.fmi.build")[0]],
        "curvebound --help": lambda: [
            _python(f"from {_ROOT}.cli import main; main(['--help'])")[0]
        ],
        "build, cached": lambda: _python(cached)[1],
    }
    for side, loaded in sides.items():
        values = {**texts, "folder": str(loaded.folder)}
        making = _INSTANTIATE.format(**values)
        tasks[f"instantiate, first and second: {side}"] = lambda code=making: _python(code)[1]  # type: ignore[misc]
        result = _FIRST_RESULT.format(**values)
        tasks[f"process start to first result: {side}"] = lambda code=result: [_python(code)[0]]  # type: ignore[misc]
    samples: dict[str, list[list[float]]] = {key: [] for key in tasks}
    for _ in range(settings.rounds):
        for key, task in tasks.items():
            try:
                samples[key].append(task())
            except CurveboundError as error:
                section.notes.append(f"{key}: {error}")
            advance()
    table = Table("", ("what", "s", "again, s"), [])
    if not settings.quick:
        empty = folder / "empty cache"
        code = _BUILD.format(**texts, folder=str(folder / "cold"))
        cold = _python(code, CURVEBOUND_CACHE=str(empty))[1][0]
        table.rows.append(("build, cold (one run)", cold, None))
        advance()
    for key, found in samples.items():
        columns = [median(list(column)) for column in zip(*found, strict=True)]
        table.rows.append((key, columns[0], columns[1] if len(columns) > 1 else None))
        if key == "build, cached":
            section.targets.append(Target("second build, seconds", 1.0, columns[0]))
    section.tables.append(table)
    return section

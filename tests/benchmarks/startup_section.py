"""Section startup: what it takes until a first result."""

from __future__ import annotations

import os
import subprocess
import sys
from collections.abc import Callable
from pathlib import Path

from curvebound.errors import CurveboundError
from curvebound.study.timing import median

from .fmu_section import load_ours, load_theirs
from .results import Section, Settings, Table, Target

__all__ = ["startup_section"]

_NAME = "ParabolaPendulum"
TESTS = Path(__file__).resolve().parents[1]

_FIRST_RESULT = """
from pathlib import Path
from benchmarks.ours import Loaded
slave = Loaded({name!r}, Path({folder!r})).slave()
slave.doStep(0.0, 1e-3)
slave.getReal([0])
"""

_INSTANTIATE = """
import time
from pathlib import Path
from benchmarks.ours import Loaded
loaded = Loaded({name!r}, Path({folder!r}))
from fmpy.fmi2 import FMU2Slave
spent = [time.process_time()]
loaded.slave()
spent.append(time.process_time())
loaded.slave()
spent.append(time.process_time())
print(spent[1] - spent[0], spent[2] - spent[1])
"""

_BUILD = """
import os
from pathlib import Path
begin = sum(os.times()[:4])
from curvebound.fmi.build import build
build({name!r}, Path({folder!r}))
print(sum(os.times()[:4]) - begin)
"""


def _children() -> float:
    """CPU time of the processes that this one has started and waited for (s)."""
    try:
        import resource
    except ImportError:  # Windows
        return sum(os.times()[2:4])
    usage = resource.getrusage(resource.RUSAGE_CHILDREN)
    return usage.ru_utime + usage.ru_stime


def _python(code: str, **environment: str) -> tuple[float, str]:
    """CPU time of a fresh interpreter that runs `code` (s), and what it printed."""
    began = _children()
    done = subprocess.run(
        [sys.executable, "-c", code],
        cwd=TESTS,
        capture_output=True,
        text=True,
        check=False,
        env={**os.environ, **environment},
    )
    spent = _children() - began
    if done.returncode:
        tail = "\n".join(done.stderr.splitlines()[-5:])
        raise CurveboundError(f"a start-up run failed (status {done.returncode}):\n{tail}")
    return spent, done.stdout


def _whole(code: str) -> list[float]:
    """Time of the interpreter's whole life (s)."""
    return [_python(code)[0]]


def _printed(code: str, **environment: str) -> list[float]:
    """The times that `code` itself measured and printed (s)."""
    return [float(word) for word in _python(code, **environment)[1].split()]


def startup_section(settings: Settings, advance: Callable[[], object], folder: Path) -> Section:
    """Measure in fresh processes; scratch files go to `folder`."""
    section = Section("startup", "Start-up: seconds of CPU time, each in a fresh process")
    sides = {"our FMU": load_ours(_NAME, folder)}
    try:
        sides["C FMU"] = load_theirs(_NAME, folder)
    except CurveboundError as error:
        section.notes.append(str(error))
    tasks: dict[str, tuple[Callable[[str], list[float]], str]] = {
        "Python itself": (_whole, "pass"),
        "import curvebound": (_whole, "import curvebound"),
        "import curvebound.fmi.build": (_whole, "import curvebound.fmi.build"),
        "curvebound list": (_whole, "from curvebound.cli import main; main(['list'])"),
        "build, cached": (_printed, _BUILD.format(name=_NAME, folder=str(folder / "again"))),
    }
    for side, loaded in sides.items():
        values = {"name": _NAME, "folder": str(loaded.folder)}
        making, result = _INSTANTIATE.format(**values), _FIRST_RESULT.format(**values)
        tasks[f"instantiate, first and second: {side}"] = (_printed, making)
        tasks[f"process start to first result: {side}"] = (_whole, result)
    samples: dict[str, list[list[float]]] = {key: [] for key in tasks}
    for _ in range(settings.rounds):
        for key, (measure, code) in tasks.items():
            samples[key].append(measure(code))
            advance()
    table = Table("", ("what", "s", "again, s"), [])
    if not settings.quick:
        empty = folder / "empty cache"
        code = _BUILD.format(name=_NAME, folder=str(folder / "cold"))
        cold = _printed(code, CURVEBOUND_CACHE=str(empty))[0]
        table.rows.append(("build, cold (one run)", cold, None))
        advance()
    for key, found in samples.items():
        columns = [median(list(column)) for column in zip(*found, strict=True)]
        table.rows.append((key, columns[0], columns[1] if len(columns) > 1 else None))
        if key == "build, cached":
            section.targets.append(Target("second build, seconds", 1.0, columns[0]))
    section.tables.append(table)
    return section

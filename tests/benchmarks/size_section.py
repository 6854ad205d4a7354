"""Section size: time and memory per instance and per step must not grow with their number."""

from __future__ import annotations

import json
import subprocess
import sys
from collections.abc import Callable
from pathlib import Path

from curvebound.errors import CurveboundError
from curvebound.study.timing import median

from .fmu_section import load_ours, load_theirs
from .ours import Loaded
from .results import Section, Settings, Table, Target

__all__ = ["size_section"]

_NAME = "ParabolaPendulum"
TESTS = Path(__file__).resolve().parents[1]

_Outcome = dict[str, float]
_Task = Callable[[], _Outcome]


def _work(loaded: Loaded, reference: Loaded, **task: int) -> _Outcome:
    """One measurement in a process of its own."""
    folders = {"folder": str(loaded.folder), "reference": str(reference.folder)}
    request = {"name": loaded.name, **folders, **task}
    done = subprocess.run(
        [sys.executable, "-m", "benchmarks.worker", json.dumps(request)],
        cwd=TESTS,
        capture_output=True,
        text=True,
        check=False,
    )
    if done.returncode:
        tail = "\n".join(done.stderr.splitlines()[-5:])
        raise CurveboundError(f"measuring {request} failed (status {done.returncode}):\n{tail}")
    outcome: _Outcome = json.loads(done.stdout)
    return outcome


def _rounds(
    tasks: dict[tuple[str, int], _Task], rounds: int, advance: Callable[[], object]
) -> dict[tuple[str, int], _Outcome]:
    """Medians over rounds in which the tasks take turns."""
    samples: dict[tuple[str, int], list[_Outcome]] = {key: [] for key in tasks}
    for _ in range(rounds):
        for key, task in tasks.items():
            samples[key].append(task())
            advance()
    return {
        key: {name: median([each[name] for each in found]) for name in found[0]}
        for key, found in samples.items()
    }


def _spread(values: list[float]) -> float | None:
    """The largest over the smallest."""
    return max(values) / min(values) if min(values) > 0.0 else None


def size_section(settings: Settings, advance: Callable[[], object], folder: Path) -> Section:
    """Measure in fresh processes; scratch files go to `folder`."""
    section = Section("size", f"Cost against size: {_NAME}, doStep and getReal of 6")
    ours, theirs = load_ours(_NAME, folder), load_theirs(_NAME, folder)
    _over_instances(section, settings, advance, {"ours": ours, "C": theirs}, theirs)
    _over_steps(section, settings, advance, ours, theirs)
    section.notes.append(
        "step / C: beside as many steps of one instance of the C FMU in the same process, "
        "which tells the FMU's own growth from a change of the machine's speed"
    )
    return section


def _over_instances(
    section: Section,
    settings: Settings,
    advance: Callable[[], object],
    sides: dict[str, Loaded],
    reference: Loaded,
) -> None:
    counts = (1, 10) if settings.quick else (1, 10, 100, 1000)
    size = {"steps": settings.choose(20000, 200), "before": settings.choose(100, 5)}
    tasks: dict[tuple[str, int], _Task] = {}
    for count in counts:
        for side, loaded in sides.items():
            tasks[side, count] = lambda loaded=loaded, count=count: _work(  # type: ignore[misc]
                loaded, reference, instances=count, **size
            )
    outcomes = _rounds(tasks, settings.rounds, advance)
    section.tables.append(
        Table(
            "instances in one process",
            ("instances", "FMU", "kB each", "us to instantiate", "us per step", "step / C"),
            [
                (n, side, o["bytes"] / 1024, o["instantiation"] * 1e6, o["step"] * 1e6, o["ratio"])
                for (side, n), o in outcomes.items()
            ],
        )
    )
    section.notes.append(
        "kB each: growth of the process's resident memory beyond its first "
        f"{size['before'] + 1} instances; it comes in pages, so the target takes the two largest"
    )
    section.targets += [
        Target(
            "memory per instance, largest / smallest",
            1.1,
            _spread([outcomes["ours", n]["bytes"] for n in counts[-2:]]),
        ),
        Target(
            "step over instances, largest / smallest",
            1.1,
            _spread([outcomes["ours", n]["ratio"] for n in counts]),
        ),
    ]


def _over_steps(
    section: Section,
    settings: Settings,
    advance: Callable[[], object],
    loaded: Loaded,
    reference: Loaded,
) -> None:
    lengths = (500, 1000) if settings.quick else (1000, 10_000, 100_000, 1_000_000)
    tasks: dict[tuple[str, int], _Task] = {}
    for length in lengths:
        tasks["ours", length] = lambda length=length: _work(  # type: ignore[misc]
            loaded, reference, steps=length
        )
    outcomes = _rounds(tasks, settings.rounds, advance)
    section.tables.append(
        Table(
            "communication steps of one instance",
            ("steps", "us per step", "step / C", "memory grown, kB", "bytes per step"),
            [
                (n, o["step"] * 1e6, o["ratio"], o["grown"] / 1024, o["grown"] / n)
                for (_, n), o in outcomes.items()
            ],
        )
    )
    section.targets += [
        Target(
            "step over steps, largest / smallest",
            1.1,
            _spread([o["ratio"] for o in outcomes.values()]),
        ),
        Target(
            f"bytes grown per step over {lengths[-1]} steps",
            0.1,
            max(0.0, outcomes["ours", lengths[-1]]["grown"]) / lengths[-1],
        ),
    ]

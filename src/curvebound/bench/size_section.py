"""Section size: time and memory per instance and per step, which must not grow with their number."""

from __future__ import annotations

import json
import subprocess
import sys
from collections.abc import Callable
from pathlib import Path

from ..errors import CurveboundError
from .fmu_section import load_ours, load_theirs
from .ours import Loaded
from .results import Section, Settings, Table, Target
from .timing import median

__all__ = ["size_section"]

_NAME = "ParabolaPendulum"


def _work(loaded: Loaded, **task: int) -> dict[str, float]:
    """One measurement in a process of its own."""
    request = {"name": loaded.name, "folder": str(loaded.folder), **task}
    done = subprocess.run(
        [sys.executable, "-m", f"{__package__}.worker", json.dumps(request)],
        capture_output=True,
        text=True,
        check=False,
    )
    if done.returncode:
        tail = "\n".join(done.stderr.splitlines()[-5:])
        raise CurveboundError(f"measuring {request} failed (status {done.returncode}):\n{tail}")
    outcome: dict[str, float] = json.loads(done.stdout)
    return outcome


def _rounds(
    tasks: dict[tuple[str, int], Callable[[], dict[str, float]]],
    rounds: int,
    advance: Callable[[], object],
) -> dict[tuple[str, int], dict[str, float]]:
    """Medians over rounds in which the tasks take turns."""
    samples: dict[tuple[str, int], list[dict[str, float]]] = {key: [] for key in tasks}
    for _ in range(rounds):
        for key, task in tasks.items():
            samples[key].append(task())
            advance()
    return {
        key: {name: median([each[name] for each in found]) for name in found[0]}
        for key, found in samples.items()
    }


def _spread(values: list[float]) -> float:
    """The largest over the smallest."""
    return max(values) / min(values)


def size_section(settings: Settings, advance: Callable[[], object], folder: Path) -> Section:
    """Measure in fresh processes; scratch files go to `folder`."""
    section = Section("size", f"Cost against size: {_NAME}, doStep and getReal of 6")
    sides = {"ours": load_ours(_NAME, folder)}
    try:
        sides["C"] = load_theirs(_NAME, folder)
    except CurveboundError as error:
        section.notes.append(str(error))
    counts = (1, 10) if settings.quick else (1, 10, 100, 1000)
    steps = settings.choose(20000, 200)
    outcomes = _rounds(
        {
            (side, count): lambda loaded=loaded, count=count: _work(  # type: ignore[misc]
                loaded, instances=count, steps=steps
            )
            for count in counts
            for side, loaded in sides.items()
        },
        settings.rounds,
        advance,
    )
    table = Table(
        "instances in one process",
        ("instances", "FMU", "kB per instance", "us to instantiate", "us per step"),
        [
            (n, side, o["bytes"] / 1024, o["instantiation"] * 1e6, o["step"] * 1e6)
            for (side, n), o in outcomes.items()
        ],
    )
    section.tables.append(table)
    section.notes.append(
        "memory is the process's resident memory in pages of 4 kB, so below 100 instances "
        "it says little: the target compares 100 with 1000"
    )
    many = [outcomes["ours", n] for n in counts[-2:]]
    section.targets += [
        Target("memory per instance, largest / smallest", 1.1, _spread([o["bytes"] for o in many])),
        Target(
            "step over instances, largest / smallest",
            1.1,
            _spread([outcomes["ours", n]["step"] for n in counts]),
        ),
    ]
    lengths = (100, 1000) if settings.quick else (1000, 10_000, 100_000, 1_000_000)
    loaded = sides["ours"]
    runs = _rounds(
        {("ours", n): lambda n=n: _work(loaded, steps=n) for n in lengths},  # type: ignore[misc]
        settings.rounds,
        advance,
    )
    section.tables.append(
        Table(
            "communication steps of one instance",
            ("steps", "us per step", "memory grown, kB", "bytes per step"),
            [
                (n, o["step"] * 1e6, o["grown"] / 1024, o["grown"] / n)
                for (_, n), o in runs.items()
            ],
        )
    )
    section.targets += [
        Target("step over steps, largest / smallest", 1.1, _spread([o["step"] for o in runs.values()])),
        Target(
            f"bytes grown per step over {lengths[-1]} steps",
            0.1,
            max(0.0, runs["ours", lengths[-1]]["grown"]) / lengths[-1],
        ),
    ]
    return section

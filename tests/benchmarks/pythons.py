"""What a communication step of one FMU file costs under each CPython that .ci/importers found.

In fmpy and in a C host with nothing but that Python on PATH, one internal step and ten per
communication step, all interleaved: medians, and the ratio to the fastest within a round.
"""

from __future__ import annotations

import argparse
import subprocess
import tempfile
from collections.abc import Callable
from functools import partial
from pathlib import Path

from fmi.pythons import VERSIONS, folder, in_fmpy, program

from curvebound.compiling.toolchain import compiler
from curvebound.errors import CurveboundError
from curvebound.study.timing import interleave, median

from .fmu_section import load_ours
from .ours import Loaded

__all__ = ["configure", "run"]

_NAME = "ParabolaPendulum"
_HOST = Path(__file__).resolve().parents[1] / "host"
#: s, largest internal step
_STEP = 1e-3
_MOST = 1.3


def configure(parser: argparse.ArgumentParser) -> None:
    parser.add_argument("--rounds", type=int, default=7, help="rounds of measurements (7)")


def run(arguments: argparse.Namespace) -> int:
    """Measure and print; 1 where a Python needs more than 1.3 times the fastest."""
    found = {version: python for version in VERSIONS if (python := program(version))}
    if len(found) < 2:
        raise CurveboundError(
            f"of {', '.join(VERSIONS)} fewer than two are here: run .ci/importers"
        )
    with tempfile.TemporaryDirectory(prefix="curvebound-bench-") as name:
        place = Path(name)
        loaded = load_ours(_NAME, place)
        host = _compiled_host(place)
        probes: dict[str, Callable[[], float]] = {}
        for where, cost in (("fmpy", _in_fmpy), ("C host", partial(_in_host, host))):
            for internal in (1, 10):
                for version, python in found.items():
                    key = f"{where}, {internal} internal {version}"
                    probes[key] = partial(cost, loaded, python, internal)
        samples = interleave(probes, arguments.rounds)
    worst = 0.0
    print(f"{_NAME}, doStep: microseconds, and over the fastest Python")
    for group in dict.fromkeys(key.rpartition(" ")[0] for key in samples):
        of_group = {version: samples[f"{group} {version}"] for version in found}
        print(f"  {group}")
        fastest = min(of_group, key=lambda version: median(of_group[version]))
        for version, times in of_group.items():
            pairs = zip(times, of_group[fastest], strict=True)
            ratio = median([one / other for one, other in pairs])
            worst = max(worst, ratio)
            print(f"    CPython {version:5} {median(times) * 1e6:7.2f}  {ratio:5.2f}")
    print(f"largest ratio {worst:.2f}, at most {_MOST} is promised")
    return int(worst > _MOST)


def _compiled_host(place: Path) -> Path:
    command = compiler()
    if command is None:
        raise CurveboundError("the C host needs a C compiler: install gcc")
    program = place / "host"
    subprocess.run(
        [*command, "-std=c11", "-O2", _HOST / "host.c", "-o", program, "-ldl", "-lpthread"],
        check=True,
    )
    return program


def _in_fmpy(loaded: Loaded, python: Path, internal: int) -> float:
    description = loaded.description
    identifier = description.coSimulation.modelIdentifier
    size = internal * _STEP
    return in_fmpy(python, loaded.folder, identifier, description.guid, size, 20000).seconds


def _in_host(host: Path, loaded: Loaded, python: Path, internal: int) -> float:
    description = loaded.description
    identifier = description.coSimulation.modelIdentifier
    size, count = internal * _STEP, 100_000
    commands = [
        f"load 0 {loaded.folder}/binaries/linux64/{identifier}.so",
        f"new 0 0 i {description.guid} file://{loaded.folder}/resources 0",
        *("setup 0 - 0 -", "enter 0", "exit 0", f"steps 0 0 {size!r} 100", "clock"),
        *(f"steps 0 {100 * size!r} {size!r} {count}", "clock", "terminate 0", "free 0"),
    ]
    text = "".join(command.replace(" ", "\t") + "\n" for command in commands)
    done = subprocess.run(
        [host], input=text, env={"PATH": folder(python)}, capture_output=True, text=True
    )
    answers = [line.split() for line in done.stdout.splitlines()]
    if done.returncode or any(answer[:2] != ["=", "OK"] for answer in answers):
        raise CurveboundError(f"the C host failed under {python}:\n{done.stdout}{done.stderr}")
    began, ended = (float(answer[2]) for answer in answers if len(answer) > 2)
    return (ended - began) / count

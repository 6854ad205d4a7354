"""The compiled kernel of another commit beside the one here: whether both give the same bits, and
what each method costs. For changes of the kernel that are to change nothing."""

from __future__ import annotations

import argparse
import importlib
import os
import random
import subprocess
import sys
import tempfile
from collections.abc import Iterator
from pathlib import Path
from typing import NamedTuple

from curvebound.kernel.methods import METHODS
from curvebound.study.timing import Probe, interleave, median, probe, ratio

from .ours import STATES, Kernel, defaults

__all__ = ["configure", "run"]

_ROOT = Path(__file__).resolve().parents[2]
#: written by the checkout's own package: its extension modules, and their names
_WRITE = """
import sys
from pathlib import Path
from curvebound.compiling.extension import SUFFIXES
from curvebound.compiling.toolchain import HERE
from curvebound.fmi.compile import extension
from curvebound.fmi.folder import find
from curvebound.fmi.runtime import runtime, system_sources
core = runtime()
systems = [system_sources(find(name), core) for name in sys.argv[2:]]
for unit in (None, *systems):
    name = unit.extension if unit else core.extension
    (Path(sys.argv[1]) / f"{name}{SUFFIXES[HERE]}").write_bytes(extension(HERE, core, unit))
    print(name)
"""
#: title -> FMU, parameters and choices
_CASES: dict[str, tuple[str, dict[str, float]]] = {
    "pendulum": ("ParabolaPendulum", {"model.fidelity": 2}),
    "pendulum, damped": (
        "ParabolaPendulum",
        {"model.fidelity": 2, "slider.damping": 0.1, "pendulum.damping": 0.1},
    ),
    "pendulum, stiff": (
        "ParabolaPendulum",
        {"model.fidelity": 2, "pendulum.damping": 1e4},
    ),
    "pendulum, linear": ("ParabolaPendulum", {"model.fidelity": 1}),
    "bead, angle": ("BeadOnWire", {"model.formulation": 2, "bead.damping": 0.1}),
    "bead, undamped angle": ("BeadOnWire", {"model.formulation": 2}),
    "bead, Cartesian": ("BeadOnWire", {"constraint.stabilization": 1}),
    "bead, projection": ("BeadOnWire", {"constraint.stabilization": 3}),
}
#: s and steps in it, for the methods of a given step
_STEP, _COUNT = 0.1, 100
_TOLERANCES = (1e-4, 1e-7, 1e-10, 1e-13)
_MOST_INPUTS = 32
#: the methods for which alone a case makes sense, and the only case of one
_METHODS_FOR = {"pendulum, stiff": ("adaptive", "implicit")}
_CASES_FOR = {"exact": ("pendulum, linear",)}


class _Start(NamedTuple):
    """What differs from run to run."""

    values: dict[str, float]
    inputs: list[float]
    tolerance: float


def configure(parser: argparse.ArgumentParser) -> None:
    """Add the arguments."""
    parser.add_argument("commit", nargs="?", default="HEAD", help="default: HEAD")
    parser.add_argument("--starts", type=int, default=200, help="random starts of each case")
    parser.add_argument("--rounds", type=int, default=15, help="of measurements")
    parser.add_argument("--method", choices=METHODS, action="append", help="default: all")


def _checked_out(commit: str, folder: Path) -> Path:
    """The files of a commit in a new folder."""
    folder.mkdir()
    archive = ["git", "-C", str(_ROOT), "archive", commit]
    files = subprocess.run(archive, stdout=subprocess.PIPE, check=True).stdout
    subprocess.run(["tar", "-x", "-C", str(folder)], input=files, check=True)
    return folder


def _kernel_of(tree: Path, folder: Path) -> Kernel:
    """The compiled kernel of a checkout, by way of a new folder."""
    folder.mkdir()
    done = subprocess.run(
        [sys.executable, "-c", _WRITE, str(folder), *STATES],
        env={**os.environ, "PYTHONPATH": str(tree / "src")},
        stdout=subprocess.PIPE,
        text=True,
        check=True,
    )
    sys.path.insert(0, str(folder))
    importlib.invalidate_caches()
    core, *systems = (importlib.import_module(name) for name in done.stdout.split())
    sys.path.remove(str(folder))
    factories = {name: system.model for name, system in zip(STATES, systems, strict=True)}
    return Kernel(core.create, factories)


def _starts(name: str, values: dict[str, float], count: int) -> Iterator[_Start]:
    """Random starts of a case; inputs and speeds are zero in some."""
    drawn = random.Random(1)
    own, _ = defaults(name)
    for _ in range(count):
        size = drawn.choice((0.0, 1e-3, 0.3, 2.0))
        moved = {
            key: value + size * drawn.gauss(0.0, 1.0)
            for key, value in own.items()
            if key.endswith("_start")
        }
        push = drawn.choice((0.0, 2.0))
        inputs = [push * drawn.gauss(0.0, 1.0) for _ in range(_MOST_INPUTS)]
        yield _Start({**moved, **values}, inputs, drawn.choice(_TOLERANCES))


def _outcome(kernel: Kernel, name: str, item: int, start: _Start) -> list[object]:
    """All that three communication steps leave, the inputs changing in between."""
    found: list[object] = []
    try:
        model = kernel.system(name, start.values)
        method = kernel.method(item)
        for factor in (1.0, -0.5, 0.0):
            model.set_inputs([factor * value for value in start.inputs], 0)
            found.append(method.advance(model, _STEP, _COUNT, start.tolerance, 10**4))
            found += [repr(model.get_state()), repr(method.get_state())]
            found += [method.steps, method.evaluations]
    except (ArithmeticError, ValueError, NotImplementedError) as error:
        found.append(repr(error))
    return found


def _probe(kernel: Kernel, name: str, item: int, values: dict[str, float]) -> Probe:
    """What 50 communication steps cost."""
    model = kernel.system(name, values)
    method = kernel.method(item)
    begin = model.get_state()

    def reset() -> None:
        model.set_state(begin)
        method.reset()

    def advance() -> None:
        for _ in range(50):
            method.advance(model, _STEP, _COUNT // 10, 1e-8, 10**6)

    return probe(advance, 1, reset=reset)


def run(options: argparse.Namespace) -> int:
    """Print a row for each method and case; returns 1 where bits differ."""
    with tempfile.TemporaryDirectory() as scratch:
        place = Path(scratch)
        theirs = _kernel_of(_checked_out(options.commit, place / "tree"), place / "theirs")
        ours = _kernel_of(_ROOT, place / "ours")
        different = 0
        print(f"{'':42}same bits       us   {options.commit:.12}  ratio")
        for method in options.method or METHODS:
            item = METHODS.index(method) + 1
            for title, (name, values) in _CASES.items():
                if method not in _METHODS_FOR.get(title, METHODS):
                    continue
                if title not in _CASES_FOR.get(method, _CASES):
                    continue
                starts = list(_starts(name, values, options.starts))
                same = sum(
                    _outcome(ours, name, item, start) == _outcome(theirs, name, item, start)
                    for start in starts
                )
                different += len(starts) - same
                probes = {
                    "ours": _probe(ours, name, item, values),
                    "theirs": _probe(theirs, name, item, values),
                }
                times = interleave(probes, options.rounds)
                print(
                    f"{method:20} {title:20} {same:4} of {len(starts):4}"
                    f" {median(times['ours']) * 1e6:9.1f} {median(times['theirs']) * 1e6:9.1f}"
                    f" {ratio(times['ours'], times['theirs']):8.3f}",
                    flush=True,
                )
    return int(different > 0)

"""One RK4 step of the kernels that are derived from mechanics.py, in times of those by hand.

    python tests/benchmarks/derived_kernels.py [ROUNDS]

Both compiled, timed in turn in one process; the ratio is that of the shortest times. Prints a row
for each model, and where both end after so many steps.
"""

from __future__ import annotations

import shutil
import sys
import tempfile
import time
from pathlib import Path
from typing import Any

from curvebound.fmi.compile import load_compiled
from curvebound.fmi.declaration import CHOICE, COUNT_PARAMETER, PARAMETER
from curvebound.fmi.folder import Folder, find
from curvebound.fmi.runtime import runtime, system_sources

RK4 = 3
STEP = 1e-3  # s
COUNT = 5000
#: title -> (FMU, parameters and choices, most that a step may cost)
CASES: dict[str, tuple[str, dict[str, float], float | None]] = {
    "pendulum, nonlinear": ("ParabolaPendulum", {"model.fidelity": 2}, 1.4),
    "pendulum, damped": (
        "ParabolaPendulum",
        {"model.fidelity": 2, "slider.damping": 0.1, "pendulum.damping": 0.1},
        None,
    ),
    "pendulum, linear": ("ParabolaPendulum", {"model.fidelity": 1}, None),
    "bead, angle": ("BeadOnWire", {"model.formulation": 2}, 1.2),
    "bead, Cartesian": ("BeadOnWire", {"constraint.stabilization": 1}, 1.2),
    "bead, baumgarte": ("BeadOnWire", {"constraint.stabilization": 2}, 1.2),
    "bead, projection": ("BeadOnWire", {"constraint.stabilization": 3}, 1.2),
}


def without_kernel(folder: Folder, into: Path) -> Folder:
    """A copy of a system that has to be derived."""
    copy = into / folder.path.name
    copy.mkdir()
    for name in ("fmu.py", "mechanics.py"):
        shutil.copy(folder.path / name, copy)
    return Folder(copy.resolve())


def started(folder: Folder, values: dict[str, float]) -> tuple[Any, Any]:
    """A compiled model at the start, and its method."""
    core, system = load_compiled(system_sources(folder, runtime()))
    variables = folder.declaration().variables
    reals = {v.name: float(v.start) for v in variables if v.kind == PARAMETER}
    choices = {v.name: int(v.start) for v in variables if v.kind in (CHOICE, COUNT_PARAMETER)}
    reals |= {n: x for n, x in values.items() if n in reals}
    choices |= {n: int(x) for n, x in values.items() if n in choices}
    model = system.model(choices)
    model.start(reals, choices)
    model.set_inputs([0.0] * len(model.INPUTS), 0)
    return model, core.create(RK4)


def main(rounds: int = 40) -> int:
    """Print the ratios; status 1 where one exceeds its limit."""
    missed = 0
    with tempfile.TemporaryDirectory() as scratch:
        derived = {
            name: without_kernel(find(name), Path(scratch))
            for name in sorted({case[0] for case in CASES.values()})
        }
        for title, (name, values, limit) in CASES.items():
            pairs = [started(folder, values) for folder in (find(name), derived[name])]
            times: list[list[float]] = [[], []]
            for _ in range(rounds):
                for (model, method), found in zip(pairs, times, strict=True):
                    began = time.perf_counter()
                    method.advance(model, COUNT * STEP, COUNT, 1e-6, 10**9)
                    found.append(time.perf_counter() - began)
            hand, own = (min(found) / COUNT * 1e9 for found in times)
            apart = abs(pairs[0][0].q0 - pairs[1][0].q0)
            aim = "" if limit is None else f", at most {limit}"
            missed += limit is not None and own / hand > limit
            print(
                f"{title:20} {hand:6.1f} ns by hand, {own:6.1f} derived: {own / hand:.2f} times"
                f"{aim}; apart {apart:.1e} after {rounds * COUNT * STEP:g} s"
            )
    return 1 if missed else 0


if __name__ == "__main__":
    sys.exit(main(*map(int, sys.argv[1:2])))

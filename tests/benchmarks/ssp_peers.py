"""The same SSP package in other tools: fmpy's simulate_ssp, libcosim and ecos, where installed.

    python -m benchmarks.ssp_peers TOOL FILE.ssp STEP COUNT COMPONENT.VARIABLE ...

run in tests/, runs one of them in a process of its own (they are native code) and prints JSON: the
stepping time in s, and the outputs at each communication point after a step. All are Jacobi masters
without evaluation of direct feedthrough, without the initial point in their records.
"""

from __future__ import annotations

import json
import shutil
import subprocess
import sys
import tempfile
import time as clock
import zipfile
from collections.abc import Callable, Sequence
from importlib import import_module
from importlib.util import find_spec
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from curvebound.cosim.ssp import PARAMETER_SET, PARAMETERS
from curvebound.errors import CurveboundError

__all__ = ["TOOLS", "available", "run_peer"]

TESTS = Path(__file__).resolve().parents[1]

Run = tuple[float, dict[str, list[float]]]


def available(tool: str) -> bool:
    """Whether the tool's Python package is installed."""
    return find_spec(_PACKAGES[tool]) is not None


def run_peer(
    tool: str, package: Path, step: float, count: int, outputs: Sequence[str], timeout: float = 300
) -> tuple[float, dict[str, NDArray[np.float64]]]:
    """Run `count` steps of `step` s; seconds spent stepping, and each output, shape (count,).

    Raises CurveboundError when the tool fails.
    """
    command = [sys.executable, "-m", "benchmarks.ssp_peers"]
    command += [tool, str(package.resolve()), repr(step), str(count), *outputs]
    try:
        done = subprocess.run(
            command, cwd=TESTS, capture_output=True, text=True, timeout=timeout, check=False
        )
    except subprocess.TimeoutExpired:
        raise CurveboundError(f"{tool} did not end within {timeout:g} s.") from None
    line = next((x for x in done.stdout.splitlines() if x.startswith("{")), None)
    if line is None:
        said = (done.stderr or done.stdout).strip().splitlines()
        raise CurveboundError(
            f"{tool} failed with status {done.returncode}: {' '.join(said[-3:]) or 'no message'}"
        )
    answer = json.loads(line)
    return answer["seconds"], {name: np.array(v) for name, v in answer["values"].items()}


def _simulate_ssp(package: Path, step: float, count: int, outputs: Sequence[str]) -> Run:
    from fmpy.ssp.simulation import simulate_ssp
    from fmpy.ssp.ssd import read_ssv

    parameters = read_ssv(str(package), resource=PARAMETERS)

    def timed(n: int) -> tuple[float, Any]:
        began = clock.perf_counter()
        # half a step less than the end: its loop adds steps up and might take one more
        data = simulate_ssp(
            str(package), stop_time=(n - 0.5) * step, step_size=step, parameter_set=parameters
        )
        return clock.perf_counter() - began, data

    # it does not tell set-up and stepping apart: a run of one step is taken off
    setup = min(timed(1)[0] for _ in range(3))
    runs = [timed(count) for _ in range(2)]
    data = runs[0][1]
    return min(run[0] for run in runs) - setup, {name: data[name].tolist() for name in outputs}


def _libcosim(package: Path, step: float, count: int, outputs: Sequence[str]) -> Run:
    real = import_module("libcosimpy.CosimEnums").CosimVariableType.REAL
    execution_class = import_module("libcosimpy.CosimExecution").CosimExecution
    observer_class = import_module("libcosimpy.CosimObserver").CosimObserver

    folder = tempfile.mkdtemp()
    with zipfile.ZipFile(package) as archive:
        archive.extractall(folder)
    execution = execution_class.from_ssp_file(ssp_path=folder, step_size=round(step * 1e9))
    observer = observer_class.create_time_series(buffer_size=count + 2)
    execution.add_observer(observer)
    ports = {}
    for name in outputs:
        component, _, variable = name.partition(".")
        index = execution.slave_index_from_instance_name(component)
        reference = next(
            v.reference for v in execution.slave_variables(index) if v.name.decode() == variable
        )
        observer.start_time_series(index, reference, real)
        ports[name] = (index, reference)
    execution.step()  # the first call initializes and stays at the start
    began = clock.perf_counter()
    execution.step(count)
    seconds = clock.perf_counter() - began
    values = {}
    for name, (index, reference) in ports.items():
        _, _, samples = observer.time_series_real_samples(index, reference, 1, count)
        values[name] = list(samples)
    shutil.rmtree(folder, ignore_errors=True)
    return seconds, values


def _ecos(package: Path, step: float, count: int, outputs: Sequence[str]) -> Run:
    simulation_class = import_module("ecospy").EcosSimulation
    names = {name: "::".join(name.split(".", 1)) for name in outputs}

    def simulation() -> Any:
        made = simulation_class(ssp_path=str(package), step_size=step)
        made.init(parameter_set=PARAMETER_SET)
        return made

    values: dict[str, list[float]] = {name: [] for name in outputs}
    with simulation() as watched:
        for _ in range(count):
            watched.step()
            for name, identifier in names.items():
                values[name].append(watched.get_real(identifier))
        watched.terminate()
    with tempfile.TemporaryDirectory() as folder:
        written = simulation_class(ssp_path=str(package), step_size=step)
        written.add_csv_writer(f"{folder}/out.csv", identifiers=list(names.values()))
        written.init(parameter_set=PARAMETER_SET)
        began = clock.perf_counter()
        written.step(count)
        seconds = clock.perf_counter() - began
        written.terminate()
        written.free()
    return seconds, values


TOOLS: dict[str, Callable[[Path, float, int, Sequence[str]], Run]] = {
    "simulate_ssp": _simulate_ssp,
    "libcosim": _libcosim,
    "ecos": _ecos,
}
_PACKAGES = {"simulate_ssp": "fmpy", "libcosim": "libcosimpy", "ecos": "ecospy"}


def main(arguments: Sequence[str]) -> None:
    """Run one tool and print what it gave."""
    tool, package, step, count, *outputs = arguments
    seconds, values = TOOLS[tool](Path(package), float(step), int(count), outputs)
    print(json.dumps({"seconds": seconds, "values": values}), flush=True)


if __name__ == "__main__":
    main(sys.argv[1:])

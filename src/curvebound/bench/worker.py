"""What the section size measures, one process each: python -m curvebound.bench.worker JSON.

The argument is an object with name, folder (an extracted FMU), instances, steps; one JSON object is
printed. Only the process that holds the instances can tell what they cost.
"""

from __future__ import annotations

import copy
import ctypes
import gc
import json
import os
import sys
import time
from pathlib import Path
from typing import Any

__all__ = ["instances", "steps"]

#: s
_STEP = 1e-3


def resident() -> int:
    """Resident memory of this process, bytes; what has been freed is first handed back."""
    gc.collect()
    try:
        ctypes.CDLL(None).malloc_trim(0)
        pages = int(Path("/proc/self/statm").read_text("ascii").split()[1])
        return pages * os.sysconf("SC_PAGE_SIZE")
    except (OSError, AttributeError, ValueError, TypeError):
        import resource  # not Linux: the largest so far must do

        peak = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss
        return peak if sys.platform == "darwin" else peak * 1024


def _another(loaded: Any, first: Any) -> Any:
    """One more instance behind the library that `first` has loaded.

    fmpy's own object, with its 50 functions, is shared: only the FMU's share is to be seen.
    """
    slave = copy.copy(first)
    slave.instantiate()
    loaded.begin(slave, {"solver.step": _STEP})
    return slave


def instances(loaded: Any, count: int, steps: int) -> dict[str, float]:
    """Bytes and seconds per instance of `count`, seconds per step when they step in turn."""
    first = loaded.slave({"solver.step": _STEP})
    read = [v.valueReference for v in loaded.description.modelVariables if v.causality == "output"]
    reals = [vr for vr in read if loaded.types_by_reference[vr] == "Real"][:6]

    def warm(slave: Any, at: int) -> None:
        for i in range(at, at + 20):
            slave.doStep(i * _STEP, _STEP)
            slave.getReal(reals)

    for _ in range(5):
        warm(_another(loaded, first), 0)
    before = resident()
    began = time.process_time_ns()
    slaves = [_another(loaded, first) for _ in range(count)]
    made = time.process_time_ns() - began
    for slave in slaves:
        warm(slave, 0)
    grown = resident() - before
    gc.disable()
    each = max(1, steps // count)
    began = time.process_time_ns()
    for i in range(20, 20 + each):
        now = i * _STEP
        for slave in slaves:
            slave.doStep(now, _STEP)
            slave.getReal(reals)
    stepped = time.process_time_ns() - began
    return {
        "bytes": grown / count,
        "instantiation": made * 1e-9 / count,
        "step": stepped * 1e-9 / (each * count),
    }


def steps(loaded: Any, count: int) -> dict[str, float]:
    """Seconds per communication step of `count`, and bytes that the process has grown by."""
    slave = loaded.slave({"solver.step": _STEP})
    reals = [v.valueReference for v in loaded.description.modelVariables if v.causality == "output"]
    reals = [vr for vr in reals if loaded.types_by_reference[vr] == "Real"][:6]
    warm = 1000
    for i in range(warm):
        slave.doStep(i * _STEP, _STEP)
        slave.getReal(reals)
    before = resident()
    gc.disable()
    began = time.process_time_ns()
    for i in range(warm, warm + count):
        slave.doStep(i * _STEP, _STEP)
        slave.getReal(reals)
    spent = time.process_time_ns() - began
    return {"step": spent * 1e-9 / count, "grown": float(resident() - before)}


def main() -> None:
    """Do what the argument says and print the outcome."""
    from .ours import Loaded

    task = json.loads(sys.argv[1])
    loaded = Loaded(task["name"], Path(task["folder"]))
    if "instances" in task:
        outcome = instances(loaded, task["instances"], task["steps"])
    else:
        outcome = steps(loaded, task["steps"])
    print(json.dumps(outcome))


if __name__ == "__main__":
    main()

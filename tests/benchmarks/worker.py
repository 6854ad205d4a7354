"""What the section size measures, one process each: python -m benchmarks.worker JSON.

The argument is an object with name, folder and reference (extracted FMUs), instances, steps; one
JSON object is printed. Only the process that holds the instances can tell what they cost. Each
piece of work is timed beside as many steps of one instance of the reference FMU, because processes
that run one after the other meet a machine of different speed.
"""

from __future__ import annotations

import copy
import ctypes
import gc
import json
import os
import statistics
import sys
import time
from array import array
from collections.abc import Callable
from pathlib import Path
from typing import Any

__all__ = ["instances", "resident", "steps"]

#: s
_STEP = 1e-3
#: communication steps between two looks at the clock
_CHUNK = 500


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


class _Group:
    """Instances of one FMU that step in turn; the first one has loaded the library.

    The others share fmpy's own object with its 50 functions: only the FMU's share is to be seen.
    """

    def __init__(self, loaded: Any) -> None:
        self.loaded = loaded
        self.members = [loaded.slave({"solver.step": _STEP})]
        self.read = [
            v.valueReference
            for v in loaded.description.modelVariables
            if v.causality == "output" and v.type == "Real"
        ][:6]
        self.done = 0

    def add(self, count: int) -> None:
        for _ in range(count):
            slave = copy.copy(self.members[0])
            slave.instantiate(callbacks=slave.callbacks)
            self.loaded.begin(slave, {"solver.step": _STEP})
            self.members.append(slave)

    def run(self, count: int) -> None:
        """`count` communication steps by each instance."""
        members, read = self.members, self.read
        for i in range(self.done, self.done + count):
            now = i * _STEP
            for slave in members:
                slave.doStep(now, _STEP)
                slave.getReal(read)
        self.done += count


def _seconds(run: Callable[[], object]) -> float:
    begin = time.process_time_ns()
    run()
    return (time.process_time_ns() - begin) * 1e-9


def _compare(ours: _Group, reference: _Group, total: int) -> dict[str, float]:
    """Seconds per step of `total` steps, their ratio to the reference's, and bytes grown."""
    per_chunk = max(1, _CHUNK // len(ours.members))
    steps = per_chunk * len(ours.members)
    chunks = max(1, total // steps)
    times = array("d", bytes(8 * chunks))  # no growth of the process from keeping the figures
    ratios = array("d", bytes(8 * chunks))
    start = resident()
    gc.disable()
    for i in range(chunks):
        mine = _seconds(lambda: ours.run(per_chunk))
        other = _seconds(lambda: reference.run(steps))
        times[i] = mine / steps
        ratios[i] = mine / other
    gc.enable()
    grown = float(resident() - start)
    return {
        "step": statistics.median(times),
        "ratio": statistics.median(ratios),
        "grown": grown,
    }


def instances(loaded: Any, other: Any, count: int, total: int, before: int) -> dict[str, float]:
    """Bytes and seconds per instance of `count` more than `before`, and the cost of a step.

    The instances before fill the holes that starting Python has left in memory.
    """
    reference, ours = _Group(other), _Group(loaded)
    reference.run(_CHUNK)
    ours.add(before)
    ours.run(20)
    start = resident()
    made = _seconds(lambda: ours.add(count))
    earlier, ours.members = ours.members[:-count], ours.members[-count:]
    ours.done = 0
    ours.run(20)
    grown = resident() - start
    outcome = _compare(ours, reference, total)
    del earlier  # alive until here: their memory was not to be used again
    return {"bytes": grown / count, "instantiation": made / count, **outcome}


def steps(loaded: Any, other: Any, count: int) -> dict[str, float]:
    """What each of `count` communication steps costs."""
    reference, ours = _Group(other), _Group(loaded)
    ours.run(_CHUNK)
    reference.run(_CHUNK)
    _compare(ours, reference, _CHUNK)
    return _compare(ours, reference, count)


def main() -> None:
    """Do what the argument says and print the outcome."""
    from .ours import Loaded

    task = json.loads(sys.argv[1])
    loaded = Loaded(task["name"], Path(task["folder"]))
    other = Loaded(task["name"], Path(task["reference"]))
    if "instances" in task:
        outcome = instances(loaded, other, task["instances"], task["steps"], task["before"])
    else:
        outcome = steps(loaded, other, task["steps"])
    print(json.dumps(outcome))


if __name__ == "__main__":
    main()

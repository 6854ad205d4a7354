"""Very many communication steps of the pendulum: memory and time per step do not grow.

Called as any importer does, through fmpy's FMU2Slave; each step is also read.
"""

from __future__ import annotations

import statistics
import time as clock
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path

from curvebound.cosim.fmu import Value
from curvebound.cosim.instance import Instance, Library, Log
from curvebound.cosim.scene import Scene

__all__ = ["Endurance", "print_endurance", "run_endurance"]

#: s, of a communication step, which holds INTERNAL internal ones
STEP, INTERNAL = 0.1, 10
BLOCKS = 40
#: bytes by which the memory may grow after the first blocks
MOST_GROWTH = 1_000_000
#: time per step at the end over that at the beginning, on a machine that does other things too
MOST_SLOWING = 1.25


@dataclass(frozen=True)
class Endurance:
    """steps: internal steps made in `calls` communication steps up to `end` (s). growth: bytes of
    memory from the fourth of BLOCKS to the last, or None where the system does not tell. first,
    last: CPU time per call (s), median of a quarter of the blocks. residual: J."""

    calls: int
    end: float
    steps: int
    growth: int | None
    first: float
    last: float
    residual: float

    @property
    def good(self) -> bool:
        """Whether nothing grew and each communication step held its number of internal steps."""
        return (
            self.steps == INTERNAL * self.calls
            and (self.growth is None or self.growth < MOST_GROWTH)
            and self.last < MOST_SLOWING * self.first
        )


def run_endurance(calls: int, progress: Callable[[int], None] | None = None) -> Endurance:
    """Make `calls` communication steps (rounded up to BLOCKS).

    progress: called with the number of steps done.
    """
    scene = Scene("endurance", stop_time=1.0, step=1.0)
    start: dict[str, Value] = {"solver.method": "rk4", "solver.step": STEP / INTERNAL}
    node = scene.add("plant", "ParabolaPendulum", start).check().nodes["plant"]
    block = -(-calls // BLOCKS)
    log = Log()
    library = Library(node.fmu)
    instance = Instance("plant", library, log)
    try:
        instance.initialize(node.start.items(), None, 0.0, block * BLOCKS * STEP)
        instance.call("ExitInitializationMode")
        slave = instance.slave
        of = node.fmu.variables
        reals = [of[v].reference for v in ("slider.u", "pendulum.angle", "energy.residual")]
        spent, memory = [], []
        n = 0
        residual = 0.0
        for _ in range(BLOCKS):
            began = clock.process_time()
            for _ in range(block):
                slave.doStep(n * STEP, STEP)
                residual = slave.getReal(reals)[2]
                n += 1
            spent.append((clock.process_time() - began) / block)
            memory.append(_resident())
            if progress is not None:
                progress(n)
        (steps,) = slave.getReal([of["solver.steps"].reference])
    finally:
        instance.free()
        library.unload()
    early, late = memory[BLOCKS // 10 - 1], memory[-1]
    quarter = BLOCKS // 4
    return Endurance(
        n,
        n * STEP,
        int(steps),
        None if early is None or late is None else late - early,
        statistics.median(spent[:quarter]),
        statistics.median(spent[-quarter:]),
        residual,
    )


def _resident() -> int | None:
    """Bytes of this process in memory."""
    try:
        pages = int(Path("/proc/self/statm").read_text().split()[1])
    except OSError:
        return None
    import resource

    return pages * resource.getpagesize()


def print_endurance(one: Endurance) -> None:
    """Some lines."""
    from rich.console import Console

    growth = "unknown" if one.growth is None else f"{one.growth / 1024:.0f} KiB"
    Console(highlight=False).print(
        f"pendulum, {one.calls} communication steps of {STEP:g} s to {one.end:g} s: "
        f"{one.steps} internal steps ({INTERNAL} each: "
        f"{'yes' if one.steps == INTERNAL * one.calls else 'no'}), memory grew by {growth}, "
        f"CPU time per step {one.first * 1e6:.2f} us in the first quarter, "
        f"{one.last * 1e6:.2f} us in the last; energy residual {one.residual:.1e} J",
        soft_wrap=True,
    )

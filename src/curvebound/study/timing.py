"""Timing in rounds: everything that will be compared is measured in turn, A B C A B C, so that a
drift of the machine's speed falls on all alike; ratios are taken within a round."""

from __future__ import annotations

import gc
import statistics
import time
from collections.abc import Callable, Iterator, Mapping
from contextlib import contextmanager

__all__ = ["Probe", "Samples", "cpu_seconds", "interleave", "median", "paused_gc", "probe", "ratio"]

#: makes one measurement and returns its value (s per unit of work)
Probe = Callable[[], float]
#: the measurements of one probe, one per round
Samples = list[float]

#: s, long enough for the clock and the call that is timed to vanish in it
SAMPLE = 5e-3


@contextmanager
def paused_gc() -> Iterator[None]:
    """No garbage collection inside; what there is, is collected before."""
    was_enabled = gc.isenabled()
    gc.collect()
    gc.disable()
    try:
        yield
    finally:
        if was_enabled:
            gc.enable()


def cpu_seconds(run: Callable[[], object]) -> float:
    """CPU time of this process, all threads, for one call: waiting for a core does not count."""
    begin = time.process_time_ns()
    run()
    return (time.process_time_ns() - begin) * 1e-9


def probe(
    run: Callable[[], object],
    units: float,
    *,
    reset: Callable[[], object] | None = None,
    sample: float = SAMPLE,
) -> Probe:
    """A probe of `run`, which does `units` of work; `reset` precedes each run and is not timed.

    The run is repeated until a sample has lasted `sample` seconds; the number of repetitions is
    fixed by two first runs, which also warm up.
    """
    prepare = reset or (lambda: None)
    prepare()
    run()
    prepare()
    repeats = max(1, round(sample / max(cpu_seconds(run), 1e-7)))

    def measure() -> float:
        total = 0.0
        for _ in range(repeats):
            prepare()
            total += cpu_seconds(run)
        return total / (repeats * units)

    return measure


def interleave(
    probes: Mapping[str, Probe], rounds: int, advance: Callable[[], object] | None = None
) -> dict[str, Samples]:
    """Take `rounds` measurements of each probe in turn; calls `advance` after each one."""
    samples: dict[str, Samples] = {name: [] for name in probes}
    with paused_gc():
        for _ in range(rounds):
            for name, measure in probes.items():
                samples[name].append(measure())
                if advance:
                    advance()
    return samples


def median(samples: Samples) -> float:
    """Median over the rounds."""
    return statistics.median(samples)


def ratio(ours: Samples, theirs: Samples) -> float:
    """Median over the rounds of the ratio within a round."""
    return statistics.median(a / b for a, b in zip(ours, theirs, strict=True))

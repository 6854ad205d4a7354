"""The simple pendulum of the IFToMM benchmark library (problem A01) as a bead, over 2000 s.

Gonzalez, Dopico, Lugris, Cuadrado (2006) let it go from the horizontal and ask for the position to
1e-3. The exact one is sin(angle/2) = k cd(w t, k) with k = sin(pi/4) (Jacobi's elliptic functions).
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from curvebound.cosim.fmu import Value
from curvebound.cosim.scene import Scene

__all__ = ["SETTINGS", "STOP", "THRESHOLD", "Benchmark", "position", "print_benchmark", "run_one"]

GRAVITY = 9.81
#: s
STOP = 2000.0
#: m: the benchmark's, and the one asked of the settings to be used for it
THRESHOLD, WANTED = 1e-3, 1e-6
#: points at which the position is compared
POINTS = 200

#: words, communication step (s), what is set on top of the FMU's defaults, whether it is to be used
SETTINGS: tuple[tuple[str, float, dict[str, Value], bool], ...] = (
    ("defaults (rk4, 1 ms)", 0.01, {}, True),
    ("adaptive, default tolerance 1e-6", 0.01, {"solver.method": "adaptive"}, True),
    (
        "adaptive, default tolerance 1e-6, angle",
        0.01,
        {"solver.method": "adaptive", "model.formulation": "angle"},
        True,
    ),
    (
        "adaptive, tolerance 1e-10",
        10.0,
        {"solver.method": "adaptive", "solver.tolerance": 1e-10},
        True,
    ),
    (
        "adaptive, tolerance 1e-12, angle",
        10.0,
        {"solver.method": "adaptive", "solver.tolerance": 1e-12, "model.formulation": "angle"},
        True,
    ),
    ("adaptive, default tolerance 1e-6", 10.0, {"solver.method": "adaptive"}, False),
)


@dataclass(frozen=True)
class Benchmark:
    """error: largest of x and y over the run, in m. energy: largest residual in J. used: whether
    the error must stay below WANTED."""

    words: str
    step: float
    error: float
    energy: float
    steps: int
    used: bool

    @property
    def good(self) -> bool:
        """Whether the error is what it must be."""
        return self.error < (WANTED if self.used else THRESHOLD)


def position(times: Sequence[float]) -> NDArray[np.float64]:
    """x, y (m) at times (s); shape (len(times), 2). Needs mpmath."""
    import mpmath

    rows = []
    with mpmath.workdps(30):
        k = mpmath.sin(mpmath.pi / 4)
        rate = mpmath.sqrt(mpmath.mpf(str(GRAVITY)))
        for time in times:
            phase = rate * mpmath.mpf(time)
            cn, dn = (mpmath.ellipfun(kind, phase, k=k) for kind in ("cn", "dn"))
            half = k * cn / dn
            rows.append((2 * half * mpmath.sqrt(1 - half * half), 2 * half * half - 1))
    return np.array([[float(x), float(y)] for x, y in rows])


def run_one(number: int, stop: float = STOP) -> Benchmark:
    """Run SETTINGS[number] to `stop` s."""
    words, step, settings, used = SETTINGS[number]
    count = round(stop / step)
    scene = Scene("a01", stop_time=stop, step=step, record_every=max(1, count // POINTS))
    scene.add("bead", "BeadOnWire", settings)
    names = [f"bead.{v}" for v in ("bead.x", "bead.y", "energy.residual", "solver.steps")]
    scene.record(*names)
    with scene.prepare() as prepared:
        result = prepared.run()
    x, y, residual, steps = (result[name] for name in names)
    error = np.abs(np.stack([x, y], axis=1) - position(result.time.tolist())).max()
    return Benchmark(words, step, float(error), float(np.abs(residual).max()), int(steps[-1]), used)


def print_benchmark(results: Sequence[Benchmark]) -> None:
    """A table."""
    from rich.console import Console
    from rich.table import Table

    table = Table(
        title=f"IFToMM A01, {STOP:g} s (threshold {THRESHOLD:g} m, asked {WANTED:g} m)",
        box=None,
        title_justify="left",
    )
    table.add_column("bead with")
    for heading in ("communication", "error (m)", "energy (J)", "steps"):
        table.add_column(heading, justify="right")
    table.add_column("held")
    for one in results:
        held = one.error < WANTED, one.error < THRESHOLD
        table.add_row(
            one.words,
            f"{one.step:g} s",
            f"{one.error:.1e}",
            f"{one.energy:.1e}",
            str(one.steps),
            "both" if all(held) else f"{THRESHOLD:g}" if any(held) else "none",
        )
    Console(highlight=False).print(table)

"""Long runs of the bead: does the error of each method grow as theory says?

Undamped, from 2 rad at rest, in the angle. Symplectic methods keep their energy error bounded, so
that their phase error grows linearly with time; the energy error of the others grows linearly, and
their phase error, its integral, quadratically (Hairer, Lubich, Wanner 2006, sec. IX.8, X.3).
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from curvebound.cosim.results import RunFailed
from curvebound.cosim.scene import Scene

__all__ = ["EXPECTED", "METHODS", "LongRun", "period", "print_long", "run_long"]

#: internal steps in a period, enough to keep the phase error below a quarter of one
STEPS = {
    "semi_implicit_euler": 4000,
    "rk4": 1000,
    "implicit": 100,
    "adaptive": 10,
    "explicit_euler": 1_000_000,
}
METHODS = tuple(STEPS)
#: exponents of the growth with time of energy and phase error
EXPECTED = {
    "semi_implicit_euler": (0.0, 1.0),
    "rk4": (1.0, 2.0),
    "implicit": (0.0, 1.0),
    "adaptive": (1.0, 2.0),
    "explicit_euler": (1.0, 2.0),
}
#: how far a measured exponent may lie from it
CLOSE = 0.15
#: explicit Euler gains (2 pi)^2 / STEPS of its energy in each period, so that it is a quarter of a
#: period late after 150: it is run this part of the periods, and 80 at least
SHORTENED = {"explicit_euler": 5e-4}
#: rad; from the horizontal itself the phase error of symplectic methods happens to vanish
START = 2.0
GRAVITY = 9.81
#: of the run, at whose ends the error is taken
PARTS = 64


@dataclass
class LongRun:
    """Energy over what is at stake (largest in the run) and phase error, in periods, at its end,
    counted from the first sixty-fourth of the run.

    energy_exponent, phase_exponent: of growth with time, from a quarter of the run to its end.
    message: of a failure.
    """

    method: str
    periods: float
    energy: float = math.nan
    phase: float = math.nan
    energy_exponent: float = math.nan
    phase_exponent: float = math.nan
    message: str = ""

    @property
    def as_expected(self) -> bool:
        """Whether both errors grow as theory says."""
        energy, phase = EXPECTED[self.method]
        return (
            abs(self.energy_exponent - energy) <= CLOSE
            and abs(self.phase_exponent - phase) <= CLOSE
        )


def period() -> float:
    """Of the bead let go at START (s): 2 pi / M(1, cos(START/2)) sqrt(r/g), M the arithmetic-
    geometric mean (Gauss 1799)."""
    a, b = 1.0, math.cos(0.5 * START)
    while abs(a - b) > 1e-15:
        a, b = 0.5 * (a + b), math.sqrt(a * b)
    return 2.0 * math.pi / a / math.sqrt(GRAVITY)


def run_long(method: str, periods: float) -> LongRun:
    """Run a method, sampled where the exact motion is known: at quarter periods."""
    one = period()
    # every 64th part of the run, and a quarter period on: where the bead is at rest, and lowest;
    # and half-way between, where symplectic methods show their energy error
    cut = max(1.0, round(periods * SHORTENED.get(method, 1.0) / PARTS)) + 0.25
    periods = cut * PARTS
    macro = cut * one
    scene = Scene("long_bead", stop_time=periods * one, step=0.5 * macro)
    scene.add(
        "bead",
        "BeadOnWire",
        {
            "model.formulation": "angle",
            "bead.angle_start": START,
            "solver.method": method,
            "solver.step": one / STEPS[method],
            "solver.tolerance": 1e-10,
            "solver.max_steps": 2_000_000_000,
        },
    )
    scene.record("bead.bead.angle", "bead.bead.angular_velocity", "bead.energy.residual")
    try:
        with scene.prepare() as prepared:
            result = prepared.run()
    except RunFailed as failure:
        return LongRun(method, periods, message=failure.cause)
    residual = np.abs(result["bead.energy.residual"]) / (GRAVITY * (1.0 - math.cos(START)))
    rate, angle = result["bead.bead.angular_velocity"], result["bead.bead.angle"]
    late = [
        _late(i, q, v) / one for i, (q, v) in enumerate(zip(angle[::2], rate[::2], strict=True))
    ]
    # the velocities of Euler's methods belong to other instants than their coordinates: that is
    # there from the first step on and grows no more, so it counts from the first of its kind
    grown = [abs(x - late[1 + (i + 1) % 2]) for i, x in enumerate(late)]
    energy = np.maximum.accumulate(residual)[::2]
    phase = np.maximum.accumulate([0.0, *grown[1:]])
    return LongRun(
        method,
        periods,
        float(energy[-1]),
        float(phase[-1]),
        _exponent(energy),
        _exponent(phase),
    )


def _late(quarters: int, angle: float, rate: float) -> float:
    """By how many s the bead is late where it should have made whole quarter periods.

    It is lowest after an odd number of them (late: not yet there), at rest after an even one.
    """
    if quarters % 2:
        return -math.remainder(angle, 2.0 * math.pi) / rate
    return rate / (GRAVITY * math.sin(angle))


def _exponent(error: NDArray[Any]) -> float:
    """Growth with time, as a power, from a quarter of the run to its end."""
    first, last = float(error[PARTS // 4]), float(error[-1])
    if not (first > 0.0 and last > 0.0 and math.isfinite(last)):
        return math.nan
    return math.log(last / first) / math.log(4.0)


def print_long(results: Sequence[LongRun]) -> None:
    """A table."""
    from rich.console import Console
    from rich.table import Table

    table = Table(
        title=f"bead let go at {START:g} rad: errors of energy (relative) and phase (periods)",
        box=None,
        title_justify="left",
    )
    table.add_column("method", no_wrap=True)
    for heading in ("periods", "energy", "~ t^", "phase", "~ t^"):
        table.add_column(heading, justify="right")
    table.add_column("as theory says")
    for one in results:
        table.add_row(
            one.method,
            f"{one.periods:g}",
            f"{one.energy:.1e}",
            f"{one.energy_exponent:.2f}",
            f"{one.phase:.1e}",
            f"{one.phase_exponent:.2f}",
            "yes" if one.as_expected else one.message or "no",
        )
    Console(highlight=False).print(table)

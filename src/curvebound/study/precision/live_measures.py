"""How far the live error measures can be trusted: what they said against what was true.

Three measures can be read while a simulation runs. Each is set against the true error of the same
run, both relative: to the range of the outputs, and for the energy residual to the largest kinetic
energy. What is stated of a measure is the factor between it and the true error: its median, and the
range that holds nine in ten settings.
"""

from __future__ import annotations

import math
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from ...numbers import plain

__all__ = ["MEASURES", "Measured", "Statement", "points", "statement"]

Row = dict[str, Any]
_ROUNDING = 1e-13  # relative error below which rounding rules, not the measure

_OF_MODEL = "model.acceleration_error"

MEASURES = {
    "solver.tolerance": "solver.tolerance",
    "energy.residual": "energy.residual / kinetic",
    _OF_MODEL: "acceleration_error",
}


@dataclass(frozen=True)
class Measured:
    """What a measure said of one run, and what the error was, both relative."""

    scene: str
    form: str
    method: str
    said: float
    true: float


@dataclass(frozen=True)
class Statement:
    """The factor true / said over `count` runs; correlation: of the ranks (Spearman).

    under: share of the runs in which the true error was above ten times what was said;
    largest: the largest factor of all.
    """

    measure: str
    group: str
    count: int
    median: float
    low: float
    high: float
    under: float
    correlation: float
    largest: float

    @property
    def verdict(self) -> str:
        """In words, what the measure is good for."""
        if self.count < 8:
            return "too few runs to tell"
        orders = self.correlation > 0.7
        if self.high / self.low < 30.0 and self.correlation > 0.9:
            return "a measure of the error"
        exceeded = round(self.under * self.count)
        if exceeded == 0:
            bound = "an upper bound" if self.largest <= 1.0 else "never exceeded tenfold"
            if not orders:
                return f"{bound} in these runs, which does not tell small errors from large ones"
            return f"{bound} in these runs" + (
                ", mostly far above the error" if self.median < 0.1 else ""
            )
        if self.under < 0.05 and orders:
            return f"mostly an upper bound, exceeded tenfold in {exceeded} of {self.count} runs"
        if orders:
            return "tells large errors from small ones, not their size"
        return (
            "a warning only: it can be small while the error is large, as in "
            f"{exceeded} of {self.count} runs"
        )

    @property
    def sentence(self) -> str:
        """How far the measure can be trusted, with the numbers that say so."""
        order = "" if math.isnan(self.correlation) else f", rank correlation {self.correlation:.2f}"
        return (
            f"{self.measure}: {self.verdict}. In nine of ten runs the true error is "
            f"{plain(self.low, 2)} to {plain(self.high, 2)} times what it says, in "
            f"{self.under:.0%} more than ten times ({self.count} runs{order})."
        )


def points(measure: str, studies: Mapping[str, Sequence[Row]]) -> list[Measured]:
    """All runs that the measure applies to; studies: rows by scene."""
    found = []
    for scene, rows in studies.items():
        for row in rows:
            purposes = ("micro", "amplitude") if measure == _OF_MODEL else ("micro",)
            if row["purpose"] not in purposes or row["failure"] or not row["judged"]:
                continue
            amplitude = row.get("amplitude") or 0.0
            said, true = _pair(measure, row)
            if not (said > 0.0 and amplitude > 0.0 and math.isfinite(said)):
                continue
            true /= amplitude
            if _ROUNDING < true < 1.0 and said > 1e-17:
                found.append(Measured(scene, row["form"], row["method"], said, true))
    return found


def _pair(measure: str, row: Row) -> tuple[float, float]:
    if measure == "solver.tolerance":
        said = row["size"] if row["size_is"] == "tolerance" else 0.0
        return said or 0.0, row["numerical"]
    if measure == "energy.residual":
        kinetic = row.get("kinetic") or 0.0
        residual = row["energy_residual"] or 0.0
        return (residual / kinetic if kinetic > 0.0 else 0.0), row["numerical"]
    return (row["acceleration_error"] or 0.0), row.get("modelling", 0.0)


def statement(measure: str, found: Iterable[Measured], group: str = "all") -> Statement | None:
    """The statement on a measure from its points; None without any."""
    every = list(found)
    if measure == _OF_MODEL:  # the same model, run many times, counts once
        every = list({(p.scene, round(math.log10(p.true), 3)): p for p in every}.values())
    if not every:
        return None
    said = np.array([p.said for p in every])
    true = np.array([p.true for p in every])
    ratio = true / said
    low, median, high = np.quantile(ratio, [0.05, 0.5, 0.95])
    return Statement(
        measure, group, len(every), float(median), float(low), float(high),
        float(np.mean(ratio > 10.0)), _spearman(said, true), float(ratio.max()),
    )  # fmt: skip


def _spearman(a: Any, b: Any) -> float:
    if len(a) < 3:
        return math.nan
    ranks = [np.argsort(np.argsort(x)).astype(float) for x in (a, b)]
    if np.ptp(a) == 0.0 or np.ptp(b) == 0.0:
        return math.nan
    return float(np.corrcoef(ranks[0], ranks[1])[0, 1])

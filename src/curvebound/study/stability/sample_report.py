"""What a random sample leaves on disk, and what is said of it."""

from __future__ import annotations

import math
from collections import Counter
from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

from ...numbers import plain, quantity
from ..data_files import write_rows
from .sample import ALLOWED, Sampled, SampleSettings

if TYPE_CHECKING:
    from rich.console import Console

__all__ = ["passes", "print_sample", "write_sample"]

#: share of the points that may fail, warn, be sensitive or have no reference
MOST_FAILURES = 0.01


def passes(outcomes: Sequence[Sampled]) -> bool:
    """Whether none is wrong or crashed, and less than MOST_FAILURES are not accurate."""
    count = Counter(one.verdict for one in outcomes)
    return count["wrong"] + count["crashed"] == 0 and not _too_many(outcomes)


def _too_many(outcomes: Sequence[Sampled]) -> bool:
    """Whether MOST_FAILURES or more are not accurate."""
    accurate = sum(one.verdict == "accurate" for one in outcomes)
    return len(outcomes) - accurate >= MOST_FAILURES * len(outcomes)


def write_sample(outcomes: Sequence[Sampled], out: Path) -> Path:
    """Every point with its values as CSV."""

    def number(x: float) -> float | None:
        return None if math.isnan(x) else x

    rows: list[dict[str, Any]] = [
        {
            "number": one.point.number,
            "verdict": one.verdict,
            "error": number(one.error),
            "output": one.output,
            "energy": number(one.energy),
            "stop_time": number(one.end),
            "steps": one.steps,
            "evaluations": one.evaluations,
            "seconds": round(one.seconds, 6),
            "message": one.message,
            **one.point.values,
        }
        for one in outcomes
    ]
    return write_rows(rows, out)


def print_sample(
    console: Console, outcomes: Sequence[Sampled], settings: SampleSettings, seed: int
) -> None:
    """Counts, the largest errors and work, and every point that is not accurate."""
    count = Counter(one.verdict for one in outcomes)
    said = ", ".join(f"{n} {verdict}" for verdict, n in count.most_common())
    console.print(
        f"[bold]{settings.system}[/], {len(outcomes)} points, seed {seed}, {settings.method} at "
        f"{plain(settings.tolerance)}, {plain(settings.times)} characteristic times: {said}",
        soft_wrap=True,
    )
    judged = [one for one in outcomes if not math.isnan(one.error)]
    if judged:
        errors = sorted(one.error for one in judged)
        worst = max(judged, key=lambda one: one.error)
        console.print(
            f"relative error: median {plain(errors[len(errors) // 2], 2)}, 99 % below "
            f"{plain(errors[int(0.99 * len(errors))], 2)}, largest {plain(worst.error, 2)} "
            f"(point {worst.point.number}, {worst.output}); allowed {plain(ALLOWED)}",
            soft_wrap=True,
        )
        most = max(judged, key=lambda one: one.evaluations)
        console.print(
            f"work: median {sorted(o.evaluations for o in judged)[len(judged) // 2]} evaluations, "
            f"most {most.evaluations} (point {most.point.number}); slowest run "
            f"{quantity(max(one.seconds for one in outcomes), 's', 2)}",
            soft_wrap=True,
        )
    for one in outcomes:
        if one.verdict != "accurate":
            detail = one.message or f"error {plain(one.error, 2)} of {one.output}"
            console.print(f"{one.verdict}: point {one.point.number}: {detail}", soft_wrap=True)
    if _too_many(outcomes):
        console.print(
            f"{MOST_FAILURES:.0%} or more of the points are not accurate. If these are motions "
            "that nobody wants (singular, say), declare other `ranges` in fmu.py.",
            soft_wrap=True,
        )

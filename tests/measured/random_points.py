"""Random points and random motions that are hard: what became of them, and the extreme ones again.

Thousands of runs are no test: a test runs anew the points that the figures name, the least accurate
one and the dearest one of each sample.
"""

from __future__ import annotations

import sys
from collections import Counter
from pathlib import Path
from typing import Any

sys.path.insert(0, str(Path(__file__).parents[1] / "stability"))

from campaign import Outcome, campaign

from curvebound.study.stability.ranges import draw, systems
from curvebound.study.stability.sample import Sampled, SampleSettings, run_points, run_sample

__all__ = ["COUNT", "motions", "motions_again", "points", "points_again"]

Data = dict[str, Any]
COUNT = 2000
SEEDS = (1, 2)
PLANTS = ("bead", "pendulum")


def points(count: int = COUNT) -> Data:
    """`curvebound sample` of the shipped systems, with `adaptive` at its tolerance of 1e-8."""
    found = []
    for system in systems():
        for seed in SEEDS:
            outcomes = run_sample(SampleSettings(system), count, seed)
            judged = [one for one in outcomes if one.error == one.error]
            worst = max(judged, key=lambda one: one.error)
            most = max(judged, key=lambda one: one.evaluations)
            found.append(
                {
                    "system": system,
                    "seed": seed,
                    "verdicts": dict(Counter(one.verdict for one in outcomes)),
                    "worst": _point(worst),
                    "most": _point(most),
                }
            )
    return {"points": count, "samples": found}


def points_again(stated: Data) -> Data:
    """The extreme points that `points` has found, run anew."""
    found = []
    for sample in stated["samples"]:
        numbers = [sample[which]["point"] for which in ("worst", "most")]
        drawn = draw(sample["system"], max(numbers) + 1, sample["seed"])
        settings = SampleSettings(sample["system"])
        worst, most = run_points(settings, [drawn[number] for number in numbers])
        found.append({**sample, "worst": _point(worst), "most": _point(most)})
    return {**stated, "samples": found}


def _point(one: Sampled) -> Data:
    return {
        "point": one.point.number,
        "verdict": one.verdict,
        "error": one.error,
        "evaluations": one.evaluations,
    }


def motions(count: int = COUNT) -> Data:
    """`tests/stability/campaign.py` of both plants, with and without hints of the model."""
    found = [
        one for plant in PLANTS for one in both(plant, campaign(plant, count, SEEDS[0]))
    ]  # fmt: skip
    return {"points": count, "seed": SEEDS[0], "campaigns": found}


def both(plant: str, outcomes: list[Outcome]) -> list[Data]:
    """A campaign summed up, with hints and without."""
    found = []
    for hints in (True, False):
        some = [one for one in outcomes if one.hints == hints]
        most = max(range(len(some)), key=lambda i: some[i].steps)
        found.append(
            {
                "plant": plant,
                "hints": hints,
                "verdicts": dict(Counter(one.verdict for one in some)),
                "warned": sum(one.warned for one in some),
                "needless": sum(one.needless for one in some),
                "most": _motion(most, some[most]),
            }
        )
    return found


def motions_again(stated: Data) -> Data:
    """The dearest motions that `motions` has found, run anew."""
    found = []
    for one in stated["campaigns"]:
        number = one["most"]["point"]
        (outcome,) = campaign(one["plant"], 1, stated["seed"], number, (one["hints"],))
        found.append({**one, "most": _motion(number, outcome)})
    return {**stated, "campaigns": found}


def _motion(number: int, one: Outcome) -> Data:
    return {"point": number, "verdict": one.verdict, "steps": one.steps}

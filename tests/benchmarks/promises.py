"""Whether tuning keeps its promises: bounds met on starts it never saw, at nearly the least cost.

For each scene and bound the choice is run from fresh starts within the range that it was tuned for,
and its cost is set against the cheapest setting of the whole grid that meets the bound at the
scene's own start and, like the choice, at 95 % of the fresh ones; both are timed in turn. A start
counts as judged where the reference is 100 times surer than the bound for at least a tenth of the
run; the time up to which it is, is stated.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable
from dataclasses import dataclass, replace
from typing import Any

from curvebound.cosim import load_scene
from curvebound.study.grid import Family, couplings, divisions, tolerances
from curvebound.study.reference.reference_set import ReferenceSet
from curvebound.study.settings import Setting, study_outputs
from curvebound.study.starts import unseen
from curvebound.study.timing import interleave, median
from curvebound.study.tune.candidate import Candidate, Choice
from curvebound.study.tune.ensemble import Ensemble
from curvebound.study.tune.tuner import Tuner

__all__ = ["BOUNDS", "MOST", "Case", "broken", "verify_scene"]

BOUNDS = (1e-2, 1e-4, 1e-6, 1e-9)
SHARE = 0.95  # of the fresh starts at which a bound is to be met
MOST = 1.5  # cost over that of the grid's best
_FINER = (1, 2, 5, 10)  # macro steps of the grid where law and inputs act all the time
_TIMED = 3  # of the grid's cheapest that are timed against the choice


@dataclass
class Case:
    """One scene at one bound.

    met: fresh starts at which the bound was met, of `judged`, of `fresh` that were run.
    worst: largest error over its bound; until: time (s) up to which all starts are judged.
    ratio: cost over that of the grid's best, None where the grid has none.
    """

    scene: str
    bound: float
    setting: str
    met: int
    judged: int
    fresh: int
    worst: float
    cpu: float
    best: str
    best_cpu: float | None
    ratio: float | None
    until: float
    stop: float
    runs: int
    sure: bool = True
    advice: str = ""

    def as_row(self) -> dict[str, Any]:
        """As plain data."""
        return dict(vars(self))

    @property
    def remark(self) -> str:
        """What the numbers do not say, in words."""
        words = []
        if not self.sure:
            words.append("met at the starts tried, not expected of every other")
        if self.setting == "none":
            words.append(f"nothing fits; {self.advice}" if self.advice else "nothing fits")
            words.append(f"the grid has {self.best}" if self.best != "none" else "nor in the grid")
        if self.judged < self.fresh:
            words.append(f"{self.fresh - self.judged} starts not judged")
        if self.until < self.stop * (1.0 - 1e-9):
            words.append(f"judged up to {self.until:.3g} s of {self.stop:g} s")
        return "; ".join(words)


def verify_scene(
    name: str,
    bounds: Iterable[float] = BOUNDS,
    *,
    fresh: int = 20,
    quick: bool = False,
    limit: float = 2.0,
    continuous: bool = False,
    progress: Callable[[str], None] | None = None,
) -> list[Case]:
    """The cases of one scene. quick: a thinner grid; limit: CPU seconds of one run.

    continuous: laws and inputs act all the time, macro step, algorithm and hold are chosen too.
    """
    tell = progress or (lambda _: None)
    scene = load_scene(name)
    paths = study_outputs(scene, scene.check())
    tuner = Tuner(scene, paths, limit=limit, continuous=continuous)
    try:
        starts = unseen(tuner.system, 0.2, fresh)
        checks = ReferenceSet(
            tuner.system, tuner.space.best_model, paths, changes=starts, continuous=continuous
        )
        tell(f"{name}: reference of {fresh} fresh starts")
        _ = checks.reference
        chosen = []
        for bound in bounds:
            tell(f"{name}: {bound:g}: tuning")
            chosen.append((bound, tuner.tune(dict.fromkeys(paths, bound))))
        tell(f"{name}: the grid")
        grid = _Grid(tuner, checks, starts, fresh, quick, _ceiling(c for _, c in chosen))
        cases = []
        for bound, choice in chosen:
            tell(f"{name}: {bound:g}: fresh starts")
            cases.append(grid.case(name, bound, dict.fromkeys(paths, bound), choice))
        return cases
    finally:
        tuner.close()


def broken(cases: Iterable[Case]) -> list[str]:
    """The promises that the cases of one scene do not keep, in words.

    What the tuner is not sure of counts as much: users take it like any other choice.
    """
    cases = list(cases)
    found = []
    if sum(c.met for c in cases) < SHARE * sum(c.judged for c in cases):
        found.append(f"{cases[0].scene}: bounds met at fewer than {SHARE:.0%} of the starts")
    for case in cases:
        label = f"{case.scene}, {case.bound:.0e}"
        if case.ratio is not None and case.ratio > MOST:
            found.append(f"{label}: {case.ratio:.2f} times the cost of {case.best}")
        if case.setting == "none" and case.best != "none":
            found.append(f"{label}: found nothing, and the grid has {case.best}")
    return found


def _ceiling(choices: Iterable[Choice]) -> float:
    """Cost (CPU s per s) beyond which no setting of the grid can undercut a choice."""
    return max((3.0 * c.chosen.cpu if c.chosen else math.inf for c in choices), default=math.inf)


class _Grid:
    """All settings of the grid, run once from the scene's own start.

    At the tuner's macro step; where that is chosen, at finer ones and with all couplings too.
    """

    def __init__(
        self,
        tuner: Tuner,
        checks: ReferenceSet,
        starts: dict[str, Any],
        fresh: int,
        quick: bool,
        ceiling: float,
    ) -> None:
        self.tuner = tuner
        self.fresh = fresh
        self.known: list[tuple[Setting, dict[str, float], float]] = []
        for family in self._families(quick):
            before: tuple[Setting, float] | None = None
            for setting in family.settings:
                if before is not None and (
                    self._expected(before, setting) > tuner.limit or before[1] > ceiling
                ):
                    break
                outcome = tuner.runner.glance(setting)
                before = (setting, outcome.cpu)
                if outcome.failure or len(outcome.times) < 2:
                    continue
                verdicts = tuner.references.errors(outcome.times, outcome.outputs, member=0)
                errors = {path: v.worst for path, v in verdicts.items()}
                self.known.append((setting, errors, outcome.cpu))
        self._unseen = Ensemble(tuner.runner, checks, starts)
        self._tried: dict[tuple[str, float, int], Candidate] = {}

    def _families(self, quick: bool) -> list[Family]:
        scene, space = self.tuner.scene, self.tuner.space
        every = [((scene.algorithm, scene.hold), self.tuner.step)]
        if self.tuner.continuous:
            pairs = couplings(scene, space)
            every = [(pair, self.tuner.step / n) for pair in pairs for n in _FINER]
        families = []
        for pair, step in every:
            for family in space.families(step, *pair):
                if family.method == "exact":
                    families.append(Family("micro", (family,)))
                    continue
                sizes = tolerances(quick) if family.by_tolerance else []
                sizes = sizes or [step / n for n in divisions(quick)]
                families.append(Family("micro", tuple(family.with_size(s) for s in sizes)))
        return families

    def _expected(self, before: tuple[Setting, float], setting: Setting) -> float:
        """CPU seconds that a run is expected to take."""
        last, cpu = before
        if setting.by_tolerance or not setting.size or not last.size:
            return cpu * self.tuner.span
        return cpu * self.tuner.span * last.size / setting.size

    def misses(self, setting: Setting, limits: dict[str, float]) -> list[Candidate]:
        """What a setting comes to at each fresh start."""
        return [self._miss(setting, limits, member) for member in range(self.fresh)]

    def _miss(self, setting: Setting, limits: dict[str, float], member: int) -> Candidate:
        key = (setting.key, next(iter(limits.values())), member)
        if key not in self._tried:
            self._tried[key] = self._unseen.one(setting, limits, member)
        return self._tried[key]

    def _cheapest(self, limits: dict[str, float], cpu: float) -> list[Setting]:
        """The grid's cheapest settings that meet the bounds, by a first timing."""
        good = [
            (spent, setting)
            for setting, errors, spent in self.known
            if all(errors[path] <= bound for path, bound in limits.items())
        ]
        found: list[Setting] = []
        for spent, setting in sorted(good, key=lambda pair: pair[0]):
            if len(found) >= _TIMED or spent > (2.0 if found else 4.0) * cpu:
                break  # nothing that follows is cheaper than the choice
            if self._holds(setting, limits):
                found.append(setting)
        return found

    def _holds(self, setting: Setting, limits: dict[str, float]) -> bool:
        """Whether a setting meets the bounds at enough fresh starts; tries no more than it must."""
        failed = 0
        for member in range(self.fresh):
            miss = self._miss(setting, limits, member)
            failed += _judged(miss) and not miss.fits
            if failed > (1.0 - SHARE) * self.fresh + 1e-9:
                return False
        return True

    def case(self, name: str, bound: float, limits: dict[str, float], choice: Choice) -> Case:
        """Judge one choice."""
        runner = self.tuner.runner
        cpu = choice.chosen.cpu if choice.chosen else math.inf
        rivals = self._cheapest(limits, cpu)
        settings = [*([choice.chosen.setting] if choice.chosen else []), *rivals]
        unique = list(dict.fromkeys(settings))
        probes = {s.key: (lambda s=s: runner.cost(s)) for s in unique}
        costs = {key: median(values) for key, values in interleave(probes, 5).items()}
        best = min(rivals, key=lambda s: costs[s.key], default=None)
        best_cpu = costs[best.key] if best else None
        case = Case(
            name, bound, "none", 0, 0, 0, choice.best.seen, math.inf,
            best.label if best else "none", best_cpu, None, choice.until,
            self.tuner.scene.stop_time, choice.runs, advice=choice.advice,
        )  # fmt: skip
        if choice.chosen is None:
            return case
        setting = choice.chosen.setting
        misses = self.misses(setting, limits)
        known = [m for m in misses if _judged(m)]
        return replace(
            case,
            setting=setting.label,
            met=sum(m.fits for m in known),
            judged=len(known),
            fresh=self.fresh,
            worst=max((m.miss for m in known), default=math.nan),
            cpu=costs[setting.key],
            ratio=costs[setting.key] / best_cpu if best_cpu else None,
            until=min((v.until for m in known for v in m.verdicts.values()), default=choice.until),
            sure=choice.sure,
        )


def _judged(miss: Candidate) -> bool:
    """Whether the reference can tell; that of a run that failed it can."""
    return all(v.judged for v in miss.verdicts.values())

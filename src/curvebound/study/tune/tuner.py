"""Tuning: the cheapest setting that meets a scene's needs, found with few runs.

Each family (structure and method) is followed along its error law: error ~ size^order in the micro
step, ~ tolerance for `adaptive`. One or two runs tell where the bound is met; families that cannot
be among the cheapest are dropped as soon as that is seen. What is left is refined on an ensemble of
starts around the scene's own, so that the choice holds for neighbours too, and timed in turn.

Where the coupling is to be chosen, the longest macro step that does with an integration as good as
exact comes first, then the families at it, and at cheaper ones where their errors cancel.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping
from dataclasses import replace
from typing import TYPE_CHECKING

import numpy as np

from ...errors import CurveboundError
from ...numbers import quantity
from ..grid import has_periods, is_sampled
from ..reference.reference_set import MARGIN, ReferenceSet
from ..runner import Runner
from ..settings import Setting, Space, space_of
from ..starts import surrounding
from ..timing import interleave, median
from .balance import balanced
from .candidate import Candidate, Choice
from .ensemble import Ensemble
from .macro_search import UNSURE, MacroSearch, order
from .step_search import AIM, coarser, search_size

if TYPE_CHECKING:
    from ...cosim.scene import Scene
    from ...cosim.system import System

__all__ = ["Tuner"]

_MOST = 1e7  # communication steps of a run
_DEARER = 1.4  # times the cost of a setting that met the bounds by far wherever it was run
_ALL = 4  # families that are refined and timed in turn


class Tuner:
    """Finds the cheapest setting of one scene for any bounds; references and FMUs are kept.

    continuous: judge control laws and inputs as acting all the time, as a scene whose hold is first
        always is: then the macro step, the algorithm and the hold are chosen too.
    frame_rate: pictures per simulated second that must be recorded, else the scene's need, else
        its macro step.
    limit: CPU seconds that one run may take; spread: relative range of starts that the choice is to
        hold for; keep: enumeration values by path that stay as given.
    """

    def __init__(
        self,
        scene: Scene,
        paths: list[str],
        *,
        continuous: bool = False,
        frame_rate: float | None = None,
        limit: float = 5.0,
        spread: float = 0.2,
        starts: int = 12,
        keep: Mapping[str, str] | None = None,
    ) -> None:
        self.scene = scene
        self.system: System = scene.check()
        self.space: Space = space_of(self.system, keep)
        self.paths = paths
        self.continuous = continuous or scene.hold == "first"
        self.limit = limit
        self.span = scene.stop_time - scene.start_time
        self.sampled = is_sampled(scene, self.space)
        rate = scene.needs.frame_rate if frame_rate is None else frame_rate
        if rate is not None and not 0.0 < rate < math.inf:
            raise CurveboundError(f"The frame rate is {rate} Hz; give a finite one above zero.")
        self.step = self._macro_step(rate)
        around = surrounding(self.system, spread, starts)
        self.references = ReferenceSet(
            self.system, self.space.best_model, paths, changes=around, continuous=continuous
        )
        self.runner = Runner(scene, self.space, paths)
        self.ensemble = Ensemble(self.runner, self.references, around)
        self.coupling = MacroSearch(
            scene,
            self.space,
            self.ensemble,
            step=self.step,
            # pictures, and the points at which laws sample, are communication points
            whole=self.step if rate is not None or has_periods(self.space) else self.span,
            sampled=self.sampled,
            dearest=limit / self.span,
        )

    def close(self) -> None:
        """Free the FMUs."""
        self.runner.__exit__(None, None, None)

    def _macro_step(self, rate: float | None) -> float:
        """The longest macro step that records often enough and changes nothing else."""
        wanted = 1.0 / rate if rate else self.scene.step
        if self.span / wanted > _MOST:
            raise CurveboundError(
                f"The frame rate is {rate} Hz, which makes {self.span / wanted:.3g} communication "
                f"steps of {self.span:g} s; give one of at most {_MOST / self.span:g} Hz."
            )
        if not self.sampled or self.continuous:
            return min(wanted, self.span)
        return self.scene.step

    def tune(
        self,
        bounds: Mapping[str, float],
        *,
        budget: float | None = None,
        progress: Callable[[str], None] | None = None,
    ) -> Choice:
        """Choose for error bounds by output path, and a budget in CPU seconds per simulated one."""
        tell = progress or (lambda _: None)
        before = self.ensemble.runs
        tell("reference")
        missing = [path for path in self.paths if not bounds.get(path, 0.0) > 0.0]
        if missing:
            raise CurveboundError(f"Give an error bound above zero for {', '.join(missing)}.")
        if budget is not None and not 0.0 < budget < math.inf:
            raise CurveboundError(f"The budget is {budget} s; give a finite one above zero.")
        _ = self.references.reference
        tried: list[Candidate] = []
        macro = self.coupling.given
        if self.continuous or not self.sampled:
            macro = self.coupling.search(bounds, tried, tell)
        finalists: list[Candidate] = []
        cheapest = math.inf
        dearest = self.limit / self.span
        for family in self._families(macro):
            tell(family.label)
            seen = search_size(
                family,
                lambda s: self.ensemble.one(s, bounds),
                min(2.0 * cheapest, dearest),
                floor=0.02,
            )
            tried += seen
            fitting = [c for c in seen if c.fits]
            if fitting:
                best = min(fitting, key=lambda c: c.cpu)
                finalists.append(best)
                cheapest = min(cheapest, best.cpu)
        if self.continuous and self.sampled:
            finalists += self._balanced(macro, bounds, min(cheapest, dearest), tried, tell)
        shortlist = self._refine(finalists, bounds, tried, tell)
        timed = self._time(shortlist, tell)
        within = [c for c in timed if budget is None or c.cpu <= budget]
        choice = self._decide(within or timed, tried, bounds)
        if budget is not None:
            self._keep_to(budget, choice, timed + tried)
        choice.runs = self.ensemble.runs - before
        return choice

    def _balanced(
        self,
        macro: Setting,
        bounds: Mapping[str, float],
        cheapest: float,
        tried: list[Candidate],
        tell: Callable[[str], None],
    ) -> list[Candidate]:
        """What fits at cheaper macro steps, where errors of coupling and of integration cancel."""
        finalists: list[Candidate] = []
        for steps in self.coupling.cheaper(macro, tried):
            for other in steps:
                tell(f"{other.coupling}, macro step {quantity(other.step, 's', 2)}: balance")
                # what a simpler model is off by follows no order of the micro step
                families = [
                    family
                    for family in self._families(other)
                    if self.space.is_simpler or not self.space.is_approximate(family)
                ]
                seen = balanced(self.ensemble, other, families, bounds, UNSURE * cheapest)
                tried += seen
                found = self._that_hold(seen, bounds, UNSURE * cheapest, tried)
                finalists += found
                if found and found[0].cpu < cheapest:
                    cheapest = found[0].cpu
                    break  # shorter ones cost more
        return finalists

    def _that_hold(
        self,
        seen: list[Candidate],
        bounds: Mapping[str, float],
        most: float,
        tried: list[Candidate],
    ) -> list[Candidate]:
        """Those that meet the bounds at all starts and cost less than `most` (s per s)."""
        found = []
        for candidate in sorted(seen, key=lambda c: c.cpu):
            if candidate.fits and candidate.cpu < most:
                everywhere = self.ensemble.all(candidate.setting, bounds)
                tried.append(everywhere)
                if everywhere.fits:
                    found.append(candidate)
        return found

    def _families(self, macro: Setting) -> list[Setting]:
        """Families in the order in which they are likely to be cheap: high order first."""
        rank = {"exact": 0, "rk4": 1, "adaptive": 2, "implicit": 3, "semi_implicit_euler": 4}
        families = self.space.families(macro.step, macro.algorithm, macro.hold)
        return sorted(families, key=lambda f: rank.get(f.method, 9))

    def _refine(
        self,
        finalists: list[Candidate],
        bounds: Mapping[str, float],
        tried: list[Candidate],
        tell: Callable[[str], None],
    ) -> list[Candidate]:
        """The cheapest families on the whole ensemble, until _ALL of them fit or none is left.

        Where none fits, or only at _DEARER times the cost, those that met them wherever they were
        run: the errors of a chaotic motion spread over so many orders that more can hardly
        be asked of any.
        """
        fitting: list[Candidate] = []
        likely: list[Candidate] = []
        members = self.ensemble.members
        least = min((c.cpu for c in finalists), default=1.0)
        # among equals, the clearly more accurate first
        ranked = sorted(
            finalists,
            key=lambda c: (int(math.log(c.cpu / least, UNSURE)), _level(c.miss), c.cpu),
        )
        for finalist in ranked:
            if len(fitting) >= _ALL or (fitting and finalist.cpu > 1.6 * fitting[0].cpu):
                break
            tell(f"{finalist.setting.label}: {members} starts")
            give_up = 4.0 * min((c.cpu for c in fitting or likely), default=math.inf)
            seen = search_size(
                finalist.setting.family,
                lambda s: self.ensemble.all(s, bounds),
                min(give_up, self.limit / self.span),
                first=finalist.setting,
                floor=0.1,
            )
            tried += seen
            good = [c for c in seen if c.fits]
            if good:
                fitting.append(min(good, key=lambda c: (round(c.cpu, 7), c.miss)))
            met = [c for c in seen if c.starts == members and c.seen <= 1.0]
            if met:
                likely.append(min(met, key=lambda c: c.seen))
        safe = [c for c in likely if c.seen <= AIM]
        least = min((c.cpu for c in safe), default=math.inf)
        sure = [c for c in fitting if c.cpu <= _DEARER * least]
        return sure or sorted(safe or likely, key=lambda c: c.cpu)[:_ALL]

    def _time(self, found: list[Candidate], tell: Callable[[str], None]) -> list[Candidate]:
        """Costs of the candidates, taken in turn: a slow moment falls on all alike."""
        if not found:
            return []
        tell("timing")
        probes = {str(i): (lambda c=c: self.runner.cost(c.setting)) for i, c in enumerate(found)}
        samples = interleave(probes, 3)
        return [replace(c, cpu=median(samples[str(i)])) for i, c in enumerate(found)]

    def _decide(
        self, timed: list[Candidate], tried: list[Candidate], bounds: Mapping[str, float]
    ) -> Choice:
        until = self._until(bounds)
        if not timed:
            # at more starts than the scene's own, if any was tried there
            alone = 0 if self.ensemble.members == 1 else 1
            best = min(tried, key=lambda c: (c.seen == math.inf, c.starts == alone, c.seen))
            return Choice(None, best, None, until, 0, advice=self._advice(best, tried))
        least = min(c.cpu for c in timed)
        # nearly the same cost: then the clearly more accurate
        near = [c for c in timed if c.cpu <= 1.2 * least]
        accurate = min(c.miss for c in near)
        chosen = min((c for c in near if c.miss <= 1.2 * accurate), key=lambda c: c.cpu)
        cheaper = self._cheaper(chosen, tried, bounds)
        return Choice(chosen, chosen, cheaper, until, 0, sure=chosen.fits)

    def _cheaper(
        self, chosen: Candidate, tried: list[Candidate], bounds: Mapping[str, float]
    ) -> Candidate | None:
        """The next cheaper candidate: the same family one notch coarser, or another that failed."""

        def misses(c: Candidate) -> float:
            # like is compared with like: a choice that is not sure was judged by what was seen
            return c.miss if chosen.fits else c.seen

        setting = coarser(chosen.setting)
        if setting is not None:
            tried_coarser = self.ensemble.all(setting, bounds)
            cpu = self.runner.cost(setting)
            if misses(tried_coarser) > 1.0 and cpu < chosen.cpu:
                return replace(tried_coarser, cpu=cpu, miss=misses(tried_coarser))
        others = [
            replace(c, miss=misses(c)) for c in tried
            if c.cpu < 0.9 * chosen.cpu and 1.0 < misses(c) < math.inf
        ]  # fmt: skip
        return max(others, key=lambda c: c.cpu, default=None)

    def _until(self, bounds: Mapping[str, float]) -> float:
        """Time up to which the reference can tell whether the bounds are met, for all starts."""
        reference = self.references.reference
        times = np.linspace(self.scene.start_time, self.scene.stop_time, 401)
        until = self.scene.stop_time
        for path in self.paths:
            doubt = reference.uncertainty(path, times).max(axis=1)
            unsure = np.flatnonzero(MARGIN * doubt > bounds[path])
            if len(unsure):
                until = min(until, float(times[max(0, unsure[0] - 1)]))
        return until

    def _advice(self, best: Candidate, tried: list[Candidate]) -> str:
        """What would fit, where nothing does."""
        words = []
        setting = best.setting
        if self.sampled and self.continuous and best.seen < math.inf:
            finer = setting.step / (best.seen / AIM) ** (1.0 / order(setting))
            cpu = best.cpu * setting.step / finer
            words.append(
                f"the macro step costs accuracy of order {order(setting):.0f}: one of about "
                f"{quantity(finer, 's', 2)} would do, at about {quantity(cpu, 's', 2)} of CPU time "
                "per simulated second"
            )
        finite = [c for c in tried if c.miss < math.inf and c.setting.size]
        if finite and best.seen < 1e6 and not (self.sampled and self.continuous):
            words.append(f"bounds {_round_up(best.seen):g} times as wide would be met")
        if best.cpu * self.span > 0.3 * self.limit:
            words.append(f"runs of more than {self.limit:g} s were not tried: raise --limit")
        if best.failure:
            words.append(best.failure)
        return "; ".join(words)

    def _keep_to(self, budget: float, choice: Choice, every: list[Candidate]) -> None:
        if choice.chosen is None or choice.chosen.cpu <= budget:
            return
        choice.within_budget = False
        members = self.ensemble.members
        known = [c for c in every if c.starts == members and c.miss < math.inf]
        affordable = [c for c in known if c.cpu <= budget]
        choice.affordable = min(affordable, key=lambda c: c.miss, default=None)


def _level(miss: float) -> int:
    """A number that errors have in common which differ by less than about a half."""
    return round(math.log(max(miss, 1e-300), 1.5))


def _round_up(x: float) -> float:
    digits = 10.0 ** (math.floor(math.log10(x)) - 1)
    return math.ceil(x / digits) * digits

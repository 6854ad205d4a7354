"""Tuning: the cheapest setting that meets a scene's needs, found with few runs.

Each family (structure and method) is followed along its error law: error ~ size^order in the micro
step, ~ tolerance for `adaptive`. One or two runs tell where the bound is met; families that cannot
be among the cheapest are dropped as soon as that is seen. What is left is refined on an ensemble of
starts around the scene's own, so that the choice holds for neighbours too, and timed in turn.
"""

from __future__ import annotations

import math
import statistics
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field, replace
from typing import TYPE_CHECKING, Any

import numpy as np

from ..bench.timing import interleave, median
from ..errors import CurveboundError
from .grid import algorithms, is_sampled
from .judge import Verdict
from .runner import Runner
from .settings import Setting, Space, space_of
from .starts import surrounding
from .truth import Truths

if TYPE_CHECKING:
    from ..cosim.scene import Scene
    from ..cosim.system import System

__all__ = ["Candidate", "Choice", "Tuner"]

_ORDER = {"explicit_euler": 1.0, "semi_implicit_euler": 1.0, "rk4": 4.0, "implicit": 4.0}
_ALL = 4  # families that are refined and timed in turn
_AIM = 0.35  # share of the bound that is aimed at
_LOOSEST, _TIGHTEST = 1e-2, 1e-15  # tolerances
_FINEST = 200_000  # micro steps in a macro step
_EXTREME = 4  # starts that are run in any case: the scene's own and the first corners
_WIDEST = math.log(30.0)  # of what is expected over the worst that was seen
_HOPELESS = 30.0  # times the bound: beyond this a setting needs no more starts to be dropped


@dataclass
class Candidate:
    """A setting and what it came to: `miss` is the largest error over its bound, over all outputs
    (and, if `starts` > 1, over all starts, with what spread they show); `cpu` s per simulated s."""

    setting: Setting
    miss: float
    cpu: float
    starts: int = 1
    until: float = 0.0
    verdicts: dict[str, Verdict] = field(default_factory=dict)
    failure: str = ""

    @property
    def fits(self) -> bool:
        """Whether the bounds are met."""
        return self.miss <= 1.0


@dataclass
class Choice:
    """The outcome: `chosen` is None when nothing fits, and `best` then comes nearest.

    cheaper: the next cheaper candidate, which does not fit, if there is any.
    within_budget: whether `chosen` keeps to the scene's time budget; `affordable` is then the most
        accurate that does.
    until: time in s up to which the reference can judge the bounds.
    advice: what would fit, in words, where nothing does.
    """

    chosen: Candidate | None
    best: Candidate
    cheaper: Candidate | None
    until: float
    runs: int
    affordable: Candidate | None = None
    within_budget: bool = True
    advice: str = ""


class Tuner:
    """Finds the cheapest setting of one scene for any bounds; references and FMUs are kept.

    continuous: judge control laws and inputs as acting all the time: then the macro step and the
        algorithm are chosen too.
    frame_rate: pictures per simulated second that must be recorded, else the scene's need, else
        its macro step.
    limit: CPU seconds that one run may take; spread: relative range of starts that the choice is to
        hold for; keep: enumeration values by path that are not to be chosen.
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
        self.continuous = continuous
        self.limit = limit
        self.span = scene.stop_time - scene.start_time
        self.sampled = is_sampled(scene, self.space)
        rate = scene.needs.frame_rate if frame_rate is None else frame_rate
        if rate is not None and not 0.0 < rate < math.inf:
            raise CurveboundError(f"The frame rate is {rate} Hz; give a finite one above zero.")
        self.step = self._macro_step(rate)
        self.starts = surrounding(self.system, spread, starts)
        self.members = 1 + starts if self.starts else 1
        self.truths = Truths(
            self.system, self.space, paths, changes=self.starts, continuous=continuous
        )
        self.runner = Runner(scene, self.space, paths)
        self.runs = 0

    def close(self) -> None:
        """Free the FMUs."""
        self.runner.__exit__(None, None, None)

    def _macro_step(self, rate: float | None) -> float:
        """The longest macro step that records often enough and changes nothing else."""
        wanted = 1.0 / rate if rate else self.scene.step
        if not self.sampled or self.continuous:
            return min(wanted, self.span)
        return self.scene.step

    # evaluation

    def _evaluate(self, setting: Setting, bounds: Mapping[str, float], member: int) -> Candidate:
        start = {path: float(values[member]) for path, values in self.starts.items()}
        outcome = self.runner.glance(setting, start)
        self.runs += 1
        if outcome.failure or len(outcome.times) < 2:
            return Candidate(setting, math.inf, outcome.cpu, failure=outcome.failure)
        verdicts = self.truths.errors(outcome.times, outcome.outputs, member=member, least=bounds)
        miss = max(v.worst / bounds[path] for path, v in verdicts.items())
        until = min(v.until if v.judged else self.scene.start_time for v in verdicts.values())
        return Candidate(setting, miss, outcome.cpu, until=until, verdicts=verdicts)

    def evaluate(self, setting: Setting, bounds: Mapping[str, float]) -> Candidate:
        """A setting on the whole ensemble: the worst start, or what their spread leads to expect.

        The bound is one of prediction: errors are taken as log-normal over the starts, and the
        next one lies below it with a probability of 0.995 (Student's t), and within 30 times the
        worst seen: errors of a chaotic motion spread over many orders. Where the first starts,
        which are the extreme ones, miss by far, the others are spared.
        """
        every: list[Candidate] = []
        for member in range(self.members):
            every.append(self._evaluate(setting, bounds, member))
            if len(every) >= _EXTREME and max(c.miss for c in every) > _HOPELESS:
                break
        own = every[0]
        misses = [c.miss for c in every]
        miss = max(misses)
        if min(misses) > 0.0 and miss < math.inf and len(misses) == self.members > 2:
            logs = [math.log(m) for m in misses]
            n = len(logs)
            reach = _STUDENT.get(n - 1, 2.9) * statistics.stdev(logs) * math.sqrt(1.0 + 1.0 / n)
            expected = statistics.fmean(logs) + reach
            miss *= max(1.1, math.exp(min(expected - math.log(miss), _WIDEST)))
        until = min(c.until for c in every)
        failure = next((c.failure for c in every if c.failure), "")
        return replace(own, miss=miss, starts=len(every), until=until, failure=failure)

    # one family

    def _follow(
        self,
        family: Setting,
        evaluate: Callable[[Setting], Candidate],
        give_up: float,
        first: Setting | None = None,
        floor: float = 0.0,
    ) -> list[Candidate]:
        """Candidates of a family, ending near the coarsest that fits; all that were tried.

        give_up: cost (s per s) beyond which the family is of no interest.
        floor: share of the bound below which a coarser one is looked for, if it would be cheaper.
        """
        if family.method == "exact":
            return [evaluate(family)]
        setting = first or self._coarsest(family)
        tried: dict[float, Candidate] = {}
        for _ in range(7):
            assert setting.size is not None
            candidate = evaluate(setting)
            tried[setting.size] = candidate
            below = [c for c in tried.values() if c.fits]
            above = [c for c in tried.values() if not c.fits]
            if candidate.fits and (candidate.miss > floor or self._is_coarsest(setting)):
                break
            following = self._next(setting, tried)
            if following is None or following.size in tried:
                break
            assert following.size is not None
            # a finer one costs more in proportion: drop the family where that is too much
            ratio = setting.size / following.size if not setting.by_tolerance else 1.0
            if not candidate.fits and not below:
                macro = min((c.cpu for c in tried.values()), default=0.0)
                expected = macro if ratio <= 1.0 else self._expected(tried, following)
                if expected > give_up or expected * self.span > self.limit:
                    break
            if below and above and _near(below, above):
                break
            setting = following
        return list(tried.values())

    def _coarsest(self, family: Setting) -> Setting:
        return family.with_size(1e-3 if family.by_tolerance else family.step)

    def _is_coarsest(self, setting: Setting) -> bool:
        assert setting.size is not None
        limit = _LOOSEST if setting.by_tolerance else setting.step
        return setting.size >= limit * (1.0 - 1e-9)

    def _expected(self, tried: Mapping[float, Candidate], following: Setting) -> float:
        """Cost of a micro step, from what the tried ones cost: a + b / size."""
        assert following.size is not None
        sizes = sorted(tried)
        if len(sizes) < 2:
            only = tried[sizes[0]]
            return only.cpu + _STEP_COST / following.size
        fine, coarse = tried[sizes[0]], tried[sizes[-1]]
        slope = max((fine.cpu - coarse.cpu) / (1 / sizes[0] - 1 / sizes[-1]), 0.3 * _STEP_COST)
        return coarse.cpu + slope * (1 / following.size - 1 / sizes[-1])

    def _next(self, setting: Setting, tried: Mapping[float, Candidate]) -> Setting | None:
        """The size at which the bound should be met, by the error law through what was tried."""
        assert setting.size is not None
        here = tried[setting.size]
        order = 1.0 if setting.by_tolerance else _ORDER.get(setting.method, 2.0)
        miss = min(max(here.miss, 1e-12), 1e12) if here.miss < math.inf else 1e3
        fits = [s for s, c in tried.items() if c.fits]
        misses = [s for s, c in tried.items() if not c.fits]
        usable = sorted((s, c.miss) for s, c in tried.items() if 0.0 < c.miss < 1e6)
        if len(usable) >= 2:
            (a, at_a), (b, at_b) = usable[0], usable[1]
            measured = math.log(at_b / at_a) / math.log(b / a) if at_b > at_a else 0.0
            order = min(max(measured, 0.5 * order), 2.0 * order)
        size = setting.size * (_AIM / miss) ** (1.0 / order)
        if fits and misses and not max(fits) < size < min(misses):
            size = math.sqrt(max(fits) * min(misses))
        if setting.by_tolerance:
            size = min(max(size, _TIGHTEST), _LOOSEST)
            size = 10.0 ** (round(4.0 * math.log10(size)) / 4.0)
        else:
            divisions = math.ceil(setting.step / size - 1e-9)
            divisions = min(max(divisions, 1), _FINEST)
            size = setting.step / divisions
        return None if size == setting.size else setting.with_size(size)

    # the whole

    def tune(
        self,
        bounds: Mapping[str, float],
        *,
        budget: float | None = None,
        progress: Callable[[str], None] | None = None,
    ) -> Choice:
        """Choose for error bounds by output path, and a budget in CPU seconds per simulated one."""
        tell = progress or (lambda _: None)
        before = self.runs
        tell("reference")
        missing = [path for path in self.paths if not bounds.get(path, 0.0) > 0.0]
        if missing:
            raise CurveboundError(f"Give an error bound above zero for {', '.join(missing)}.")
        if budget is not None and not 0.0 < budget < math.inf:
            raise CurveboundError(f"The budget is {budget} s; give a finite one above zero.")
        _ = self.truths.reference
        tried: list[Candidate] = []
        macro = self._macro(bounds, tried, tell)
        fronts: list[Candidate] = []
        cheapest = math.inf
        for family in self._families(macro):
            tell(family.label)
            seen = self._follow(
                family, lambda s: self._evaluate(s, bounds, 0), 2.0 * cheapest, floor=0.02
            )
            tried += seen
            fitting = [c for c in seen if c.fits]
            if fitting:
                best = min(fitting, key=lambda c: c.cpu)
                fronts.append(best)
                cheapest = min(cheapest, best.cpu)
        shortlist = self._refine(fronts, bounds, tried, tell)
        timed = self._time([c for c in shortlist if c.fits], tell)
        choice = self._decide(timed, tried, bounds)
        if budget is not None:
            self._keep_to(budget, choice, timed + tried)
        choice.runs = self.runs - before
        return choice

    def _families(self, macro: Setting) -> list[Setting]:
        """Families in the order in which they are likely to be cheap: high order first."""
        rank = {"exact": 0, "rk4": 1, "adaptive": 2, "implicit": 3, "semi_implicit_euler": 4}
        families = self.space.families(macro.step, macro.algorithm)
        return sorted(families, key=lambda f: rank.get(f.method, 9))

    def _refine(
        self,
        fronts: list[Candidate],
        bounds: Mapping[str, float],
        tried: list[Candidate],
        tell: Callable[[str], None],
    ) -> list[Candidate]:
        """The cheapest families on the whole ensemble, until _ALL of them fit or none is left."""
        refined: list[Candidate] = []
        least = min((c.cpu for c in fronts), default=1.0)
        # first timings are not sure within 30 %: among equals, the more accurate first
        ranked = sorted(fronts, key=lambda c: (int(math.log(c.cpu / least, 1.3)), c.miss))
        for front in ranked:
            fitting = [c for c in refined if c.fits]
            if len(fitting) >= _ALL or (fitting and front.cpu > 1.6 * fitting[0].cpu):
                break
            tell(f"{front.setting.label}: {self.members} starts")
            give_up = 4.0 * min((c.cpu for c in fitting), default=math.inf)
            seen = self._follow(
                front.setting.family,
                lambda s: self.evaluate(s, bounds),
                give_up,
                first=front.setting,
                floor=0.1,
            )
            tried += seen
            good = [c for c in seen if c.fits]
            if good:
                refined.append(min(good, key=lambda c: (round(c.cpu, 7), c.miss)))
        return refined

    def _time(self, found: list[Candidate], tell: Callable[[str], None]) -> list[Candidate]:
        """Costs of the candidates, taken in turn so that the machine's moods fall on all alike."""
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
            whole = [c for c in tried if c.starts > 1 and c.miss < math.inf]
            best = min(whole or tried, key=lambda c: c.miss)
            return Choice(None, best, None, until, 0, advice=self._advice(best, tried))
        least = min(c.cpu for c in timed)
        # nearly the same cost: then the more accurate
        chosen = min((c for c in timed if c.cpu <= 1.2 * least), key=lambda c: c.miss)
        return Choice(chosen, chosen, self._cheaper(chosen, tried, bounds), until, 0)

    def _cheaper(
        self, chosen: Candidate, tried: list[Candidate], bounds: Mapping[str, float]
    ) -> Candidate | None:
        """The next cheaper candidate: the same family one notch coarser, or another that failed."""
        setting = chosen.setting
        coarser = None
        if setting.size is not None and not self._is_coarsest(setting):
            if setting.by_tolerance:
                size = min(10.0 * setting.size, _LOOSEST)
            else:
                n = round(setting.step / setting.size)
                size = setting.step / max(1, n - max(1, n // 4))
            coarser = self.evaluate(setting.with_size(size), bounds)
        others = [
            c for c in tried
            if not c.fits and c.cpu < 0.9 * chosen.cpu and 1.0 < c.miss < math.inf
        ]  # fmt: skip
        if coarser is not None and not coarser.fits:
            return replace(coarser, cpu=self.runner.cost(coarser.setting))
        return max(others, key=lambda c: c.cpu) if others else None

    def _until(self, bounds: Mapping[str, float]) -> float:
        """Time up to which the reference can tell whether the bounds are met, for all starts."""
        reference = self.truths.reference
        times = np.linspace(self.scene.start_time, self.scene.stop_time, 401)
        until = self.scene.stop_time
        for path in self.paths:
            doubt = reference.uncertainty(path, times).max(axis=1)
            unsure = np.flatnonzero(100.0 * doubt > bounds[path])
            if len(unsure):
                until = min(until, float(times[max(0, unsure[0] - 1)]))
        return until

    def _advice(self, best: Candidate, tried: list[Candidate]) -> str:
        """What would fit, where nothing does."""
        words = []
        setting = best.setting
        if self.sampled and self.continuous:
            finer = setting.step / (best.miss / _AIM)
            words.append(
                f"values held over the macro step cost accuracy of first order: a macro step of "
                f"about {finer:.1e} s would do, at about {best.cpu * setting.step / finer:.2g} s "
                "of CPU time per simulated second"
            )
        finite = [c for c in tried if c.miss < math.inf and c.setting.size]
        if finite and best.miss < 1e6 and not (self.sampled and self.continuous):
            words.append(f"bounds {_round_up(best.miss):g} times as wide would be met")
        if best.cpu * self.span > 0.3 * self.limit:
            words.append(f"runs of more than {self.limit:g} s were not tried: raise --limit")
        if best.failure:
            words.append(best.failure)
        return "; ".join(words)

    def _keep_to(self, budget: float, choice: Choice, every: list[Candidate]) -> None:
        if choice.chosen is None or choice.chosen.cpu <= budget:
            return
        choice.within_budget = False
        affordable = [c for c in every if c.cpu <= budget and c.miss < math.inf]
        choice.affordable = min(affordable, key=lambda c: c.miss, default=None)

    # macro step

    def _macro(
        self, bounds: Mapping[str, float], tried: list[Candidate], tell: Callable[[str], None]
    ) -> Setting:
        """Macro step and algorithm; a setting whose integration is as good as exact."""
        base = Setting(self.space.structures[0], "adaptive", 1e-11, self.step, self.scene.algorithm)
        if not (self.sampled and self.continuous):
            return base
        options: list[tuple[float, Setting]] = []
        for algorithm in algorithms(self.scene):
            setting = replace(base, algorithm=algorithm)
            order = 2.0 if algorithm == "strang" else 1.0
            for _ in range(5):
                tell(f"{algorithm}, macro step {setting.step:.2g} s")
                candidate = self._evaluate(setting, bounds, 0)
                tried.append(candidate)
                if candidate.miss <= 0.5:
                    options.append((candidate.cpu, setting))
                    break
                factor = (0.35 / min(candidate.miss, 1e6)) ** (1.0 / order)
                step = self.step / math.ceil(self.step / (setting.step * factor) - 1e-9)
                if candidate.cpu * setting.step / step * self.span > self.limit:
                    break
                setting = replace(setting, step=step)
        if options:
            return min(options, key=lambda o: o[0])[1]
        return replace(base, step=min(c.setting.step for c in tried))


#: one-sided 99.5 % points of Student's t distribution by degrees of freedom
_STUDENT = {
    2: 9.925, 3: 5.841, 4: 4.604, 5: 4.032, 6: 3.707, 7: 3.499, 8: 3.355, 9: 3.250, 10: 3.169,
    11: 3.106, 12: 3.055, 13: 3.012, 14: 2.977, 15: 2.947, 16: 2.921,
}  # fmt: skip

#: CPU seconds of a micro step times seconds, a first guess until one has been measured
_STEP_COST = 5e-8


def _near(below: list[Candidate], above: list[Candidate]) -> bool:
    """Whether the coarsest that fits and the finest that does not are next to each other."""
    a: Any = max(c.setting.size or 0.0 for c in below)
    b: Any = min(c.setting.size or math.inf for c in above)
    return bool(b / a < 1.3)


def _round_up(x: float) -> float:
    digits = 10.0 ** (math.floor(math.log10(x)) - 1)
    return math.ceil(x / digits) * digits

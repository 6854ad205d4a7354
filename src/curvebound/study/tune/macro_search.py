"""Macro step, algorithm and hold: how a scene's components are coupled, as cheaply as suffices."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import replace
from typing import TYPE_CHECKING

from ...cosim.scene_parts import ALGORITHMS
from ..grid import couplings
from ..settings import Setting, Space
from .balance import LARGEST
from .candidate import Candidate
from .ensemble import Ensemble

if TYPE_CHECKING:
    from ...cosim.scene import Scene

__all__ = ["UNSURE", "MacroSearch", "fraction", "order"]

UNSURE = 1.3  # times what a single timing says, within which it is trusted
_LONGER = 1.5  # times the macro step with values held, for which slopes are worth their cost
_TIMINGS = 2  # more of each coupling that fits, in turns
#: of the bounds, what coupling may take and what is aimed at: macro steps cost most, and what an
#: integration needs that adds little to its error costs less than shorter ones
_ROOM, _AIM = 0.9, 0.8
_NEAR = 1.15  # times a macro step that fits, up to which longer ones are not looked for
_BACK = 4.0  # times shorter, where a run fails and no law tells how much
_RUNS = 6  # that one coupling may take
_LESS = 0.8  # from one macro step to the next, where errors may cancel
_ROUND = 1.1  # times the steps that are necessary, for a round number
_DEARER = 4.0  # times the cheapest that fits, beyond which another is of no interest


class MacroSearch:
    """Looks for the coupling of one scene.

    step: the longest macro step in s; whole: time in s that all others divide; sampled: whether
        anything is held over a macro step; dearest: CPU seconds that a simulated one may take.
    """

    def __init__(
        self,
        scene: Scene,
        space: Space,
        ensemble: Ensemble,
        *,
        step: float,
        whole: float,
        sampled: bool,
        dearest: float,
    ) -> None:
        self.scene = scene
        self.space = space
        self.ensemble = ensemble
        self.step = step
        self.whole = whole
        self.sampled = sampled
        self.dearest = dearest

    @property
    def given(self) -> Setting:
        """The scene's own coupling, with an integration that is as good as exact."""
        scene = self.scene
        return Setting(
            self.space.structures[0], "adaptive", 1e-11, self.step, scene.algorithm, scene.hold
        )

    def search(
        self, bounds: Mapping[str, float], tried: list[Candidate], tell: Callable[[str], None]
    ) -> Setting:
        """The cheapest that leaves room for integration, which is as good as exact, in the bounds.

        Adds what it has tried to `tried`.
        """
        base = self.given
        options: list[Candidate] = []
        every: list[Candidate] = []
        for algorithm, hold in self._couplings():
            setting = replace(base, algorithm=algorithm, hold=hold)
            tell(f"{setting.coupling}, macro step")
            most = _DEARER * min((c.cpu for c in options), default=math.inf)
            found = self._longest(setting, lambda s: self.ensemble.one(s, bounds), most)
            every += found
            options += _fitting(found)[-1:]
        tried += every
        # slopes cost something, and timings differ by chance: only where they allow longer steps
        held = {c.setting.algorithm: c.setting.step for c in options if c.setting.hold == "zero"}
        options = [
            c
            for c in options
            if c.setting.hold == "zero"
            or c.setting.step > _LONGER * held.get(c.setting.algorithm, 0.0)
        ]
        if options:
            chosen = self._cheapest(options, bounds)
            if not self.sampled:
                return chosen
            # other starts may need a shorter one
            found = self._longest(chosen, lambda s: self.ensemble.all(s, bounds))
            tried += found
            return _fitting(found)[-1].setting if _fitting(found) else found[-1].setting
        return min(every, key=lambda c: c.miss).setting if every else base

    def cheaper(self, found: Setting, tried: Sequence[Candidate]) -> Iterator[list[Setting]]:
        """Of each coupling, macro steps that cost less than the one found, from long to short.

        Integration is as good as exact. tried: candidates that tell what a macro step costs.
        """
        base = self.given
        costs: dict[str, float] = {}
        for c in tried:
            if c.setting.method == base.method and c.setting.size == base.size:
                known = costs.get(c.setting.coupling, math.inf)
                costs[c.setting.coupling] = min(known, c.cpu * c.setting.step)
        for algorithm, hold in self._couplings():
            setting = replace(base, algorithm=algorithm, hold=hold)
            dear = costs.get(setting.coupling, math.inf) / costs[found.coupling]
            least = max(dear / UNSURE, _NEAR if setting.coupling == found.coupling else 0.0)
            least *= found.step
            step = min(found.step * LARGEST ** (1.0 / order(setting)), self.step)
            steps = []
            while step > least:
                steps.append(fraction(self.whole, step))
                step *= _LESS
            yield [replace(setting, step=s) for s in dict.fromkeys(steps) if s > least]

    def _cheapest(self, options: Sequence[Candidate], bounds: Mapping[str, float]) -> Setting:
        """By the least of several timings of each, for one may be off by chance."""
        least = [c.cpu for c in options]
        for _ in range(_TIMINGS if len(options) > 1 else 0):
            for k, candidate in enumerate(options):
                least[k] = min(least[k], self.ensemble.one(candidate.setting, bounds).cpu)
        return options[least.index(min(least))].setting

    def _longest(
        self, setting: Setting, evaluate: Callable[[Setting], Candidate], most: float = math.inf
    ) -> list[Candidate]:
        """Candidates on the way to nearly the longest macro step that leaves room.

        most: cost (s per s) beyond which they are of no interest.
        """
        tried: list[Candidate] = []
        for _ in range(_RUNS if self.sampled else 1):
            tried.append(evaluate(setting))
            step = self._next(tried, most)
            if step is None:
                break
            setting = replace(setting, step=step)
        return tried

    def _next(self, tried: Sequence[Candidate], most: float) -> float | None:
        """The macro step to try; None where one fits nearly, or the next would cost too much."""
        last = tried[-1]
        step = last.setting.step
        fits = max((c.setting.step for c in _fitting(tried)), default=0.0)
        misses = [c for c in tried if c.miss > _ROOM]
        fails = min((c.setting.step for c in misses), default=math.inf)
        if last.miss < math.inf:
            wanted = step * (_AIM / max(last.miss, 1e-12)) ** (1.0 / order(last.setting))
        else:
            wanted = step / _BACK
        broken = any(c.miss == math.inf and c.setting.step == fails for c in misses)
        if fits > 0.0 and (wanted >= fails or (broken and fails > _NEAR**2 * fits)):
            wanted = math.sqrt(fits * fails)
        wanted = fraction(self.whole, min(wanted, self.step))
        if wanted <= _NEAR * fits or wanted == step:
            return None
        return wanted if last.cpu * step / wanted <= min(most, self.dearest) else None

    def _couplings(self) -> list[tuple[str, str]]:
        """Algorithms and holds to choose from."""
        found = couplings(self.scene, self.space)
        if self.sampled:
            return found
        # of plants alone the algorithm stays
        found = [pair for pair in found if pair[0] == self.scene.algorithm]
        return found if len(found) > 1 else []


def _fitting(tried: Sequence[Candidate]) -> list[Candidate]:
    """Those that leave room, by macro step."""
    return sorted((c for c in tried if c.miss <= _ROOM), key=lambda c: c.setting.step)


def fraction(whole: float, longest: float) -> float:
    """A macro step up to `longest` that divides a time: a round one where that costs little."""
    count = math.ceil(whole / longest - 1e-9)
    exponent = math.floor(math.log10(longest)) - 1
    for digits in range(round(longest / 10.0**exponent), 9, -1):
        step = float(f"{digits}e{exponent}")
        multiple = whole / step
        if multiple > _ROUND * count:
            break
        if step <= longest * (1.0 + 1e-9) and abs(multiple - round(multiple)) < 1e-9 * multiple:
            return step
    return whole / count


def order(setting: Setting) -> float:
    """The order of coupling's error in the macro step."""
    return 2.0 if setting.hold == "first" else float(ALGORITHMS[setting.algorithm].order)

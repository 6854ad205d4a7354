"""Macro step, algorithm and hold: how a scene's components are coupled, as cheaply as suffices."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import replace
from typing import TYPE_CHECKING

from ...cosim.scene_parts import ALGORITHMS
from ..grid import couplings
from ..settings import Setting, Space
from .candidate import Candidate
from .ensemble import Ensemble
from .step_search import AIM

if TYPE_CHECKING:
    from ...cosim.scene import Scene

__all__ = ["MacroSearch", "order"]

_LONGER = 1.5  # times the macro step with values held, for which slopes are worth their cost
_TIMINGS = 2  # more of each coupling that fits, in turns
_ROOM = 0.5  # of the bounds that coupling may take, the rest is for integration


class MacroSearch:
    """Looks for the coupling of one scene.

    step: the longest macro step in s; sampled: whether anything is held over it; dearest: CPU
    seconds that a simulated one may take.
    """

    def __init__(
        self,
        scene: Scene,
        space: Space,
        ensemble: Ensemble,
        *,
        step: float,
        sampled: bool,
        dearest: float,
    ) -> None:
        self.scene = scene
        self.space = space
        self.ensemble = ensemble
        self.step = step
        self.sampled = sampled
        self.dearest = dearest

    @property
    def given(self) -> Setting:
        """The scene's own; a setting whose integration is as good as exact."""
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
            for _ in range(5 if self.sampled else 1):
                tell(f"{setting.coupling}, macro step {setting.step:.2g} s")
                candidate = self.ensemble.one(setting, bounds)
                every.append(candidate)
                if candidate.miss <= _ROOM:
                    options.append(candidate)
                    break
                finer = self._finer(candidate)
                if finer is None:
                    break
                setting = finer
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
            return self._for_all_starts(self._cheapest(options, bounds), bounds, tried)
        if self.sampled:
            return replace(base, step=min(c.setting.step for c in every))
        return min(every, key=lambda c: c.miss).setting if every else base

    def _cheapest(self, options: Sequence[Candidate], bounds: Mapping[str, float]) -> Setting:
        """By the least of several timings of each, for one may be off by chance."""
        least = [c.cpu for c in options]
        for _ in range(_TIMINGS if len(options) > 1 else 0):
            for k, candidate in enumerate(options):
                least[k] = min(least[k], self.ensemble.one(candidate.setting, bounds).cpu)
        return options[least.index(min(least))].setting

    def _finer(self, candidate: Candidate) -> Setting | None:
        """The macro step at which a setting is expected to fit; None where it costs too much."""
        setting = candidate.setting
        factor = (AIM / min(candidate.miss, 1e6)) ** (1.0 / order(setting))
        step = self.step / math.ceil(self.step / (setting.step * factor) - 1e-9)
        if candidate.cpu * setting.step / step > self.dearest:
            return None
        return replace(setting, step=step)

    def _for_all_starts(
        self, setting: Setting, bounds: Mapping[str, float], tried: list[Candidate]
    ) -> Setting:
        """The setting, finer in the macro step where other starts need it."""
        for _ in range(3 if self.sampled else 0):
            candidate = self.ensemble.all(setting, bounds)
            tried.append(candidate)
            finer = None if candidate.miss <= _ROOM else self._finer(candidate)
            if finer is None or finer.step == setting.step:
                break
            setting = finer
        return setting

    def _couplings(self) -> list[tuple[str, str]]:
        """Algorithms and holds to choose from."""
        found = couplings(self.scene, self.space)
        if self.sampled:
            return found
        # of plants alone the algorithm stays
        found = [pair for pair in found if pair[0] == self.scene.algorithm]
        return found if len(found) > 1 else []


def order(setting: Setting) -> float:
    """Of the error in the macro step."""
    return 2.0 if setting.hold == "first" else float(ALGORITHMS[setting.algorithm].order)

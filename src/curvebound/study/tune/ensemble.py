"""What a setting comes to at a scene's own start, and at an ensemble of starts around it."""

from __future__ import annotations

import math
import statistics
from collections.abc import Mapping
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from ..reference.reference_set import MARGIN, ReferenceSet
from ..runner import Outcome, Runner
from ..settings import Setting
from .candidate import Candidate

__all__ = ["Ensemble"]

_EXTREME = 4  # starts that are run in any case: the scene's own and the first corners
_WIDEST = math.log(1000.0)  # of what is expected over the worst that was seen
_HOPELESS = 30.0  # times the bound: beyond this a setting needs no more starts to be dropped


class Ensemble:
    """Runs settings from `starts` (start values by path, the scene's own first) and counts them."""

    def __init__(
        self,
        runner: Runner,
        references: ReferenceSet,
        starts: Mapping[str, NDArray[np.float64]],
    ) -> None:
        self.runner = runner
        self.references = references
        self.starts = starts
        self.members = max((len(values) for values in starts.values()), default=1)
        self.runs = 0

    def one(self, setting: Setting, bounds: Mapping[str, float], member: int = 0) -> Candidate:
        """A setting at one start, by default the scene's own."""
        return self._run(setting, bounds, member)[0]

    def errors(
        self, setting: Setting, bounds: Mapping[str, float]
    ) -> tuple[Candidate, NDArray[np.float64]]:
        """A setting at the scene's own start, and its errors over their bounds, shape (k,).

        Those of one output follow on those of another; they are zero where the reference cannot
        tell. Settings with the same macro step have them at the same times.
        """
        candidate, outcome = self._run(setting, bounds, 0)
        if candidate.miss == math.inf:
            return candidate, np.array([math.inf])
        exact = self.references.values(self.references.model, outcome.times)
        found = []
        for path, bound in bounds.items():
            doubt = self.references.reference.uncertainty(path, outcome.times)[:, 0]
            error = outcome.outputs[path] - exact[path][:, 0]
            found.append(np.where(MARGIN * doubt <= bound, error / bound, 0.0))
        return candidate, np.concatenate(found)

    def _run(
        self, setting: Setting, bounds: Mapping[str, float], member: int
    ) -> tuple[Candidate, Outcome]:
        start = {path: float(values[member]) for path, values in self.starts.items()}
        outcome = self.runner.glance(setting, start)
        self.runs += 1
        if outcome.failure or len(outcome.times) < 2:
            failed = Candidate(setting, math.inf, outcome.cpu, math.inf, failure=outcome.failure)
            return failed, outcome
        verdicts = self.references.errors(
            outcome.times, outcome.outputs, member=member, least=bounds
        )
        miss = max(v.worst / bounds[path] for path, v in verdicts.items())
        return Candidate(setting, miss, outcome.cpu, miss, verdicts=verdicts), outcome

    def all(self, setting: Setting, bounds: Mapping[str, float]) -> Candidate:
        """A setting on the whole ensemble: the worst start, or what their spread leads to expect.

        Errors are taken as log-normal above their median over the starts, by which the next one
        lies below what is expected with a probability of about 0.99 (Student's t), and as within
        1000 times the worst seen: those of a chaotic motion spread over many orders. Where the
        first starts, which are the extreme ones, miss by far, the others are spared.
        """
        every: list[Candidate] = []
        for member in range(self.members):
            every.append(self.one(setting, bounds, member))
            if len(every) >= _EXTREME and max(c.miss for c in every) > _HOPELESS:
                break
        own = every[0]
        misses = [c.miss for c in every]
        miss = seen = max(misses)
        if 0.0 < miss < math.inf and len(misses) == self.members > 2:
            logs = sorted(math.log(max(m, 1e-300)) for m in misses)
            n = len(logs)
            middle = statistics.median(logs)
            above = statistics.fmean((x - middle) ** 2 for x in logs[(n + 1) // 2 :])
            reach = _STUDENT.get(n - 1, 2.9) * math.sqrt(above * (1.0 + 1.0 / n))
            expected = middle + reach
            miss *= max(1.1, math.exp(min(expected - math.log(miss), _WIDEST)))
        failure = next((c.failure for c in every if c.failure), "")
        return replace(own, miss=miss, seen=seen, starts=len(every), failure=failure)


#: one-sided 99.5 % points of Student's t distribution by degrees of freedom
_STUDENT = {
    2: 9.925, 3: 5.841, 4: 4.604, 5: 4.032, 6: 3.707, 7: 3.499, 8: 3.355, 9: 3.250, 10: 3.169,
    11: 3.106, 12: 3.055, 13: 3.012, 14: 2.977, 15: 2.947, 16: 2.921,
}  # fmt: skip

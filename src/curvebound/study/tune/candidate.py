"""What tuning finds: settings with their errors and costs, and the one chosen among them."""

from __future__ import annotations

from dataclasses import dataclass, field

from ..reference.reference_set import Verdict
from ..settings import Setting

__all__ = ["Candidate", "Choice"]


@dataclass
class Candidate:
    """A setting and what it came to; `cpu` s per simulated s.

    seen: the largest error over its bound, over all outputs and the starts that were run.
    miss: that, and with `starts` > 1 what their spread leads to expect of others.
    """

    setting: Setting
    miss: float
    cpu: float
    seen: float
    starts: int = 1
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
    sure: whether other starts are expected to meet the bounds too, not only those that were run.
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
    sure: bool = True
    affordable: Candidate | None = None
    within_budget: bool = True
    advice: str = ""

"""What a check found, and all that was found of one target."""

from __future__ import annotations

import hashlib
import time as clock
from collections.abc import Callable
from dataclasses import asdict, dataclass, field
from typing import Any

import numpy as np
from numpy.typing import NDArray

__all__ = [
    "FAILED",
    "PASSED",
    "SKIPPED",
    "Finding",
    "Report",
    "Skipped",
    "Wrong",
    "digest_of",
    "found",
]

PASSED, FAILED, SKIPPED = "passed", "failed", "skipped"


class Wrong(Exception):
    """What a check is there to find; the text says what differs from what, where."""


class Skipped(Exception):
    """A check does not apply; the text says why."""


@dataclass(frozen=True)
class Finding:
    """check: its name; outcome: passed, failed or skipped; text: what was seen; seconds: it took"""

    check: str
    outcome: str
    text: str
    seconds: float = 0.0


@dataclass
class Report:
    """All findings on a target: `kind` is FMU or scene."""

    target: str
    kind: str
    findings: list[Finding] = field(default_factory=list)

    @property
    def passed(self) -> bool:
        """Whether nothing failed."""
        return all(one.outcome != FAILED for one in self.findings)

    def as_data(self) -> dict[str, Any]:
        """For JSON."""
        return {
            "target": self.target,
            "kind": self.kind,
            "passed": self.passed,
            "findings": [asdict(one) for one in self.findings],
        }


def found(check: str, look: Callable[[], str]) -> Finding:
    """Do a check: `look` returns what it saw, or raises Wrong or Skipped."""
    began = clock.perf_counter()
    try:
        outcome, text = PASSED, look()
    except Wrong as wrong:
        outcome, text = FAILED, str(wrong)
    except Skipped as why:
        outcome, text = SKIPPED, str(why)
    return Finding(check, outcome, text, round(clock.perf_counter() - began, 3))


def digest_of(names: list[str], rows: NDArray[np.float64]) -> dict[str, str]:
    """A hash of each column, by which two processes are compared."""
    return {
        name: hashlib.sha256(np.ascontiguousarray(column).tobytes()).hexdigest()
        for name, column in zip(names, rows.T, strict=True)
    }

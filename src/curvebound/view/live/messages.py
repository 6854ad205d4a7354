"""What a page is told: events as JSON, samples as binary messages."""

from __future__ import annotations

import json
from typing import Any

import numpy as np
from numpy.typing import NDArray

__all__ = ["MOST_PAST", "MOST_ROWS", "samples", "text"]

MOST_ROWS = 8  # of one run in one message: more than that no picture shows
MOST_PAST = 64  # the same where a run's past is computed anew, for the plots


def text(event: str, **fields: Any) -> str:
    """An event."""
    return json.dumps({"event": event, **fields}, allow_nan=False, separators=(",", ":"))


def samples(run: int, time: float, rows: list[NDArray[np.float64]], most: int) -> bytes:
    """Rows of one run, thinned out to `most` of them; the last is always among them.

    As doubles of the machine: number of the run, the time in s that has come, then the rows.
    """
    every = -(-len(rows) // most)
    thin = rows[(len(rows) - 1) % every :: every]
    return np.concatenate([[float(run), time], *thin]).tobytes()

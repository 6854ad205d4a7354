"""What tests of tuning and studies share."""

from __future__ import annotations

from functools import partialmethod

import pytest

from curvebound.study.runner import Runner


@pytest.fixture
def timed_once(monkeypatch: pytest.MonkeyPatch) -> None:
    """What a setting costs is taken from one run, where a test does not look at costs."""
    monkeypatch.setattr(Runner, "cost", partialmethod(Runner.cost, runs=1, enough=0.0))

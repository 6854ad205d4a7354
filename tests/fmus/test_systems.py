"""The systems that come with the package, held to what every system gets by itself."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

import pytest

from curvebound import checks
from curvebound.checks import CHECKS
from curvebound.fmi.folder import find, names

#: tests/fmi/test_same_bits.py compares more than the last
QUICK = [one for one in CHECKS if one is not checks.runs_alike_compiled_and_interpreted]


@pytest.mark.usefixtures("sampled_here")
@pytest.mark.parametrize("check", QUICK, ids=lambda check: check.__name__)
@pytest.mark.parametrize("name", names())
def test_system(name: str, check: Callable[[Path], None], monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(checks, "_POINTS", 3)
    monkeypatch.setattr(checks, "_STATES", 30)
    check(find(name).path)


@pytest.mark.slow
@pytest.mark.parametrize("check", CHECKS, ids=lambda check: check.__name__)
@pytest.mark.parametrize("name", names())
def test_system_at_as_many_points_as_users_get(name: str, check: Callable[[Path], None]) -> None:
    check(find(name).path)

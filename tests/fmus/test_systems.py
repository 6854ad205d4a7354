"""The systems that come with the package, held to what every system gets by itself."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

import pytest

from curvebound import checks
from curvebound.checks import CHECKS, is_right_at_random_points, kernel_follows_mechanics
from curvebound.fmi.folder import find, names


@pytest.mark.parametrize("check", CHECKS, ids=lambda check: check.__name__)
@pytest.mark.parametrize("name", names())
def test_system(name: str, check: Callable[[Path], None], monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(checks, "_POINTS", 15)
    monkeypatch.setattr(checks, "_STATES", 60)
    check(find(name).path)


@pytest.mark.slow
@pytest.mark.parametrize("check", [kernel_follows_mechanics, is_right_at_random_points])
@pytest.mark.parametrize("name", names())
def test_system_at_as_many_points_as_users_get(name: str, check: Callable[[Path], None]) -> None:
    check(find(name).path)

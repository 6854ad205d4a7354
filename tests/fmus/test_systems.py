"""The systems that come with the package, held to what every system gets by itself."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

import pytest

from curvebound.checks import CHECKS
from curvebound.fmi.folder import find, names


@pytest.mark.parametrize("check", CHECKS, ids=lambda check: check.__name__)
@pytest.mark.parametrize("name", names())
def test_system(name: str, check: Callable[[Path], None]) -> None:
    check(find(name).path)

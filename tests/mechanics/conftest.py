"""Systems whose equations are derived, and random states of them."""

from __future__ import annotations

import random
from collections.abc import Callable
from pathlib import Path
from typing import Any

import mpmath
import pytest

from curvebound.fmi.folder import Folder
from curvebound.mechanics.derived import Derived
from curvebound.mechanics.numeric import ManyDigits

HERE = Path(__file__).parent
FOLDERS = {
    path.parent.name: path.parent
    for path in [
        *(HERE.parents[1] / "fmus").glob("*/mechanics.py"),
        *(HERE / "systems").glob("*/mechanics.py"),
    ]
}
#: those that take long to derive
LONG = ("bead_on_ellipse_by_angle", "pendulum_on_sine")
DIGITS = 80


#: the name of each system
EACH = [
    pytest.param(name, marks=pytest.mark.slow) if name in LONG else name for name in sorted(FOLDERS)
]


@pytest.fixture(params=EACH)
def system(request: pytest.FixtureRequest) -> Derived:
    """Each system in turn."""
    return Folder(FOLDERS[request.param]).derived()


@pytest.fixture
def rng() -> random.Random:
    return random.Random(20261126)


@pytest.fixture
def many() -> Any:
    """Numbers of 80 digits."""
    with mpmath.workdps(DIGITS):
        yield ManyDigits()


@pytest.fixture
def drawn(rng: random.Random, many: Any) -> Callable[..., dict[str, Any]]:
    """Symbols of a system in 80 digits: everything on, t s after the start, light and heavy."""

    def draw(system: Derived, t: float = 0.0, **fixed: float) -> dict[str, Any]:
        values: dict[str, Any] = {}
        for name in ("gravity.x", "gravity.y"):
            values[name] = many.number(rng.uniform(-9.0, 9.0))
        for v in system.variables:
            if v.kind in ("parameter", "input"):
                x = rng.uniform(-2.0, 2.0)
                if v.name.endswith(".mass"):
                    x = 10.0 ** rng.uniform(-6.0, 6.0)
                values[v.name] = many.number(abs(x) if v.minimum is not None else x)
        values |= {name: many.number(x) for name, x in fixed.items()}
        s = system.at(many, values, many.number(t))
        for n in ("x", "y", "vx", "vy"):
            s[f"frame.{n}"] += many.number(rng.uniform(-1.0, 1.0)) if system.frame else 0
        return s

    return draw

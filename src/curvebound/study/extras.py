"""Packages that only some commands need: whether they are there, and how to get them."""

from __future__ import annotations

import importlib.util

from ..errors import CurveboundError

__all__ = ["require"]

_NEEDED = {
    "study": ("mpmath", "scipy"),
    "plots": ("matplotlib",),
    "sweep": ("distributed",),
    "parquet": ("pyarrow",),
}


def require(extra: str) -> None:
    """Raise CurveboundError, which says what to install, unless an extra's packages are there."""
    missing = [name for name in _NEEDED[extra] if importlib.util.find_spec(name) is None]
    if missing:
        remedy = f"'curvebound[{'sweep' if extra == 'parquet' else extra}]'"
        raise CurveboundError(
            f"This needs {' and '.join(missing)}, not installed here. "
            f"Install it with `pip install {remedy}`."
        )

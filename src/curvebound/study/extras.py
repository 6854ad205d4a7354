"""Packages that only some commands need: whether they are there, and how to get them."""

from __future__ import annotations

import importlib.util

from ..errors import CurveboundError

__all__ = ["missing", "require"]

_NEEDED = {
    "study": ("mpmath", "scipy"),
    "plots": ("matplotlib",),
    "live": ("websockets",),
    "sweep": ("distributed",),
    "parquet": ("pyarrow",),
}


def missing(extra: str) -> str:
    """What is not installed of an extra's packages, with the command that installs it; or ''."""
    absent = [name for name in _NEEDED[extra] if importlib.util.find_spec(name) is None]
    if not absent:
        return ""
    remedy = f"'curvebound[{'sweep' if extra == 'parquet' else extra}]'"
    return (
        f"This needs {' and '.join(absent)}, not installed here. "
        f"Install it with `pip install {remedy}`."
    )


def require(extra: str) -> None:
    """Raise CurveboundError, which says what to install, unless an extra's packages are there."""
    text = missing(extra)
    if text:
        raise CurveboundError(text)

"""Numbers as people write them: 1e-3, pi/2, 90deg, 2*3.5 mm, 50 rpm."""

from __future__ import annotations

import functools
import math
import re
from typing import Any

__all__ = ["number"]

_ALLOWED = re.compile(r"[\w\s.+*/^()%-]{1,100}")
# m/s2 and N.m as FMI and engineers write them: an exponent after a letter, a dot between units
_EXPONENT = re.compile(r"(?<=[A-Za-z])(-?\d+)(?![\w.])")
_PRODUCT = re.compile(r"(?<=[A-Za-z0-9)])\.(?=[A-Za-z(])")
# Whole numbers are taken as floating-point ones, whose powers cannot grow without end.
_WHOLE = re.compile(r"(?<![\w.])(\d+)(?![\w.])")


@functools.cache
def _registry() -> Any:
    import pint  # a second of import time, which plain numbers need not pay

    return pint.UnitRegistry(autoconvert_offset_to_baseunit=True)


def number(text: str, unit: str | None = None) -> float:
    """The number that `text` stands for, in `unit` (as an FMU writes it; None: it has none).

    Arithmetic of numbers and pi, and a unit behind it, which is converted; without one the number
    is in `unit` already. Nothing can be called from it. Raises ValueError, whose text says what
    would be accepted.
    """
    try:
        return float(text)
    except ValueError:
        pass
    value = math.nan
    if _ALLOWED.fullmatch(text) and re.search(r"\d|pi", text):
        try:
            value = _converted(text, unit or "1")
        except Exception:  # whatever pint raises on text that is none of its own
            value = math.nan
    if not math.isfinite(value):
        in_unit = f"in {unit}, or with a unit to convert" if unit else "without a unit"
        raise ValueError(f"{text!r} is not a number {in_unit} (as 0.5, pi/2 or 90deg)")
    return value


def _converted(text: str, unit: str) -> float:
    quantity = _registry().Quantity(_written_out(text))
    if quantity.unitless:
        return float(quantity.to_base_units().magnitude)
    target = _registry().Unit("" if unit == "1" else _written_out(unit))
    if ("hertz" in str(quantity.units)) != ("hertz" in str(target)):
        return math.nan  # Hz counts turns: pint would take 1 Hz for 1 rad/s
    return float(quantity.to(target).magnitude)


def _written_out(text: str) -> str:
    return _WHOLE.sub(r"\1.0", _EXPONENT.sub(r"**\1", _PRODUCT.sub("*", text)))

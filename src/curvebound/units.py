"""The one place where units are written, read and converted.

FMUs and scenes write them as m/s2, N.m.s/rad or 1/(m.s2), 1 for none, which is understood as
exponents of base units (FMI 2.0, 2.2.2). People write numbers as 1e-3, pi/2, 90deg, 50 rpm.
"""

from __future__ import annotations

import functools
import math
import re
from typing import Any

from .errors import CurveboundError

__all__ = ["BASE_UNITS", "conversion", "exponents", "labelled", "number", "per_second"]

#: the base units of FMI and SSP
BASE_UNITS = ("kg", "m", "s", "A", "K", "mol", "cd", "rad")

#: units and what they are in base units
_NAMED: dict[str, dict[str, int]] = {
    **{base: {base: 1} for base in BASE_UNITS},
    "Hz": {"s": -1},
    "N": {"kg": 1, "m": 1, "s": -2},
    "J": {"kg": 1, "m": 2, "s": -2},
    "W": {"kg": 1, "m": 2, "s": -3},
    "Pa": {"kg": 1, "m": -1, "s": -2},
}
_ALLOWED = re.compile(r"[\w\s.+*/^()%-]{1,100}")
# m/s2 and N.m as FMI and engineers write them: an exponent after a letter, a dot between units
_EXPONENT = re.compile(r"(?<=[A-Za-z])(-?\d+)(?![\w.])")
_PRODUCT = re.compile(r"(?<=[A-Za-z0-9)])\.(?=[A-Za-z(])")
# Whole numbers are taken as floating-point ones, whose powers cannot grow without end.
_WHOLE = re.compile(r"(?<![\w.])(\d+)(?![\w.])")
_FACTOR = re.compile(r"([A-Za-z]+)(\d*)")


def exponents(unit: str) -> dict[str, int]:
    """Exponents of the base units in a unit such as "N.m.s/rad", "1/(m.s2)" or "1" (none).

    Raises CurveboundError for what is no unit of the SI in this notation.
    """
    found: dict[str, int] = {}
    over, slash, under = unit.partition("/")
    if under.startswith("(") and under.endswith(")"):
        under = under[1:-1]
    for part, sign in ((over, 1), (under, -1)) if slash else ((over, 1),):
        for factor in part.split("."):
            if factor == "1" and sign > 0 and part == factor:
                continue
            match = _FACTOR.fullmatch(factor)
            if match is None or match[1] not in _NAMED:
                raise CurveboundError(
                    f"{unit!r} is no unit: write it of {', '.join(_NAMED)}, as in m/s2, "
                    "N.m.s/rad or 1/(m.s2); 1 where there is none"
                )
            for base, power in _NAMED[match[1]].items():
                found[base] = found.get(base, 0) + sign * power * int(match[2] or 1)
    return {base: power for base, power in found.items() if power}


def per_second(unit: str, times: int = 1) -> str:
    """A unit divided by s, so many times: m/s for m, 1/(m.s) for 1/m."""
    of = exponents(unit)
    of["s"] = of.get("s", 0) - times
    parts = {
        sign: [
            base + (str(abs(power)) if abs(power) > 1 else "")
            for base, power in of.items()
            if power * sign > 0
        ]
        for sign in (1, -1)
    }
    over, under = ".".join(parts[1]) or "1", ".".join(parts[-1])
    if not under:
        return over
    return f"{over}/({under})" if len(parts[-1]) > 1 else f"{over}/{under}"


def conversion(of: tuple[float, ...], to: tuple[float, ...]) -> tuple[float, float] | None:
    """(factor, offset) that turn a value of one unit into another; None for another quantity.

    Both are exponents of BASE_UNITS, then factor and offset: in base units it is factor * value +
    offset.
    """
    count = len(BASE_UNITS)
    if of[:count] != to[:count]:
        return None
    factor, offset = of[count:]
    return factor / to[count], (offset - to[count + 1]) / to[count]


def labelled(name: str, unit: str) -> str:
    """A name with its unit, for axes and headings."""
    return name if unit in ("", "1") else f"{name} ({unit})"


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

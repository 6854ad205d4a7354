"""The one place where numbers are written for people: pages, plots, sentences."""

from __future__ import annotations

import math

__all__ = ["plain", "quantity", "ticks"]

_LEAST, _MOST = 1e-3, 1e6  # sizes written without an exponent
#: prefixes of the units that take them, down from one
_PREFIXES = ((1.0, ""), (1e-3, "m"), (1e-6, "u"), (1e-9, "n"))
_PREFIXED = ("s",)


def plain(x: float, digits: int = 3) -> str:
    """160, 3.97, 0.0012, 2.3e-9: significant digits, an exponent only where one needs it."""
    if x == 0.0 or not math.isfinite(x):
        return "0" if x == 0.0 else f"{x}"
    rounded = float(f"{x:.{digits}g}")
    if _LEAST <= abs(rounded) < _MOST:
        return f"{rounded:.15g}"
    mantissa, _, exponent = f"{rounded:.{digits - 1}e}".partition("e")
    if "." in mantissa:
        mantissa = mantissa.rstrip("0").rstrip(".")
    return f"{mantissa}e{int(exponent)}"


def quantity(x: float, unit: str, digits: int = 3) -> str:
    """A number and its unit ("1" or "" for none); seconds as 3.27 us or 12 ms."""
    if unit in ("", "1"):
        return plain(x, digits)
    if unit in _PREFIXED and x != 0.0 and math.isfinite(x):
        rounded = float(f"{x:.{digits}g}")
        for factor, prefix in _PREFIXES:
            if abs(rounded) >= factor:
                return f"{plain(rounded / factor, digits)} {prefix}{unit}"
    return f"{plain(x, digits)} {unit}"


def ticks(low: float, high: float, about: int = 5) -> list[float]:
    """Round numbers from `low` to `high`, about so many: multiples of 1, 2 or 5 times a decade."""
    rough = (high - low) / about
    power = math.floor(math.log10(rough))
    decade = 10.0**power
    step = next(decade * f for f in (1.0, 2.0, 5.0, 10.0) if decade * f >= 0.99 * rough)
    first, last = math.ceil(low / step - 1e-9), math.floor(high / step + 1e-9)
    return [round(step * i, 1 - power) for i in range(first, last + 1)]

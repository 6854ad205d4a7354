"""The one place where units are written and read: as SI base-unit exponents (FMI 2.0, 2.2.2)."""

from __future__ import annotations

import re

from ..errors import CurveboundError

__all__ = ["exponents", "per_second"]

#: units and what they are in base units
_NAMED: dict[str, dict[str, int]] = {
    **{base: {base: 1} for base in ("kg", "m", "s", "A", "K", "mol", "cd", "rad")},
    "Hz": {"s": -1},
    "N": {"kg": 1, "m": 1, "s": -2},
    "J": {"kg": 1, "m": 2, "s": -2},
    "W": {"kg": 1, "m": 2, "s": -3},
    "Pa": {"kg": 1, "m": -1, "s": -2},
}
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

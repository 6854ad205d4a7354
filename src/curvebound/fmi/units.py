"""The one place where units are written: each with its SI base-unit exponents (FMI 2.0, 2.2.2)."""

from __future__ import annotations

__all__ = ["UNITS"]

#: unit name -> exponents of the base units
UNITS: dict[str, dict[str, int]] = {
    "1": {},
    "m": {"m": 1},
    "m/s": {"m": 1, "s": -1},
    "m/s2": {"m": 1, "s": -2},
    "rad": {"rad": 1},
    "rad/s": {"rad": 1, "s": -1},
    "s": {"s": 1},
    "Hz": {"s": -1},
    "kg": {"kg": 1},
    "N": {"kg": 1, "m": 1, "s": -2},
    "N/m": {"kg": 1, "s": -2},
    "N.s/m": {"kg": 1, "s": -1},
    "N.m.s/rad": {"kg": 1, "m": 2, "s": -1, "rad": -1},
    "J": {"kg": 1, "m": 2, "s": -2},
    "1/s": {"s": -1},
    "1/s2": {"s": -2},
    "1/m": {"m": -1},
    "1/(m.s)": {"m": -1, "s": -1},
    "1/(m.s2)": {"m": -1, "s": -2},
    "m/(s2.rad)": {"m": 1, "s": -2, "rad": -1},
    "m/(s.rad)": {"m": 1, "s": -1, "rad": -1},
}

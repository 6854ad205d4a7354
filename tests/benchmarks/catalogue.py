"""The maps of both systems over their whole ranges: `python tests/benchmarks maps`.

Each is also one command, `curvebound stability SCENE --set ... --vary ...`, apart from the length
of its runs where that follows from the value.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass

from curvebound.cosim.fmu import Value
from curvebound.study.stability.maps import Request
from curvebound.study.stability.stability_map import MAPPED

__all__ = ["Named", "catalogue"]

G = 9.81
#: s, at the defaults
DURATION = 10.0


@dataclass(frozen=True)
class Named(Request):
    """A map of the catalogue: `fmu` that documents it, and the unit of what varies."""

    fmu: str = ""
    unit: str = ""


def _decades(low: int, high: int) -> list[float]:
    return [float(f"1e{n}") for n in range(low, high + 1)]


def _signed(low: int, high: int) -> list[float]:
    sizes = _decades(low, high)
    return [*(-x for x in reversed(sizes)), 0.0, *sizes]


def _by_gravity(value: float) -> float:
    """Runs of equal length in units of sqrt(length / gravity)."""
    return DURATION * math.sqrt(G / abs(value)) if value else DURATION


def _to_the_vertex(coefficient: float) -> float:
    """Long enough for a slider on a steep parabola to fall to the vertex and beyond."""
    return DURATION * max(1.0, math.sqrt(coefficient / 1e3)) if coefficient > 0.0 else DURATION


#: variable, unit, values, and the duration (s) of runs at each
_Entry = tuple[str, str, list[float], Callable[[float], float]]


def _same(_: float) -> float:
    return DURATION


_BEAD: list[_Entry] = [
    ("wire.radius", "m", _decades(-3, 3), lambda r: DURATION * math.sqrt(r)),
    ("bead.damping", "N.s/m", [0.0, *_decades(-3, 6)], _same),
    ("bead.angular_velocity_start", "rad/s", [0.0, *_decades(-1, 3)], _same),
    ("gravity.y", "m/s2", _signed(-3, 3), _by_gravity),
]
_PENDULUM: list[_Entry] = [
    ("pendulum.mass", "kg", _decades(-8, 8), _same),
    ("parabola.coefficient_start", "1/m", _signed(-4, 4), _to_the_vertex),
    ("pendulum.length", "m", _decades(-3, 3), _same),
    ("slider.damping", "N.s/m", [0.0, *_decades(-3, 6)], _same),
    ("pendulum.damping", "N.m.s/rad", [0.0, *_decades(-3, 6)], _same),
    ("slider.u_rate_start", "m/s", [0.0, *_decades(-1, 3)], _same),
    ("pendulum.angular_velocity_start", "rad/s", [0.0, *_decades(-1, 3)], _same),
    ("gravity.y", "m/s2", _signed(-3, 3), _by_gravity),
]
#: scene, component, changes to the default start, FMU, maps
_SYSTEMS: list[tuple[str, str, dict[str, Value], str, list[_Entry]]] = [
    ("bead_on_wire", "bead", {}, "BeadOnWire", _BEAD),
    (
        "pendulum_large",
        "plant",
        {"slider.u_start": 0.5, "pendulum.angle_start": 0.5},
        "ParabolaPendulum",
        _PENDULUM,
    ),
]


def catalogue(methods: tuple[str, ...] = (), accuracy: float = 1e-3) -> list[Named]:
    """The maps, of `methods` or all."""
    found = []
    for scene, component, changes, fmu, entries in _SYSTEMS:
        for variable, unit, values, duration in entries:
            listed = ",".join(repr(value) for value in values)
            found.append(
                Named(
                    scene,
                    f"{component}.{variable}={listed}",
                    tuple((f"{component}.{name}", value) for name, value in changes.items()),
                    methods or MAPPED,
                    accuracy,
                    durations=tuple(duration(value) for value in values),
                    fmu=fmu,
                    unit=unit,
                )
            )
    return found

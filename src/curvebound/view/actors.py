"""Finds in a result what can be drawn: beads on wires, pendulums on parabolas, and their sizes.

A result holds outputs, not parameters. The radius, the rod's length and the parabola's coefficient
are therefore recovered from the positions, which both fidelities give in exact geometry.
"""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Any

import numpy as np
from numpy.typing import NDArray

__all__ = ["BEAD", "PENDULUM", "Actor", "Floats", "find_actors", "missing", "split_name"]

Floats = NDArray[np.float64]

BEAD = "bead"
PENDULUM = "pendulum"

# What a drawing needs at least: one of these sets, the better first.
_NEEDED: dict[str, tuple[tuple[str, ...], ...]] = {
    BEAD: (("bead.x", "bead.y"), ("bead.angle",)),
    PENDULUM: (
        ("slider.x", "slider.y", "pendulum.x", "pendulum.y"),
        ("slider.u", "pendulum.angle"),
    ),
}
_DEFAULT_COEFFICIENT = 0.5
_DEFAULT_LENGTH = 1.0


@dataclass(frozen=True)
class Actor:
    """One body in its frame. All arrays have shape (samples,), metres in the world frame.

    `places` names the arrays: frame_x, frame_y, body_x, body_y (bead or slider), and for the
    pendulum bob_x, bob_y and coefficient (1/m). `size` is the wire's radius or the rod's length.
    """

    kind: str
    prefix: str
    size: float
    places: dict[str, Floats]
    notes: tuple[str, ...] = field(default=())

    def points(self) -> list[tuple[str, Floats, Floats]]:
        """The moving points: (name, x, y)."""
        if self.kind == BEAD:
            return [("bead", self.places["body_x"], self.places["body_y"])]
        return [
            ("slider", self.places["body_x"], self.places["body_y"]),
            ("bob", self.places["bob_x"], self.places["bob_y"]),
        ]

    def reach(self) -> float:
        """How far to either side of its vertex a parabola is drawn, in m."""
        u = np.abs(self.places["body_x"] - self.places["frame_x"])
        u = u[np.isfinite(u)]
        # Of a run that blew up, the part before it did.
        far = float(min(u.max(), 3.0 * np.percentile(u, 90.0) + self.size)) if u.size else 0.0
        return max(1.25 * far, 0.6 * self.size)


def split_name(column: str) -> tuple[str, str]:
    """`plant.slider.u` -> ("plant.", "slider.u"); the component may itself contain dots."""
    parts = column.split(".")
    return ".".join([*parts[:-2], ""]) if len(parts) > 2 else "", ".".join(parts[-2:])


def find_actors(data: NDArray[Any]) -> list[Actor]:
    """Every body that the columns of `data` suffice to draw."""
    columns: dict[str, set[str]] = {}
    for column in data.dtype.names or ():
        prefix, variable = split_name(column)
        columns.setdefault(prefix, set()).add(variable)
    found: list[Actor] = []
    poor: list[Actor] = []
    for prefix, have in columns.items():
        source = _Source(data, prefix, have)
        if _has(have, BEAD):
            found.append(_bead(source))
        if _has(have, PENDULUM):
            # A controller measures the coordinates too: it is no second pendulum.
            measured = not have & {"slider.x", "pendulum.x", "energy.total", "pendulum.tension"}
            (poor if measured else found).append(_pendulum(source))
    drawn = {actor.kind for actor in found}
    return found + [actor for actor in poor if actor.kind not in drawn][:1]


def missing(data: NDArray[Any]) -> str:
    """In words, what the columns lack to be drawn."""
    have = {split_name(column)[1] for column in data.dtype.names or ()}
    said = []
    for kind, words in ((BEAD, "a bead on a wire"), (PENDULUM, "a pendulum on a parabola")):
        needs = " or ".join(" and ".join(need) for need in _NEEDED[kind])
        best = max(_NEEDED[kind], key=lambda need: (len(have & set(need)) / len(need), -len(need)))
        lack = [name for name in best if name not in have]
        near = len(lack) < len(best)
        said.append(f"{words} needs {needs}" + (f"; {', '.join(lack)} missing" if near else ""))
    return ", ".join(said)


class _Source:
    """The columns of one component as floats."""

    def __init__(self, data: NDArray[Any], prefix: str, have: set[str]) -> None:
        self._data = data
        self.prefix = prefix
        self.have = have

    def get(self, variable: str, default: float | None = None) -> Floats:
        if variable not in self.have:
            assert default is not None
            return np.full(len(self._data), default)
        values = np.asarray(self._data[self.prefix + variable], dtype=np.float64)
        return np.where(np.isfinite(values), values, np.nan)


def _has(have: set[str], kind: str) -> bool:
    return any(set(need) <= have for need in _NEEDED[kind])


def _first(values: Floats) -> float | None:
    """The first number in `values`: at the start the constraints hold to rounding."""
    good = values[np.isfinite(values)]
    return float(good[0]) if good.size else None


def _bead(source: _Source) -> Actor:
    notes: list[str] = []
    frame_x, frame_y = source.get("wire.x", 0.0), source.get("wire.y", 0.0)
    if {"bead.x", "bead.y"} <= source.have:
        x, y = source.get("bead.x"), source.get("bead.y")
        radius = _first(np.hypot(x - frame_x, y - frame_y) - source.get("constraint.drift", 0.0))
    else:
        with np.errstate(divide="ignore", invalid="ignore"):
            force = source.get("constraint.force", 0.0)
            multiplier = source.get("constraint.multiplier", 0.0)
            radius = _first(np.where(multiplier != 0.0, force / multiplier, np.nan))
        angle = source.get("bead.angle")
        if radius is None:
            notes.append("the radius is not in the columns: drawn as 1 m")
        x = frame_x + (radius or 1.0) * np.sin(angle)
        y = frame_y - (radius or 1.0) * np.cos(angle)
    places = {"frame_x": frame_x, "frame_y": frame_y, "body_x": x, "body_y": y}
    # A radius that is not above zero is that of a damaged file; the drawing goes on.
    size = radius if radius is not None and radius > 0.0 else 1.0
    return Actor(BEAD, source.prefix, size, places, tuple(notes))


def _pendulum(source: _Source) -> Actor:
    notes: list[str] = []
    frame_x, frame_y = source.get("parabola.x", 0.0), source.get("parabola.y", 0.0)
    placed = {"slider.x", "slider.y"} <= source.have
    if "parabola.coefficient" in source.have:
        coefficient = source.get("parabola.coefficient")
    else:
        fitted = None
        if placed:
            fitted = _fit(source.get("slider.x") - frame_x, source.get("slider.y") - frame_y)
        if fitted is None:
            fitted = _DEFAULT_COEFFICIENT
            notes.append(f"the coefficient is not in the columns: drawn as {fitted} 1/m")
        coefficient = np.full(len(frame_x), fitted)
    if placed:
        x, y = source.get("slider.x"), source.get("slider.y")
    else:
        u = source.get("slider.u")
        x, y = frame_x + u, frame_y + coefficient * u * u
    if {"pendulum.x", "pendulum.y"} <= source.have:
        bob_x, bob_y = source.get("pendulum.x"), source.get("pendulum.y")
        length = _first(np.hypot(bob_x - x, bob_y - y)) or _DEFAULT_LENGTH
    else:
        length = _DEFAULT_LENGTH
        notes.append(f"the rod's length is not in the columns: drawn as {length} m")
        angle = source.get("pendulum.angle")
        bob_x, bob_y = x + length * np.sin(angle), y - length * np.cos(angle)
    places = {
        "frame_x": frame_x,
        "frame_y": frame_y,
        "body_x": x,
        "body_y": y,
        "bob_x": bob_x,
        "bob_y": bob_y,
        "coefficient": coefficient,
    }
    return Actor(PENDULUM, source.prefix, length, places, tuple(notes))


def _fit(u: Floats, height: Floats) -> float | None:
    """Least-squares coefficient of height = a u^2; None where u never leaves the vertex."""
    good = np.isfinite(u) & np.isfinite(height)
    square = u[good] * u[good]
    weight = float(square @ square)
    return float(square @ height[good]) / weight if weight > 0.0 else None

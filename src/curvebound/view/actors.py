"""Finds in a result what can be drawn: the points, rods and curves of the drawings that are known.

A result holds outputs, not parameters, and often not all outputs. What a drawing needs and the
columns lack is computed from them by the drawing's own formulas.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ..fmi.drawing import FRAME, Curve, Drawing
from ..fmi.formula import Floats, evaluate, parse, variables_of

__all__ = ["Actor", "Floats", "drawings_of", "find_actors", "missing", "split_name"]


@dataclass(frozen=True)
class Actor:
    """One system in its frame. All arrays have shape (samples,), metres in the world frame.

    `places` holds "POINT x" and "POINT y" for each point of the drawing and for FRAME, and the
    variables of its curves by their names. `size` is a length that is typical of it, in m.
    """

    drawing: Drawing
    prefix: str
    size: float
    places: dict[str, Floats]
    notes: tuple[str, ...] = field(default=())

    @property
    def kind(self) -> str:
        """The name of the system; only bodies of one kind are compared."""
        return self.drawing.name

    def at(self, point: str) -> tuple[Floats, Floats]:
        """Where a point is, or FRAME: (x, y)."""
        return self.places[f"{point} x"], self.places[f"{point} y"]

    def points(self) -> list[tuple[str, Floats, Floats]]:
        """The moving points: (name, x, y)."""
        return [(point.name, *self.at(point.name)) for point in self.drawing.points]

    def outlines(self) -> list[tuple[Floats, Floats, float]]:
        """What circles and curves of fixed range cover: (x, y, radius about these places)."""
        made = [
            (self.of(circle.x), self.of(circle.y), self.radius(circle.radius))
            for circle in self.drawing.circles
        ]
        for curve in self.drawing.curves:
            if curve.s is not None:
                for s in np.linspace(*curve.s, 61):
                    made.append((self.of(curve.x, s), self.of(curve.y, s), 0.0))
        return made

    def of(self, formula: str, s: Floats | float = 0.0, sample: int | None = None) -> Floats:
        """A formula of the drawing's curves, at all samples or at one, for one s or many."""
        places = self.places
        if sample is not None:
            places = {name: values[sample] for name, values in places.items()}
        values = evaluate(parse(formula), {**places, "s": s})
        shape = np.shape(s) if sample is not None else self.at(FRAME)[0].shape
        return np.asarray(np.broadcast_to(values, shape), dtype=np.float64)

    def span(self, curve: Curve) -> tuple[float, float]:
        """The range of s over which a curve is drawn."""
        if curve.s is not None:
            return curve.s
        s = np.abs(self.at(curve.holds)[0] - self.at(FRAME)[0])
        s = s[np.isfinite(s)]
        # Of a run that blew up, the part before it did.
        far = float(min(s.max(), 3.0 * np.percentile(s, 90.0) + self.size)) if s.size else 0.0
        reach = max(1.25 * far, 0.6 * self.size)
        return -reach, reach

    def radius(self, formula: str) -> float:
        """A circle's radius in m: the first that is a number above zero, or 1."""
        radius = _first(self.of(formula))
        return radius if radius is not None and radius > 0.0 else 1.0


def split_name(column: str) -> tuple[str, str]:
    """`plant.body.x` -> ("plant.", "body.x"); the component may itself contain dots."""
    parts = column.split(".")
    return ".".join([*parts[:-2], ""]) if len(parts) > 2 else "", ".".join(parts[-2:])


def _components(data: NDArray[Any]) -> dict[str, set[str]]:
    """The variables that the columns of each component name, by prefix."""
    columns: dict[str, set[str]] = {}
    for column in data.dtype.names or ():
        if column != "time":
            prefix, variable = split_name(column)
            columns.setdefault(prefix, set()).add(variable)
    return columns


def drawings_of(
    data: NDArray[Any], known: Sequence[Drawing], given: Mapping[str, Drawing]
) -> dict[str, Drawing]:
    """The drawing of each component in the columns, by prefix.

    `given` are those of components whose FMU is known, by name. For any other it is that of the
    `known` with the most outputs among its columns, of which none may be foreign to it.
    """
    found: dict[str, Drawing] = {}
    for prefix, have in _components(data).items():
        if prefix.rstrip(".") in given:
            found[prefix] = given[prefix.rstrip(".")]
            continue
        fitting = [one for one in known if have <= set(one.units)]
        if fitting:
            found[prefix] = max(
                fitting, key=lambda one: (len(have & set(one.outputs)), -len(one.outputs))
            )
    return found


def find_actors(data: NDArray[Any], drawings: Mapping[str, Drawing]) -> list[Actor]:
    """Every system that the columns of `data` suffice to draw; `drawings` by prefix."""
    found: list[Actor] = []
    poor: list[Actor] = []
    for prefix, have in _components(data).items():
        drawing = drawings.get(prefix)
        actor = _actor(data, prefix, drawing) if drawing is not None and drawing.points else None
        if actor is not None:
            # A controller measures coordinates too: it is no second body.
            shows = {"energy.total", *_positions(actor.drawing)}
            (found if have & shows else poor).append(actor)
    drawn = {actor.kind for actor in found}
    return found + [actor for actor in poor if actor.kind not in drawn][:1]


def missing(data: NDArray[Any], drawings: Iterable[Drawing]) -> str:
    """In words, what the columns lack to be drawn as one of `drawings`."""
    have = {split_name(column)[1] for column in data.dtype.names or ()}
    said = []
    for drawing in drawings:
        if not drawing.points:
            continue
        ways = [list(dict.fromkeys(_positions(drawing))), _coordinates(drawing)]
        needs = " or ".join(" and ".join(way) for way in ways if way)
        best = max(ways, key=lambda way: (len(have & set(way)) / max(len(way), 1), -len(way)))
        lack = [name for name in best if name not in have]
        near = len(lack) < len(best)
        said.append(
            f"{drawing.name} needs {needs}" + (f"; {', '.join(lack)} missing" if near else "")
        )
    return ", ".join(said)


def _positions(drawing: Drawing) -> list[str]:
    """The variables that place the points."""
    return [
        name
        for point in drawing.points
        for text in (point.x, point.y)
        for name in sorted(variables_of(parse(text)))
    ]


def _coordinates(drawing: Drawing) -> list[str]:
    """The outputs from which the points can be placed where their positions lack."""
    frame = set().union(*(variables_of(parse(text)) for text in drawing.frame))
    left: dict[str, None] = {}
    waiting = _positions(drawing)
    seen: set[str] = set()
    while waiting:
        name = waiting.pop(0)
        ways = drawing.otherwise.get(name, ())
        if name in seen or name in frame or name in drawing.values:
            continue
        seen.add(name)
        if ways:
            waiting += sorted(variables_of(parse(ways[0], samples=True)))
        elif name in drawing.outputs:
            left[name] = None
    return list(left)


class _Source:
    """The variables of one component as floats: from its columns, else as the drawing says."""

    def __init__(self, data: NDArray[Any], prefix: str, drawing: Drawing) -> None:
        self._data = data
        self._prefix = prefix
        self._drawing = drawing
        self._frame = set().union(*(variables_of(parse(text)) for text in drawing.frame))
        self._found: dict[str, Floats] = {}
        self._sought: set[str] = set()  # formulas may refer to one another
        self.notes: list[str] = []

    def of(self, formula: str) -> Floats | None:
        """A formula's values, shape (samples,); None where variables of it lack."""
        tree = parse(formula, samples=True)
        values = {name: self.get(name) for name in variables_of(tree)}
        there = {name: array for name, array in values.items() if array is not None}
        if len(there) < len(values):
            return None
        return np.asarray(
            np.broadcast_to(evaluate(tree, there), (len(self._data),)), dtype=np.float64
        )

    def get(self, name: str) -> Floats | None:
        """A variable's values, shape (samples,); None where there is no way to them."""
        if name not in self._found and name not in self._sought:
            self._sought.add(name)
            values = self._look(name)
            self._sought.discard(name)
            if values is not None:
                self._found[name] = values
        return self._found.get(name)

    def _look(self, name: str) -> Floats | None:
        drawing = self._drawing
        if self._prefix + name in (self._data.dtype.names or ()):
            values = np.asarray(self._data[self._prefix + name], dtype=np.float64)
            return np.where(np.isfinite(values), values, np.nan)
        size = len(self._data)
        if drawing.known and name in drawing.values:
            return np.full(size, drawing.values[name])
        for formula in drawing.otherwise.get(name, ()):
            values_or_none = self.of(formula)
            if values_or_none is not None and np.isfinite(values_or_none).any():
                return values_or_none
        if name in self._frame:  # a frame that is not recorded is drawn at rest
            return np.zeros(size)
        if name in drawing.values:
            value, unit = drawing.values[name], drawing.units[name]
            words = drawing.words_of(name)[1]
            self.notes.append(f"the {words} is not in the columns: drawn as {value:g} {unit}")
            return np.full(size, value)
        return None


def _first(values: Floats) -> float | None:
    """The first number in `values`: at the start the constraints hold to rounding."""
    good = values[np.isfinite(values)]
    return float(good[0]) if good.size else None


def _actor(data: NDArray[Any], prefix: str, drawing: Drawing) -> Actor | None:
    """The actor of a component, or None where its columns do not suffice."""
    source = _Source(data, prefix, drawing)
    places: dict[str, Floats] = {}
    for name, *formulas in (
        *((point.name, point.x, point.y) for point in drawing.points),
        (FRAME, *drawing.frame),
    ):
        for axis, formula in zip("xy", formulas, strict=True):
            values = source.of(formula)
            if values is None:
                return None
            places[f"{name} {axis}"] = values
    for formula in (
        *(text for circle in drawing.circles for text in circle[:3]),
        *(text for curve in drawing.curves for text in (curve.x, curve.y)),
    ):
        for name in sorted(variables_of(parse(formula)) - {"s"}):
            values = source.get(name)
            if values is None:
                return None
            places[name] = values
    actor = Actor(drawing, prefix, 1.0, places, tuple(source.notes))
    return Actor(drawing, prefix, _size(actor), places, actor.notes)


def _size(actor: Actor) -> float:
    """The radius of the first circle, the length of the first rod, or the span of the motion."""
    drawing = actor.drawing
    if drawing.circles:
        size = actor.radius(drawing.circles[0].radius)
    elif drawing.rods:
        (ax, ay), (bx, by) = (actor.at(end) for end in drawing.rods[0])
        size = _first(np.hypot(bx - ax, by - ay)) or 0.0
    else:
        frame_x, frame_y = actor.at(FRAME)
        apart = np.concatenate([np.hypot(x - frame_x, y - frame_y) for _, x, y in actor.points()])
        apart = apart[np.isfinite(apart)]
        size = float(np.percentile(apart, 90.0)) if apart.size else 0.0
    # A size that is not above zero is that of a damaged file; the drawing goes on.
    return size if np.isfinite(size) and size > 0.0 else 1.0

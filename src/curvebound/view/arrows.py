"""Which arrows of velocities and forces a result suffices to draw, and what the others lack."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ..errors import CurveboundError
from ..fmi.drawing import Arrow, Drawing
from ..fmi.formula import Floats, evaluate, parse
from .actors import Actor
from .packing import Packer

__all__ = ["ALL", "Kind", "Vector", "kinds_of", "lacking", "packed", "vectors_of", "wanted"]

ALL = "all"


@dataclass(frozen=True)
class Vector:
    """An arrow over time: (x, y) in the arrow's unit, shape (samples,)."""

    arrow: Arrow
    x: Floats
    y: Floats

    @property
    def size(self) -> float:
        """A magnitude that few samples exceed; 0 where it is nothing all the time."""
        sizes = np.hypot(self.x, self.y)
        sizes = sizes[np.isfinite(sizes)]
        if not sizes.size:
            return 0.0
        usual = float(np.percentile(sizes, 95.0))
        return usual or float(sizes.max())


@dataclass(frozen=True)
class Kind:
    """Arrows of one name and unit, which are shown together.

    size: the greatest of theirs. lacks: in words, what is not there to draw some of them.
    drawn: whether there are any.
    """

    name: str
    symbol: str
    unit: str
    size: float
    lacks: tuple[str, ...]
    drawn: bool


def vectors_of(actor: Actor, data: NDArray[Any]) -> list[Vector]:
    """The arrows whose variables the columns hold, or the run is known to have had.

    Nothing is guessed: what the drawing puts in place of a variable that lacks is no measurement.
    """
    drawing, made = actor.drawing, []
    for arrow in drawing.arrows:
        if lacking(arrow, drawing, actor.prefix, data):
            continue
        values: dict[str, Floats | float] = {
            name: _values(name, drawing, actor.prefix, data) for name in sorted(arrow.variables())
        }
        x, y = (
            np.broadcast_to(evaluate(parse(text), values), (len(data),))
            for text in (arrow.x, arrow.y)
        )
        made.append(Vector(arrow, np.asarray(x, np.float64), np.asarray(y, np.float64)))
    return made


def packed(vectors: Sequence[Vector], packer: Packer) -> list[dict[str, Any]]:
    """Arrows as a page knows them: their kind, where they begin, and the channels of x and y."""
    return [
        {
            "kind": [one.arrow.name, one.arrow.unit],
            "at": one.arrow.at,
            "values": [packer.signal(one.x), packer.signal(one.y)],
        }
        for one in vectors
    ]


def lacking(arrow: Arrow, drawing: Drawing, prefix: str, data: NDArray[Any]) -> list[str]:
    """The variables that an arrow needs and that are neither recorded nor known."""
    known = drawing.values if drawing.known else {}
    there = data.dtype.names or ()
    return [
        name
        for name in sorted(arrow.variables())
        if prefix + name not in there and name not in known
    ]


def kinds_of(shown: Iterable[tuple[str, Actor, NDArray[Any]]]) -> list[Kind]:
    """The kinds of arrows of actors, given with label and data, in the order of declaration."""
    found: dict[tuple[str, str], Kind] = {}
    given = list(shown)
    for label, actor, data in given:
        sizes = {id(one.arrow): one.size for one in vectors_of(actor, data)}
        for arrow in actor.drawing.arrows:
            key = (arrow.name, arrow.unit)
            before = found.get(key, Kind(arrow.name, arrow.symbol, arrow.unit, 0.0, (), False))
            lacks = before.lacks
            if names := lacking(arrow, actor.drawing, actor.prefix, data):
                where = f" of {label}" if len(given) > 1 else ""
                lacks = tuple(dict.fromkeys([*lacks, f"{', '.join(names)}{where} not recorded"]))
            found[key] = Kind(
                arrow.name,
                arrow.symbol,
                arrow.unit,
                max(before.size, sizes.get(id(arrow), 0.0)),
                lacks,
                before.drawn or id(arrow) in sizes,
            )
    return list(found.values())


def wanted(text: str, kinds: Sequence[Kind]) -> list[Kind]:
    """The kinds that `text` names, with commas between, or all that can be drawn.

    Raises CurveboundError where one is not there, or what it needs is not recorded.
    """
    if text.strip().lower() == ALL:
        return [kind for kind in kinds if kind.drawn]
    chosen = []
    for name in text.split(","):
        found = [kind for kind in kinds if kind.name.lower() == name.strip().lower()]
        if not found:
            known = ", ".join(kind.name for kind in kinds) or "there are none"
            raise CurveboundError(f"There is no arrow {name.strip()!r}: choose of {known}; or all.")
        for kind in found:
            if not kind.drawn:
                raise CurveboundError(f"{kind.name}: {'; '.join(kind.lacks)}: record that first.")
        chosen += found
    return chosen


def _values(name: str, drawing: Drawing, prefix: str, data: NDArray[Any]) -> Floats | float:
    if prefix + name not in (data.dtype.names or ()):
        return drawing.values[name]
    values = np.asarray(data[prefix + name], dtype=np.float64)
    return np.where(np.isfinite(values), values, np.nan)

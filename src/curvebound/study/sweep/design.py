"""Which points a sweep visits: a grid, or a Latin hypercube."""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass

import numpy as np

from ...cosim.fmu import Value
from ...errors import CurveboundError
from ...units import number

__all__ = ["Axis", "Design", "axis"]

_MOST = 1_000_000  # points of a design: some kB of memory, and a run, each
_FORM = "component.variable=LOW:HIGH:N, LOW:HIGH:N:log or a,b,c"


@dataclass(frozen=True)
class Axis:
    """One parameter that varies: between `low` and `high` in `count` values, or over `items`.

    logarithmic: whether steps are equal in the logarithm; count 0: for a Latin hypercube only.
    """

    path: str
    low: float = 0.0
    high: float = 0.0
    count: int = 0
    logarithmic: bool = False
    items: tuple[Value, ...] = ()

    def at(self, share: float) -> Value:
        """The value at a share of the range, 0 to 1."""
        if self.items:
            return self.items[min(int(share * len(self.items)), len(self.items) - 1)]
        if self.logarithmic:
            size = math.exp(
                math.log(abs(self.low)) * (1.0 - share) + math.log(abs(self.high)) * share
            )
            return math.copysign(size, self.low)
        return self.low * (1.0 - share) + self.high * share

    def values(self) -> list[Value]:
        """The values of a grid, both ends exact."""
        if self.items:
            return list(self.items)
        if self.count == 1:
            return [self.low]
        inner = [self.at(i / (self.count - 1)) for i in range(1, self.count - 1)]
        return [self.low, *map(_round, inner), self.high]


def axis(text: str) -> Axis:
    """An axis from a command line, see _FORM; CurveboundError on anything else."""
    path, equals, rest = text.partition("=")
    path = path.strip()
    parts = rest.split(":")
    try:
        if not (equals and path and rest):
            raise ValueError
        if len(parts) == 1:
            items = tuple(_item(word.strip()) for word in rest.split(","))
            _require_finite(text, items)
            return Axis(path, items=items)
        logarithmic = parts[-1] == "log"
        numbers = parts[:-1] if logarithmic else parts
        if len(numbers) not in (2, 3):
            raise ValueError
        low, high = number(numbers[0]), number(numbers[1])
        count = int(numbers[2]) if len(numbers) == 3 else 0
    except ValueError:
        raise CurveboundError(f"--vary {text!r} is not of the form {_FORM}.") from None
    _require_finite(text, (low, high))
    if len(numbers) == 3 and count < 1:
        raise CurveboundError(f"--vary {text!r}: give 1 value or more, not {count}.")
    if logarithmic and not (low and high and (low > 0.0) == (high > 0.0)):
        raise CurveboundError(f"--vary {text!r}: log needs two ends of one sign, neither zero.")
    return Axis(path, low, high, count, logarithmic)


def _require_finite(text: str, values: Sequence[Value]) -> None:
    for value in values:
        if isinstance(value, float) and not math.isfinite(value):
            raise CurveboundError(f"--vary {text!r}: values must be finite, not {value}.")


def _item(word: str) -> Value:
    try:
        return float(word)
    except ValueError:
        return word


def _round(value: Value) -> Value:
    """3 for 3.0000000000000004: whole numbers and enumerations are taken exactly only."""
    short = float(f"{value:.12g}")
    return short if abs(short - float(value)) <= 4.0 * math.ulp(short) else value


class Design:
    """The points of a sweep, numbered from 0.

    latin: 0 for the full grid over all axes, the last one fastest; else the number of points of a
        Latin hypercube, drawn with `seed`.
    """

    def __init__(self, axes: Sequence[Axis], latin: int = 0, seed: int = 0) -> None:
        if not axes:
            raise CurveboundError(f"Nothing varies: give --vary {_FORM}.")
        paths = [one.path for one in axes]
        if len(set(paths)) < len(paths):
            raise CurveboundError("A parameter is varied twice; keep one --vary of each.")
        for one in axes:
            if not latin and not one.items and not one.count:
                raise CurveboundError(
                    f"--vary {one.path}: say in how many values, {one.low:g}:{one.high:g}:N, or "
                    "take a sample with --latin N."
                )
        count = latin or math.prod(len(one.items) or one.count for one in axes)
        if count > _MOST:
            raise CurveboundError(
                f"The sweep has {count} points, and may have {_MOST} at most: take fewer values, "
                "or a sample with --latin N."
            )
        self.axes = list(axes)
        self.latin = latin
        self.seed = seed
        self._values = [one.values() for one in axes] if not latin else []
        self._shares = self._hypercube() if latin else np.zeros((0, 0))

    def _hypercube(self) -> np.ndarray:
        """Shares, shape (points, axes): in each axis one point in each of `latin` equal parts."""
        random = np.random.default_rng(self.seed)
        columns = [
            (random.permutation(self.latin) + random.random(self.latin)) / self.latin
            for _ in self.axes
        ]
        return np.stack(columns, axis=1)

    def __len__(self) -> int:
        if self.latin:
            return self.latin
        return math.prod(len(values) for values in self._values)

    def __getitem__(self, index: int) -> dict[str, Value]:
        """The values of a point by path."""
        if not 0 <= index < len(self):
            raise IndexError(index)
        if self.latin:
            row = self._shares[index]
            return {one.path: one.at(float(x)) for one, x in zip(self.axes, row, strict=True)}
        point: dict[str, Value] = {}
        for one, values in zip(reversed(self.axes), reversed(self._values), strict=True):
            index, place = divmod(index, len(values))
            point[one.path] = values[place]
        return {one.path: point[one.path] for one in self.axes}

    def __iter__(self) -> Iterator[dict[str, Value]]:
        return (self[i] for i in range(len(self)))

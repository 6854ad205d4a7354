"""Whether every coordinate moves a mass: else there is no acceleration to derive."""

from __future__ import annotations

import random
from collections.abc import Iterator, Sequence
from itertools import combinations

from sympy import Expr, Rational, Symbol

from .elements import Coordinate, Mass

__all__ = ["without_inertia"]

_DIGITS = 60
#: slopes of random states that are below it are zero but for rounding
_NOTHING = 1e-40
#: states that are tried, and how many of them must agree where none has full rank
_TRIED = 12
_AGREE = 3


def without_inertia(coordinates: Sequence[Coordinate], masses: Sequence[Mass]) -> str:
    """What is wrong where the mass matrix is singular at every state; empty where it is not.

    Its determinant is a sum of squared minors of the Jacobian of the positions, so that it is zero
    where the Jacobian's rank is less than the number of coordinates; the rank is that at a few
    random states, with 60 digits.
    """
    slopes = [[e.diff(c) for c in coordinates] for m in masses for e in (m.x, m.y)]
    still = set(coordinates)
    seen = 0
    for rows in _values(slopes):
        still = {c for k, c in enumerate(coordinates) if c in still and not _any(rows, k)}
        if not still and (len(coordinates) == 1 or _rank_is_two(rows)):
            return ""
        seen += 1
        if seen == _AGREE:
            break
    if seen < _AGREE:
        return ""  # nowhere a number: what that comes from is refused when it is derived
    for c in coordinates:
        if c in still:
            return (
                f"coordinate {c} moves no mass: no position depends on it, so that it has no "
                "inertia; let a mass move with it, or leave it out"
            )
    first, second = coordinates
    return (
        f"the masses move with a combination of {first} and {second} only, so that the mass matrix "
        "is singular at every state: state the positions by one coordinate, or let a mass move "
        "with each"
    )


def _values(slopes: list[list[Expr]]) -> Iterator[list[list[Expr]]]:
    """The slopes at random states, where they are numbers."""
    rng = random.Random(1)
    symbols: list[Symbol] = sorted(
        {s for row in slopes for e in row for s in e.free_symbols}, key=str
    )
    for _ in range(_TRIED):
        at = {s: Rational(rng.randint(300, 950), 1001) for s in symbols}
        rows = [[e.xreplace(at).n(_DIGITS) for e in row] for row in slopes]
        if all(e.is_number and e.is_finite for row in rows for e in row):
            yield rows


def _any(rows: list[list[Expr]], column: int) -> bool:
    return any(abs(row[column]) > _NOTHING for row in rows)


def _rank_is_two(rows: list[list[Expr]]) -> bool:
    return any(abs(a[0] * b[1] - a[1] * b[0]) > _NOTHING for a, b in combinations(rows, 2))

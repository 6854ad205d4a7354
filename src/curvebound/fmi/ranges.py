"""Ranges of a system's variables that are worth exploring, as fmu.py declares them."""

from __future__ import annotations

from typing import NamedTuple

__all__ = ["Angle", "Explored", "Items", "Range"]


class Range(NamedTuple):
    """A size drawn uniformly in its logarithm between `low` and `high`.

    signed: of either sign. share: of the points in which it is drawn; it is 0 in the others.
    times: another variable by which it is multiplied. speed: the size is the speed (m/s) of the
    mass that a rate moves, not the rate.
    """

    low: float
    high: float
    signed: bool = False
    share: float = 1.0
    times: str = ""
    speed: bool = False


class Angle(NamedTuple):
    """Anywhere on the circle; in a share of the points many turns on."""

    share_of_turns: float = 0.1
    turns: int = 1000


class Items(NamedTuple):
    """One of the items of an enumeration; one that is named more often is drawn more often."""

    items: tuple[str, ...]


Explored = Range | Angle | Items

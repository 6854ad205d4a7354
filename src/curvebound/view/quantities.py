"""What the variables are called in pictures, and which of them share a plot.

Both come from the drawings that the FMUs carry.
"""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass

from ..fmi.drawing import Drawing, Plot

__all__ = ["Quantity", "plots_of", "quantity", "readouts_of"]


@dataclass(frozen=True)
class Quantity:
    """One variable for the eye: its name under a plot's title, its unit, whether it is an error.

    An error is kept with constant relative accuracy, so that a logarithmic axis works. `name`
    needs no title to be understood.
    """

    label: str
    unit: str
    error: bool
    name: str


def quantity(variable: str, drawing: Drawing | None) -> Quantity:
    """The quantity behind `variable`, a name without its component; an unknown one names itself."""
    if drawing is None or variable not in drawing.units:
        return Quantity(variable, "", False, variable)
    label, name = drawing.words_of(variable)
    error = any(variable in plot.names for plot in drawing.plots if plot.error)
    return Quantity(label, drawing.units[variable], error, name)


def plots_of(drawings: Iterable[Drawing]) -> list[Plot]:
    """The plots of all drawings in their order, those of one title united."""
    made: list[Plot] = []
    for drawing in drawings:
        place = 0
        for plot in drawing.plots:
            titles = [one.title for one in made]
            if plot.title in titles:
                place = titles.index(plot.title)
                names = dict.fromkeys((*made[place].names, *plot.names))
                made[place] = made[place]._replace(names=tuple(names))
            else:
                made.insert(place, plot)
            place += 1
    return made


def readouts_of(drawings: Iterable[Drawing]) -> list[str]:
    """The variables to tell beside the picture, those of all drawings in their order."""
    made: list[str] = []
    for drawing in drawings:
        place = 0
        for name in drawing.readouts:
            if name in made:
                place = made.index(name)
            else:
                made.insert(place, name)
            place += 1
    return made

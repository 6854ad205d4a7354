"""A bead on a circular wire whose centre is moved, in the formulation that is asked for."""

from __future__ import annotations

from typing import Final

from .angle import BeadAngle
from .base import BeadBase
from .cartesian import BeadCartesian

__all__ = ["BeadAngle", "BeadCartesian", "model"]

LAGRANGE_MULTIPLIER: Final = 1
ANGLE: Final = 2


def model(choices: dict[str, int]) -> BeadBase:
    """The bead in the formulation that model.formulation names; raises ValueError for no such."""
    formulation = choices["model.formulation"]
    if formulation == LAGRANGE_MULTIPLIER:
        return BeadCartesian()
    if formulation == ANGLE:
        return BeadAngle()
    raise ValueError(
        f"model.formulation is {formulation}: choose 1 (lagrange_multiplier) or 2 (angle)"
    )

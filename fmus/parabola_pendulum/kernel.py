"""The pendulum hung from a slider on a parabola, in the fidelity that is asked for."""

from __future__ import annotations

from typing import Final

from .base import ParabolaBase
from .linear import ParabolaLinear
from .nonlinear import ParabolaNonlinear

__all__ = ["ParabolaLinear", "ParabolaNonlinear", "model"]

LINEAR: Final = 1
NONLINEAR: Final = 2


def model(choices: dict[str, int]) -> ParabolaBase:
    """The pendulum in the fidelity that model.fidelity names; raises ValueError for no such."""
    fidelity = choices["model.fidelity"]
    if fidelity == LINEAR:
        return ParabolaLinear()
    if fidelity == NONLINEAR:
        return ParabolaNonlinear()
    raise ValueError(f"model.fidelity is {fidelity}: choose 1 (linear) or 2 (nonlinear)")

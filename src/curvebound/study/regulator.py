"""Gains that hold a system at a state of rest, from the linear-quadratic regulator."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np

from ..errors import CurveboundError, nearest
from .extras import require
from .linear_model import LinearModel

__all__ = ["gains"]


def gains(
    model: LinearModel,
    *,
    weights: Mapping[str, float] | None = None,
    effort: float = 1.0,
) -> dict[str, float]:
    """The feedback u = -K x of one input that minimises a quadratic cost: gains by state.

    model: see linearize(). The cost is the integral of sum_i w_i x_i^2 + effort u^2 over time, with
    weights w_i by the names of states (default 1 each); K comes from the continuous algebraic
    Riccati equation (Kalman 1960; scipy.linalg.solve_continuous_are).
    Raises CurveboundError when no feedback stabilises the system or scipy is not there.
    """
    require("study")
    from scipy.linalg import solve_continuous_are

    if len(model.inputs) != 1:
        raise CurveboundError(f"Gains are for one input; the model has {len(model.inputs)}.")
    for name in weights or {}:
        if name not in model.states:
            raise CurveboundError(f"There is no state {name}; " + nearest(name, model.states))
    cost = np.diag([float((weights or {}).get(name, 1.0)) for name in model.states])
    try:
        solution = solve_continuous_are(model.A, model.B, cost, np.array([[effort]]))
    except (np.linalg.LinAlgError, ValueError) as error:
        raise CurveboundError(f"No feedback by {model.inputs[0]} stabilises it: {error}") from error
    row = (model.B.T @ solution / effort)[0]
    modes = np.linalg.eigvals(model.A - model.B @ row[None, :])
    if not modes.real.max() < -1e-9 * np.abs(modes).max():
        raise CurveboundError(f"No feedback by {model.inputs[0]} stabilises it.")
    return {name: float(gain) for name, gain in zip(model.states, row, strict=True)}

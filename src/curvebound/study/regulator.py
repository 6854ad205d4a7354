"""Gains that hold the pendulum on the parabola, from the linear-quadratic regulator."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np
from numpy.typing import NDArray

from ..errors import CurveboundError
from .extras import require

__all__ = ["STATES", "gains", "linear_model"]

STATES = (
    "slider_u",
    "slider_u_rate",
    "pendulum_angle",
    "pendulum_angular_velocity",
    "parabola_x",
    "parabola_vx",
)
"""The measured states, in the order of rows and columns here, as the drive names its gains."""

_DEFAULTS = {
    "parabola.coefficient_start": 0.5,
    "slider.mass": 1.0,
    "pendulum.mass": 1.0,
    "pendulum.length": 1.0,
    "slider.damping": 0.0,
    "pendulum.damping": 0.0,
    "gravity.y": -9.81,
}


def linear_model(
    parameters: Mapping[str, float] | None = None, *, upright: bool = False
) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """State matrix A, shape (6, 6), and input column B, shape (6, 1), about an equilibrium.

    x' = A x + B X'' with the states of STATES in SI units, the pendulum's angle measured from
    hanging (or, with upright=True, from upright) and X'' the acceleration of the vertex along x in
    m/s2. parameters: those of the ParabolaPendulum FMU that differ from its defaults.

    From the quadratic part of the Lagrangian: with s = 1 hanging and s = -1 upright,
    (m1+m2) u'' + s m2 r th'' = -(m1+m2)(2 g a u + X'') - c1 u' and
    s m2 r u'' + m2 r^2 th'' = -s m2 r (g th + X'') - c2 th'.
    """
    p = {**_DEFAULTS, **(parameters or {})}
    unknown = p.keys() - _DEFAULTS.keys()
    if unknown:
        raise CurveboundError(
            f"The linear model has no parameter {', '.join(sorted(unknown))}; "
            f"it takes {', '.join(_DEFAULTS)}."
        )
    m1, m2, r = p["slider.mass"], p["pendulum.mass"], p["pendulum.length"]
    a, g = p["parabola.coefficient_start"], -p["gravity.y"]
    s = -1.0 if upright else 1.0
    mass = np.array([[m1 + m2, s * m2 * r], [s * m2 * r, m2 * r * r]])
    stiffness = np.diag([(m1 + m2) * 2.0 * g * a, s * m2 * g * r])
    damping = np.diag([p["slider.damping"], p["pendulum.damping"]])
    push = np.array([[m1 + m2], [s * m2 * r]])
    # rows of the accelerations, columns (u, th), (u', th'), X''
    by_position = -np.linalg.solve(mass, stiffness)
    by_rate = -np.linalg.solve(mass, damping)
    by_input = -np.linalg.solve(mass, push)
    system = np.zeros((6, 6))
    column = np.zeros((6, 1))
    for i in range(2):
        system[2 * i, 2 * i + 1] = 1.0
        for j in range(2):
            system[2 * i + 1, 2 * j] = by_position[i, j]
            system[2 * i + 1, 2 * j + 1] = by_rate[i, j]
        column[2 * i + 1, 0] = by_input[i, 0]
    system[4, 5] = 1.0
    column[5, 0] = 1.0
    return system, column


def gains(
    parameters: Mapping[str, float] | None = None,
    *,
    upright: bool = False,
    weights: Mapping[str, float] | None = None,
    effort: float = 1.0,
) -> dict[str, float]:
    """Parameters feedback.* of the ParabolaDrive FMU that minimise a quadratic cost.

    The cost is the integral of sum_i w_i x_i^2 + effort X''^2 over time, with weights w_i by the
    names of STATES (default 1 each); the feedback X'' = -K x that minimises it comes from the
    continuous algebraic Riccati equation (Kalman 1960; scipy.linalg.solve_continuous_are).
    Raises CurveboundError when no feedback stabilises the system or scipy is not there.
    """
    require("study")
    from scipy.linalg import solve_continuous_are

    weights = weights or {}
    unknown = weights.keys() - set(STATES)
    if unknown:
        raise CurveboundError(
            f"There is no state {', '.join(sorted(unknown))}; the states are {', '.join(STATES)}."
        )
    system, column = linear_model(parameters, upright=upright)
    cost = np.diag([float(weights.get(name, 1.0)) for name in STATES])
    try:
        solution = solve_continuous_are(system, column, cost, np.array([[effort]]))
    except (np.linalg.LinAlgError, ValueError) as error:
        raise CurveboundError(
            f"No feedback stabilises the pendulum with these parameters: {error}"
        ) from error
    row = (column.T @ solution / effort)[0]
    return {f"feedback.{name}": float(gain) for name, gain in zip(STATES, row, strict=True)}

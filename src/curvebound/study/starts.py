"""Ensembles of initial values about those of a scene."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

if TYPE_CHECKING:
    from ..cosim.system import System

__all__ = ["initial_values", "surrounding", "unseen"]


def initial_values(system: System) -> dict[str, float]:
    """The initial values of a scene by path, those that are not zero: parameters `*_start`."""
    found: dict[str, float] = {}
    for name, node in system.nodes.items():
        for variable in node.fmu.variables.values():
            if not (variable.name.endswith("_start") and variable.kind == "Real"):
                continue
            value = float(node.start.get(variable.name, variable.start or 0.0))
            if value != 0.0:
                found[f"{name}.{variable.name}"] = value
    return found


def surrounding(
    system: System, spread: float, count: int, seed: int = 0
) -> dict[str, NDArray[np.float64]]:
    """The scene's own start and `count` more around it, as arrays (1 + count,) by path.

    Half are corners of the box within `spread` (relative), the extremes along its diagonal first:
    errors mostly grow with the size of the motion. The rest is a Latin hypercube.
    """
    own = initial_values(system)
    random = np.random.default_rng(seed)
    dimensions = len(own)
    corners = [np.ones(dimensions), -np.ones(dimensions)]
    while len(corners) < (count + 1) // 2:
        corners.append(random.choice([-1.0, 1.0], dimensions))
    inside = count - len(corners)
    columns = [
        (random.permutation(inside) + random.random(inside)) / max(1, inside) * 2.0 - 1.0
        for _ in range(dimensions)
    ]
    points = [np.zeros(dimensions), *corners[:count]]
    points += [np.array([column[i] for column in columns]) for i in range(max(0, inside))]
    return _scaled(own, np.array(points), spread)


def unseen(
    system: System, spread: float, count: int, seed: int = 1
) -> dict[str, NDArray[np.float64]]:
    """`count` starts drawn evenly from the same box, as arrays (count,) by path."""
    own = initial_values(system)
    points = np.random.default_rng([seed, 12345]).uniform(-1.0, 1.0, (count, len(own)))
    return _scaled(own, points, spread)


def _scaled(own: dict[str, float], points: NDArray[Any], spread: float) -> dict[str, Any]:
    return {
        path: value * (1.0 + spread * points[:, i]) for i, (path, value) in enumerate(own.items())
    }

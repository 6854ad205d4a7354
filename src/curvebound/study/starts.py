"""Ensembles of initial values about those of a scene.

Starts vary in proportion to their size; where feedback holds the value at a set point, in
proportion to their distance from it (upright is an angle of pi, and a fifth of that is a fall), and
what the gains of the feedback are made for, the parabola's shape, stays.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from .reference.monolith import equations_of

if TYPE_CHECKING:
    from ..cosim.system import System

__all__ = ["initial_values", "set_points", "surrounding", "unseen"]


def initial_values(system: System) -> dict[str, float]:
    """The initial values of a scene that can vary, by path: parameters `*_start`, not zero.

    One that is the set point of feedback already has no distance from it that could vary.
    """
    found: dict[str, float] = {}
    held, shapes = _held(system)
    for name, node in system.nodes.items():
        for variable in node.fmu.variables.values():
            if not (variable.name.endswith("_start") and variable.kind == "Real"):
                continue
            path = f"{name}.{variable.name}"
            value = float(node.start.get(variable.name, variable.start or 0.0))
            if path not in shapes and value not in (0.0, held.get(path)):
                found[path] = value
    return found


def set_points(system: System) -> dict[str, float]:
    """The values at which feedback holds what begins at a parameter `*_start`, by its path."""
    own = initial_values(system)
    return {path: value for path, value in _held(system)[0].items() if path in own}


def _held(system: System) -> tuple[dict[str, float], set[str]]:
    """Set points of feedback, and the shapes that it was made for, by path of the start value."""
    held: dict[str, float] = {}
    shapes: set[str] = set()
    for link in system.links:
        (name, measured), (law, which) = link.source, link.target
        equations = equations_of(system.nodes[law], {})
        points = equations.set_points()
        if which in points:
            held[f"{name}.{measured}_start"] = points[which]
            shapes.update(f"{name}.{shape}" for shape in equations.DESIGNED_FOR)
    return held, shapes


def surrounding(
    system: System, spread: float, count: int, seed: int = 0
) -> dict[str, NDArray[np.float64]]:
    """The scene's own start and `count` more around it, as arrays (1 + count,) by path.

    Up to half are corners of the box within `spread` (relative), the extremes along its diagonal
    first: errors mostly grow with the size of the motion. The rest is a Latin hypercube.
    """
    own = initial_values(system)
    random = np.random.default_rng(seed)
    dimensions = len(own)
    corners = [np.ones(dimensions), -np.ones(dimensions)]
    while len(corners) < min((count + 1) // 2, 2**dimensions):
        corner = random.choice([-1.0, 1.0], dimensions)
        if not any(np.array_equal(corner, other) for other in corners):
            corners.append(corner)
    inside = max(0, count - len(corners))
    columns = [
        (random.permutation(inside) + random.random(inside)) / max(1, inside) * 2.0 - 1.0
        for _ in range(dimensions)
    ]
    points = [np.zeros(dimensions), *corners[:count]]
    points += [np.array([column[i] for column in columns]) for i in range(inside)]
    return _scaled(own, set_points(system), np.array(points), spread)


def unseen(
    system: System, spread: float, count: int, seed: int = 1
) -> dict[str, NDArray[np.float64]]:
    """`count` starts drawn evenly from the same box, as arrays (count,) by path."""
    own = initial_values(system)
    points = np.random.default_rng([seed, 12345]).uniform(-1.0, 1.0, (count, len(own)))
    return _scaled(own, set_points(system), points, spread)


def _scaled(
    own: dict[str, float], centres: dict[str, float], points: NDArray[Any], spread: float
) -> dict[str, Any]:
    """Values by path; points, shape (count, len(own)): -1 to 1, where 1 is the full spread."""
    return {
        path: value + (value - centres.get(path, 0.0)) * spread * points[:, i]
        for i, (path, value) in enumerate(own.items())
    }

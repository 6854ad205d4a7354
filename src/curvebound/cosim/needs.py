"""Whether a run meets what its scene states that it needs."""

from __future__ import annotations

from collections.abc import Mapping
from typing import TypeVar

import numpy as np

from .prepared import Prepared
from .resolution import resolve
from .results import Result
from .scene_data import SceneData

__all__ = ["errors_of", "precise", "unmet"]

#: relative tolerance at which the equations are solved to see the error of a run
TOLERANCE = 1e-12
_METHOD, _PRECISE = "solver.method", "adaptive"

AnyScene = TypeVar("AnyScene", bound=SceneData)


def precise(scene: AnyScene) -> AnyScene | None:
    """The same scene, each component solving its equations to 1e-12; None where none can.

    Macro steps, held inputs and models stay: they are what the scene is.
    """
    other = scene.copy()
    able = 0
    for name, node in resolve(scene).nodes.items():
        method = node.fmu.variables.get(_METHOD)
        if method is not None and method.is_settable_start and _PRECISE in (method.items or {}):
            other.components[name].start[_METHOD] = _PRECISE
            able += 1
    other.tolerance = TOLERANCE
    return other if able else None


def errors_of(scene: SceneData, result: Result) -> dict[str, float]:
    """Largest error of each output that the scene bounds, in its unit; empty where none is known.

    result: a run of the scene in which these outputs are recorded.
    """
    bounded = [path for path in scene.needs.errors if path in result.names]
    other = precise(scene) if bounded else None
    if other is None:
        return {}
    other.recorded = bounded
    with Prepared(other) as prepared:
        exact = prepared.run()
    return {
        path: float(np.abs(result[path] - np.interp(result.time, exact.time, exact[path])).max())
        for path in bounded
    }


def unmet(scene: SceneData, result: Result, errors: Mapping[str, float]) -> list[str]:
    """Which of its needs a run of the scene does not meet, one sentence each.

    errors: those of errors_of. The budget is that of the steps' wall time, which loading and
    initialization are no part of.
    """
    found = []
    for path, error in errors.items():
        bound, unit = scene.needs.errors[path], result.units.get(path, "")
        if not error <= bound:
            found.append(
                f"The error of {path} reaches {error:.3g} {unit}".rstrip()
                + f" where the scene needs {bound:.3g}: see curvebound tune."
            )
    simulated = float(result.time[-1] - result.time[0])
    spent = result.stepping / simulated
    budget, rate = scene.needs.budget, scene.needs.frame_rate
    if budget is not None and spent > budget:
        found.append(f"It takes {spent:.3g} s per simulated second; its budget is {budget:.3g} s.")
    shown = (len(result.time) - 1) / simulated
    if rate is not None and shown < rate * (1.0 - 1e-9):
        found.append(
            f"{shown:.4g} points are recorded in a simulated second; it needs {rate:.4g} for its "
            "pictures."
        )
    return found

"""How a simpler model's error falls with the size of the motion: rows at smaller starts.

At the scene's own start a model is right or wrong once; whether model.acceleration_error foretells
it shows only over motions of many sizes.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from typing import TYPE_CHECKING, Any

import numpy as np

from ..reference.equations import system_of
from ..reference.reference_set import ReferenceSet
from ..runner import Runner
from ..settings import Setting
from ..starts import initial_values, set_points

if TYPE_CHECKING:
    from ...cosim.fmu import Fmu
    from ...cosim.system import System

__all__ = ["FACTORS", "amplitude_rows"]

Row = dict[str, Any]

#: of the scene's own start values
FACTORS = (0.01, 0.03, 0.1, 0.3)
_TOLERANCE = 1e-11  # of `adaptive`: what is left is the model's error


def amplitude_rows(runner: Runner, known: Mapping[str, Row]) -> Iterator[Row]:
    """Rows with purpose `amplitude`, one per simpler model and factor; from `known` by their key.

    Empty where the scene has no simpler model, begins at rest, or is held away from it by feedback.
    """
    space, system = runner.space, runner.space.system
    start = _motion(system)
    if not start or not any(space.approximate):
        return
    factors = np.array(FACTORS)
    changes = {path: value * factors for path, value in start.items()}
    references = ReferenceSet(system, space.best_model, runner.paths, changes=changes)
    for structure, simpler in zip(space.structures, space.approximate, strict=True):
        if not simpler:
            continue
        scene = runner.scene
        setting = Setting(
            structure, "adaptive", _TOLERANCE, scene.step, scene.algorithm, scene.hold
        )
        for member, factor in enumerate(FACTORS):
            key = f"amplitude|{setting.key}|{factor!r}"
            if key in known:
                yield known[key]
                continue
            smaller = {path: value * factor for path, value in start.items()}
            outcome = runner.run(setting, smaller)
            if outcome.failure or len(outcome.times) < 2:
                continue
            verdicts = references.errors(outcome.times, outcome.outputs, member=member)
            exact = references.values(space.best_model, outcome.times)
            error = max(v.worst for v in verdicts.values())
            yield {
                "purpose": "amplitude", "form": setting.form, "method": setting.method,
                "size_is": "tolerance", "size": setting.size, "macro_step": setting.step,
                "algorithm": setting.algorithm, "cpu": outcome.cpu, "factor": factor,
                "acceleration_error": outcome.measures.get("model.acceleration_error"),
                "amplitude": max(float(np.ptp(exact[p][:, member])) for p in runner.paths),
                "error": error, "numerical": 0.0, "modelling": error, "failure": "",
                "judged": all(v.judged for v in verdicts.values()),
                "judged_until": min(v.until for v in verdicts.values()),
                "key": key,
            }  # fmt: skip


def _motion(system: System) -> dict[str, float]:
    """Start values that are motion, by path; none where feedback holds it away from rest."""
    if any(point != 0.0 for point in set_points(system).values()):
        return {}
    shapes = {
        f"{name}.{shape}_start"
        for name, node in system.nodes.items()
        for shape in _shapes(node.fmu)
    }
    return {path: value for path, value in initial_values(system).items() if path not in shapes}


def _shapes(fmu: Fmu) -> tuple[str, ...]:
    derived = system_of(fmu).derived
    return derived.shapes if derived is not None else ()

"""How the outputs of a model change with its inputs, within the same instant.

Forces are affine in the inputs, accelerations therefore, and the reactions with them:
y(u) = y(0) + J u. So J s = (y(h s) - y(-h s)) / (2 h) for every h, no limit taken; with a large h,
y(0) vanishes in the rounding, and what is left is J s to a few ulp of its own terms.
"""

from __future__ import annotations

import math
from typing import Final

from .base import MOST_VARIABLES, Model, Values

__all__ = ["output_changes"]

#: h for a seed whose largest component is 1
FAR: Final = 18446744073709551616.0
ERROR: Final = "model.acceleration_error"


def output_changes(model: Model, seeds: list[float]) -> list[float]:
    """Derivatives of all outputs along `seeds` of the inputs. The model is left as it was.

    Only for a model that is AFFINE. Of model.acceleration_error, which is none of the affine
    outputs, by the quotient rule; 0 where it is 0.
    """
    count = len(model.OUTPUTS)
    size = 0.0
    for seed in seeds:
        size = max(size, math.fabs(seed))
    if size == 0.0:
        return [0.0] * count
    inputs = [model.inputs[i] for i in range(len(seeds))]
    before: Values = [0.0] * MOST_VARIABLES
    after: Values = [0.0] * MOST_VARIABLES
    compared: list[list[float]] = [[], []]
    for side in range(2):
        h = FAR if side == 1 else -FAR
        model.set_inputs([h * (seed / size) for seed in seeds], 0)
        for group in model.FEEDTHROUGH:
            if side == 1:
                model.observe(group, after, 0)
            else:
                model.observe(group, before, 0)
        model.compare()
        compared[side] = [model.linear0, model.linear1, model.full0, model.full1]
    model.set_inputs(inputs, 0)
    scale = 0.5 * size / FAR
    changes = [(after[i] - before[i]) * scale for i in range(count)]
    if ERROR in model.OUTPUTS:
        change = error_change(model, differences(compared[0], compared[1], scale))
        changes[list(model.OUTPUTS).index(ERROR)] = change
    return changes


def differences(before: list[float], after: list[float], scale: float) -> list[float]:
    """The differences of two lists, times `scale`."""
    return [(after[i] - before[i]) * scale for i in range(len(before))]


def error_change(model: Model, changes: list[float]) -> float:
    """The change of model.acceleration_error, from those of what it compares."""
    model.compare()
    apart0 = model.linear0 - model.full0
    apart1 = model.linear1 - model.full1
    apart = math.hypot(apart0, apart1)
    linear = math.hypot(model.linear0, model.linear1)
    full = math.hypot(model.full0, model.full1)
    if apart == 0.0:
        return 0.0
    size = max(linear, full)
    if linear > full:
        growth = model.linear0 * changes[0] + model.linear1 * changes[1]
    else:
        growth = model.full0 * changes[2] + model.full1 * changes[3]
    parting = apart0 * (changes[0] - changes[2]) + apart1 * (changes[1] - changes[3])
    return (parting / apart - apart / size * (growth / size)) / size

"""How fast the outputs of a model change."""

from __future__ import annotations

import math
from typing import Final

from .base import MOST_VARIABLES, Inputs, Model, Values
from .ramp import Ramp

__all__ = ["output_rates"]

#: of the time in which the motion changes, for differences: their error is about its square
PART: Final = 1e-5
LONGEST: Final = 1.0


def output_rates(model: Model, ramp: Ramp, slopes: Inputs) -> list[float]:
    """Time derivatives of all outputs at the present state, while inputs rise by `slopes`.

    By differences along the motion: right to about 1e-9 of the natural size of each, but for the
    jump of an angle's whole turns. The model is left as it was.
    """
    count = len(model.OUTPUTS)
    groups = max(model.OUTPUTS.values()) + 1
    inputs = [model.inputs[i] for i in range(model.input_count)]
    model.keep()
    q0, q1, v0, v1, work = model.q0, model.q1, model.v0, model.v1, model.work
    model.acceleration(0.0, q0, q1, v0, v1)
    a0 = model.a0
    a1 = model.a1
    power = model.power(0.0, q0, q1, v0, v1, a0, a1) if model.works else 0.0
    e = PART * time_of_change(model, q0, q1, v0, v1, a0, a1)
    before: Values = [0.0] * MOST_VARIABLES
    after: Values = [0.0] * MOST_VARIABLES
    for side in range(2):
        t = e if side == 1 else -e
        ramp.begin(model, slopes, t)
        ramp.at(t)
        model.q0 = q0 + t * (v0 + 0.5 * t * a0)
        model.q1 = q1 + t * (v1 + 0.5 * t * a1)
        model.v0 = v0 + t * a0
        model.v1 = v1 + t * a1
        model.work = work + t * power
        for group in range(groups):
            if side == 1:
                model.observe(group, after, 0)
            else:
                model.observe(group, before, 0)
        model.set_inputs(inputs, 0)
        model.undo()
    return [(after[i] - before[i]) / (2.0 * e) for i in range(count)]


def time_of_change(
    model: Model, q0: float, q1: float, v0: float, v1: float, a0: float, a1: float
) -> float:
    """Time (s) in which the motion changes: by its rates, its forces and their slopes."""
    rate = math.fabs(v0) / model.q0_scale + math.fabs(v1) / model.q1_scale
    rate += math.sqrt(math.fabs(a0) / model.q0_scale + math.fabs(a1) / model.q1_scale)
    model.jacobian(0.0, q0, q1, v0, v1)
    rate += math.fabs(model.a0_v0) + math.fabs(model.a1_v1)
    rate += math.sqrt(math.fabs(model.a0_q0) + math.fabs(model.a1_q1))
    return 1.0 / rate if rate * LONGEST > 1.0 else LONGEST

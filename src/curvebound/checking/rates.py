"""Whether outputs that are named as the rates of others are these."""

from __future__ import annotations

import random

from ..fmi.declaration import Fmu
from ..fmi.plant import Plant
from ..fmi.slave import table_of
from ..fmi.table import NO_GROUP
from ..kernel.base import MOST_INPUTS
from ..kernel.rates import OutputRates
from .points import model_anywhere

__all__ = ["wrong_rates"]

#: of a rate, and of an output over the time of a difference, that they may be off by
_CLOSE, _ROUNDING = 1e-6, 1e-14


def wrong_rates(fmu: Fmu, numbers: dict[str, int], rng: random.Random, count: int) -> str:
    """Compare at `count` random points, inputs held; what is wrong, or ''. Of plants."""
    if not isinstance(fmu.system, Plant):
        return ""
    rates = table_of(fmu).rates
    names = table_of(fmu).names
    for _ in range(count):
        model, values = model_anywhere(fmu, fmu.system.factory, numbers, rng)
        model.keep()
        model.advance_frame(1.0)  # which then moves
        motion = OutputRates(model)
        motion.begin()
        shown, true = [0.0] * len(model.OUTPUTS), [0.0] * len(model.OUTPUTS)
        for group in set(model.OUTPUTS.values()):
            model.observe(group, shown, 0)
            motion.find(group, [0.0] * MOST_INPUTS, true, 0)
        known = values | dict(zip(model.OUTPUTS, shown, strict=True))
        for name, y, b in zip(model.OUTPUTS, shown, true, strict=True):
            vr = rates[names.index(name)]
            if vr == NO_GROUP:
                continue
            a = known[names[vr]]
            if not abs(a - b) <= _CLOSE * abs(b) + _ROUNDING * abs(y) / motion.ahead:
                return (
                    f"{name} changes by {b!r} per s, not by {a!r} as {names[vr]} says, whose name "
                    f"makes it the rate of the other, at {values}; give it another name"
                )
    return ""

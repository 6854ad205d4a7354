"""Whether outputs change with inputs of the same instant as a system says."""

from __future__ import annotations

import random
from collections.abc import Callable
from functools import partial

from ..fmi.controller import Controller
from ..fmi.declaration import Fmu
from ..fmi.plant import Plant
from ..kernel.base import Model
from ..kernel.directional import output_changes
from ..kernel.law import Law
from .points import anywhere

__all__ = ["wrong_changes"]

#: of central differences, relative, and what they may be off by
_STEP, _CLOSE, _ROUNDING = 1e-4, 1e-6, 1e-9


def wrong_changes(fmu: Fmu, numbers: dict[str, int], rng: random.Random, count: int) -> str:
    """Compare at `count` random points; what is wrong, or '' (a system without any is not)."""
    for _ in range(count):
        values = anywhere(fmu, rng)
        system: Model | Law
        changes: Callable[[list[float]], list[float]]
        if isinstance(fmu.system, Plant):
            system = model = fmu.system.factory(numbers)
            model.start(values, numbers)
            known = model.AFFINE
            changes = partial(output_changes, model)
        else:
            assert isinstance(fmu.system, Controller)
            system = law = fmu.system.factory()
            law.start(values, numbers, 0.0)
            known, changes = law.HAS_CHANGES, law.output_changes
        if not known:
            return ""
        inputs = [values[name] for name in system.INPUTS]
        seeds = [rng.uniform(-1.0, 1.0) for _ in inputs]
        system.set_inputs(inputs, 0)
        got = changes(seeds)
        below, there, above = (
            _outputs(system, [x + side * s for x, s in zip(inputs, seeds, strict=True)])
            for side in (-_STEP, 0.0, _STEP)
        )
        true = [(b - a) / (2.0 * _STEP) for a, b in zip(below, above, strict=True)]
        allowed = _CLOSE * max(map(abs, true), default=0.0)
        allowed += _ROUNDING * max(map(abs, there), default=0.0)
        for name, a, b in zip(system.OUTPUTS, got, true, strict=True):
            if not abs(a - b) <= allowed:
                return (
                    f"{name} changes by {b!r} along {dict(zip(system.INPUTS, seeds, strict=True))}"
                    f", not by {a!r} as its directional derivative says, at {values}; where "
                    "outputs of FEEDTHROUGH groups are not affine in the inputs, set AFFINE = False"
                )
    return ""


def _outputs(system: Model | Law, inputs: list[float]) -> list[float]:
    system.set_inputs(inputs, 0)
    values = [0.0] * len(system.OUTPUTS)
    for group in set(system.OUTPUTS.values()):
        system.observe(group, values, 0)
    return values

"""Whether a kernel's jacobian() gives the derivatives of its acceleration(), by differences."""

from __future__ import annotations

import random
from collections.abc import Sequence

from ..fmi.declaration import Fmu
from ..fmi.plant import Plant
from ..kernel.base import Model, acceleration_of, jacobian_of
from .points import model_anywhere

__all__ = ["wrong_derivatives"]

#: of a coordinate's size, for differences
_STEP = 1e-5
#: how close derivatives and accelerations are, of the largest term
_CLOSE, _SAME = 1e-6, 1e-11
_NAMES = ("q0", "q1", "v0", "v1")
#: what jacobian_of() gives: the acceleration, and by what
_SLOPES = ((0, 0), (0, 1), (1, 0), (1, 1), (0, 2), (0, 3), (1, 2), (1, 3))


def wrong_derivatives(fmu: Fmu, numbers: dict[str, int], rng: random.Random, count: int) -> str:
    """Compare at `count` random points; what is wrong, or ''. Of plants."""
    if not isinstance(fmu.system, Plant):
        return ""
    for _ in range(count):
        model, values = model_anywhere(fmu, fmu.system.factory, numbers, rng)
        state = [getattr(model, name) for name in _NAMES]
        wrong = _wrong(model, state, [model.q0_scale, model.q1_scale] * 2)
        if wrong:
            return f"{wrong}, at {values}; methods rely on it"
    return ""


def _wrong(model: Model, state: Sequence[float], scales: Sequence[float]) -> str:
    slopes = jacobian_of(model, 0.0, *state)
    left = model.a0, model.a1
    true = acceleration_of(model, 0.0, *state)
    size = max(map(abs, true))
    for name, a, b in zip(("a0", "a1"), left, true, strict=True):
        if not abs(a - b) <= _SAME * size:
            return f"jacobian() sets {name} to {a!r}, acceleration() to {b!r}"
    differences = []
    for k, scale in enumerate(scales):
        ends = [
            acceleration_of(
                model, 0.0, *(x + (i == k) * way * _STEP * scale for i, x in enumerate(state))
            )
            for way in (1.0, -1.0)
        ]
        differences.append([(a - b) / (2.0 * _STEP) for a, b in zip(*ends, strict=True)])
    most = [max(size, *(abs(d[i]) for d in differences)) for i in (0, 1)]
    for (i, k), slope in zip(_SLOPES, slopes, strict=True):
        found = differences[k][i] / scales[k]
        if not abs(slope - found) * scales[k] <= _CLOSE * most[i]:
            return (
                f"jacobian() sets a{i}_{_NAMES[k]} to {slope!r}, but differences of acceleration() "
                f"are {found!r}"
            )
    return ""

"""The settings of a scene itself: which values they may have."""

from __future__ import annotations

import math
from numbers import Integral

from ..errors import nearest
from .scene_data import SceneData
from .scene_parts import ALGORITHMS, HOLDS

__all__ = ["unusable"]

#: the algorithms that a slope of the inputs raises by an order
_HOLDING = [name for name, algorithm in ALGORITHMS.items() if algorithm.order == 1]


def unusable(scene: SceneData) -> list[str]:
    """What is wrong in a scene before its FMUs are looked at, a line each."""
    problems: list[str] = []
    for name in ("start_time", "stop_time", "step"):
        value = getattr(scene, name)
        if not math.isfinite(value):
            problems.append(f"{name} is {value}; give a finite number of seconds")
    if not scene.step > 0.0:
        problems.append(f"step is {scene.step} s; give a macro step above zero")
    if not scene.stop_time > scene.start_time:
        problems.append(
            f"stop_time is {scene.stop_time} s; give one after start_time, {scene.start_time} s"
        )
    if scene.algorithm not in ALGORITHMS:
        problems.append(
            f"algorithm is {scene.algorithm!r}; " + nearest(scene.algorithm, ALGORITHMS)
        )
    if scene.hold not in HOLDS:
        problems.append(f"hold is {scene.hold!r}; " + nearest(scene.hold, HOLDS))
    elif scene.hold == "first" and scene.algorithm not in _HOLDING:
        problems.append(
            f"hold is 'first' with algorithm {scene.algorithm!r}, which is of order 2 by "
            f"holding inputs; take {' or '.join(_HOLDING)}, or hold 'zero'"
        )
    if not isinstance(scene.record_every, Integral) or scene.record_every < 1:
        problems.append(f"record_every is {scene.record_every}; give a whole number, 1 or more")
    for name in ("tolerance", "loop_tolerance"):
        value = getattr(scene, name)
        if value is not None and not (value > 0.0 and math.isfinite(value)):
            problems.append(f"{name} is {value}; give a number above zero, or None")
    if scene.adaptive is not None and not scene.adaptive.tolerance > 0.0:
        problems.append(
            f"adaptive.tolerance is {scene.adaptive.tolerance}; give a number above zero"
        )
    if not scene.components:
        problems.append("it has no components; add one with scene.add(name, FMU)")
    return problems

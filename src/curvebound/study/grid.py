"""The grid of settings that a study runs, from coarse to fine in each family."""

from __future__ import annotations

import itertools
from collections.abc import Iterator
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

from ..cosim.slopes import has_slopes
from .reference.monolith import equations_of
from .settings import Setting, Space

if TYPE_CHECKING:
    from ..cosim.scene import Scene
    from ..cosim.system import Node

__all__ = ["Family", "couplings", "divisions", "grid", "has_periods", "is_sampled", "tolerances"]


@dataclass(frozen=True)
class Family:
    """Settings that differ in micro step or tolerance only, from coarse to fine.

    purpose: `micro` where these are what is studied, `macro` where macro step and algorithm are.
    """

    purpose: str
    settings: tuple[Setting, ...]


def is_sampled(scene: Scene, space: Space) -> bool:
    """Whether the macro step is part of what the scene computes: something is held over it."""
    return bool(_laws(space) or space.system.signals)


def has_periods(space: Space) -> bool:
    """Whether a law acts at points of its own, by a sample period."""
    return any(equations_of(law, {}).period() > 0.0 for law in _laws(space))


def _laws(space: Space) -> list[Node]:
    return [node for name, node in space.system.nodes.items() if name not in space.plants]


def divisions(quick: bool) -> list[int]:
    """Numbers of micro steps in a macro step."""
    if quick:
        return [1, 3, 10, 30, 100, 300]
    return [n * 10**k for k in range(5) for n in (1, 2, 5)]


def tolerances(quick: bool) -> list[float]:
    """Tolerances of `adaptive`."""
    return [10.0**-n for n in (range(2, 15, 3) if quick else range(2, 15))]


def couplings(scene: Scene, space: Space) -> list[tuple[str, str]]:
    """Algorithms with holds that go with the scene, its own first, but for rollback."""
    from ..cosim.scene_parts import ALGORITHMS, HOLDS
    from ..errors import CurveboundError

    own = scene.algorithm, scene.hold
    found = [own]
    names = ALGORITHMS if len(scene.components) > 1 else (scene.algorithm,)
    for name, hold in itertools.product(names, HOLDS):
        if (name, hold) == own or ALGORITHMS[name].rolls_back:
            continue
        if hold == "first" and not has_slopes(space.system):
            continue
        other = scene.copy()
        other.algorithm, other.hold, other.adaptive = name, hold, None
        try:
            other.check()
        except CurveboundError:
            continue
        found.append((name, hold))
    return found


def macro_steps(scene: Scene, sampled: bool, quick: bool) -> list[float]:
    """Macro steps to study besides the scene's own, in s."""
    span = scene.stop_time - scene.start_time
    factors = [5.0, 2.0, 0.5, 0.2] if sampled else [10.0, 0.1]
    if quick:
        factors = [2.0, 0.5] if sampled else [10.0]
    return [scene.step * f for f in factors if scene.step * f <= span]


def grid(scene: Scene, space: Space, *, quick: bool = False) -> Iterator[Family]:
    """Families of settings: micro steps and tolerances at some macro steps, then macro steps.

    Where values are held over the macro step, it is studied on its own, with all algorithms and
    holds, and an integration whose error does not count.
    """
    sampled = is_sampled(scene, space)
    bases = [scene.step] if sampled else [scene.step, *macro_steps(scene, sampled, quick)]
    span = scene.stop_time - scene.start_time
    for step in bases:
        for family in space.families(step, scene.algorithm, scene.hold):
            if family.method == "exact":
                whole = [] if sampled or step != bases[0] else [replace(family, step=span)]
                yield Family("micro", (family, *whole))
                continue
            sizes = tolerances(quick) if family.by_tolerance else []
            sizes = sizes or [step / n for n in divisions(quick)]
            yield Family("micro", tuple(family.with_size(size) for size in sizes))
    if sampled:
        for algorithm, hold in couplings(scene, space):
            steps = sorted([scene.step, *macro_steps(scene, sampled, quick)], reverse=True)
            yield Family(
                "macro",
                tuple(
                    Setting(space.structures[0], "adaptive", 1e-12, step, algorithm, hold)
                    for step in steps
                ),
            )

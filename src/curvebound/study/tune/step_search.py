"""A family of settings along its error law: error ~ size^order, or ~ tolerance for `adaptive`."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping

from ..settings import STEP_ORDERS, Setting
from .candidate import Candidate

__all__ = ["AIM", "STEP_COST", "coarser", "search_size"]

AIM = 0.35  # share of the bound that is aimed at
_LOOSEST, _TIGHTEST = 1e-2, 1e-15  # tolerances
_FINEST = 200_000  # micro steps in a macro step
#: CPU seconds of a micro step, a first guess until one has been measured
STEP_COST = 5e-8


def search_size(
    family: Setting,
    evaluate: Callable[[Setting], Candidate],
    give_up: float,
    first: Setting | None = None,
    floor: float = 0.0,
) -> list[Candidate]:
    """Candidates of a family, ending near the coarsest that fits; all that were tried.

    give_up: cost (s per s) beyond which the family is of no interest.
    floor: share of the bound below which a coarser one is looked for, if it would be cheaper.
    """
    if family.method == "exact":
        return [evaluate(family)]
    setting = first or _coarsest(family)
    tried: dict[float, Candidate] = {}
    for _ in range(7):
        assert setting.size is not None
        candidate = evaluate(setting)
        tried[setting.size] = candidate
        below = [c for c in tried.values() if c.fits]
        above = [c for c in tried.values() if not c.fits]
        if candidate.fits and (candidate.miss >= floor or _is_coarsest(setting)):
            break
        following = _next(setting, tried)
        if following is None or following.size in tried:
            break
        assert following.size is not None
        # a finer one costs more in proportion: drop the family where that is too much
        ratio = setting.size / following.size if not setting.by_tolerance else 1.0
        if not candidate.fits and not below:
            macro = min((c.cpu for c in tried.values()), default=0.0)
            expected = macro if ratio <= 1.0 else _expected(tried, following)
            if expected > give_up:
                break
        if below and above and _near(below, above):
            break
        setting = following
    return list(tried.values())


def coarser(setting: Setting) -> Setting | None:
    """The setting one notch coarser, None where there is none."""
    if setting.size is None or _is_coarsest(setting):
        return None
    if setting.by_tolerance:
        return setting.with_size(min(10.0 * setting.size, _LOOSEST))
    n = round(setting.step / setting.size)
    return setting.with_size(setting.step / max(1, n - max(1, n // 4)))


def _coarsest(family: Setting) -> Setting:
    return family.with_size(1e-3 if family.by_tolerance else family.step)


def _is_coarsest(setting: Setting) -> bool:
    assert setting.size is not None
    limit = _LOOSEST if setting.by_tolerance else setting.step
    return setting.size >= limit * (1.0 - 1e-9)


def _expected(tried: Mapping[float, Candidate], following: Setting) -> float:
    """Cost (s per s) of the following size, from what the tried ones cost: a + b / size."""
    assert following.size is not None
    sizes = sorted(tried)
    if len(sizes) < 2:
        only = tried[sizes[0]]
        return only.cpu + STEP_COST / following.size
    fine, coarse = tried[sizes[0]], tried[sizes[-1]]
    slope = max((fine.cpu - coarse.cpu) / (1 / sizes[0] - 1 / sizes[-1]), 0.3 * STEP_COST)
    return coarse.cpu + slope * (1 / following.size - 1 / sizes[-1])


def _next(setting: Setting, tried: Mapping[float, Candidate]) -> Setting | None:
    """The size at which the bound should be met, by the error law through what was tried."""
    assert setting.size is not None
    here = tried[setting.size]
    order = 1.0 if setting.by_tolerance else STEP_ORDERS.get(setting.method, 2.0)
    miss = min(max(here.miss, 1e-12), 1e12) if here.miss < math.inf else 1e3
    fits = [s for s, c in tried.items() if c.fits]
    misses = [s for s, c in tried.items() if not c.fits]
    usable = sorted((s, c.miss) for s, c in tried.items() if 0.0 < c.miss < 1e6)
    if len(usable) >= 2:
        (a, at_a), (b, at_b) = usable[0], usable[1]
        measured = math.log(at_b / at_a) / math.log(b / a) if at_b > at_a else 0.0
        order = min(max(measured, 0.5 * order), 2.0 * order)
    size = setting.size * (AIM / miss) ** (1.0 / order)
    if fits and misses and not max(fits) < size < min(misses):
        size = math.sqrt(max(fits) * min(misses))
    if setting.by_tolerance:
        size = min(max(size, _TIGHTEST), _LOOSEST)
        size = 10.0 ** (round(4.0 * math.log10(size)) / 4.0)
    else:
        divisions = math.ceil(setting.step / size - 1e-9)
        divisions = min(max(divisions, 1), _FINEST)
        size = setting.step / divisions
    return None if size == setting.size else setting.with_size(size)


def _near(below: list[Candidate], above: list[Candidate]) -> bool:
    """Whether the coarsest that fits and the finest that does not are next to each other."""
    a = max(c.setting.size or 0.0 for c in below)
    b = min(c.setting.size or math.inf for c in above)
    return b / a < 1.3

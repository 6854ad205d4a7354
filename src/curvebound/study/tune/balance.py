"""Cheaper macro steps, at which errors of integration and of coupling have opposite signs.

To first order both add: error(t) = coupling(t) + integration(t) size^order. From a run whose
integration is as good as exact and one at any size follows the error at all other sizes, and so the
one at which the sum is least. Where that meets the bounds at the scene's own start, it is tried at
the others: what cancels by chance does not hold there.
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence

import numpy as np
from numpy.typing import NDArray

from ..settings import STEP_ORDERS, Setting
from .candidate import Candidate
from .ensemble import Ensemble
from .step_search import STEP_COST

__all__ = ["LARGEST", "balanced"]

LARGEST = 20.0  # error of coupling over its bounds: hardly a twentieth of it would be left
_LEFT = 0.5  # of coupling's error, at most, where another size is worth a run
_TRIES = 4  # sizes of one family
_FINER = 10.0  # times as many micro steps where a run fails
#: numbers of micro steps in a macro step: all small ones, then about a twentieth apart
_DIVISIONS = np.unique(np.round(1.05 ** np.arange(190)))


def balanced(
    ensemble: Ensemble,
    macro: Setting,
    families: Sequence[Setting],
    bounds: Mapping[str, float],
    most: float,
) -> list[Candidate]:
    """What each family comes to at the macro step of a setting.

    macro: a setting whose integration is as good as exact. Families without an order in the micro
        step (adaptive, exact) are passed over.
    most: cost (s per s) beyond which a candidate is of no interest.
    """
    coupled, coupling = ensemble.errors(macro, bounds)
    tried: list[Candidate] = []
    if not coupled.miss < LARGEST:
        return tried
    for family in families:
        order = STEP_ORDERS.get(family.method)
        numbers: set[float] = set()
        divisions = 1.0
        while order is not None and divisions not in numbers and len(numbers) < _TRIES:
            numbers.add(divisions)
            setting = family.with_size(macro.step / divisions)
            candidate, error = ensemble.errors(setting, bounds)
            tried.append(candidate)
            if candidate.miss < math.inf:
                left, following = _least(coupling, error - coupling, divisions, order)
            else:
                left, following = 0.0, _FINER * divisions
            more = STEP_COST * (following - divisions) / macro.step
            if left > _LEFT * coupled.miss or candidate.cpu + more > most:
                break
            divisions = following
    return tried


def _least(
    coupling: NDArray[np.float64], integration: NDArray[np.float64], divisions: float, order: int
) -> tuple[float, float]:
    """The least of the largest sums over the run, and its number of micro steps.

    coupling, integration: errors over their bounds, shape (k,), the second at `divisions`.
    """
    scales = (divisions / _DIVISIONS) ** order
    sums = [float(np.abs(coupling + scale * integration).max()) for scale in scales]
    best = int(np.argmin(sums))
    return sums[best], float(_DIVISIONS[best])

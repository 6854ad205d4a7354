"""The references of one scene, made when first needed, and what they say of a run: verdicts."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from .reference import Reference, refer

if TYPE_CHECKING:
    from ...cosim.system import System
    from .monolith import Value

__all__ = ["MARGIN", "ReferenceSet", "Verdict", "judge"]

#: an uncertainty this many times below an error can judge it
MARGIN = 100.0
_SHORTEST = 0.1  # of the run: judged for less, a result counts as not judged


@dataclass(frozen=True)
class Verdict:
    """Error of one output over a run, in its unit.

    final: at the last time judged; worst: largest up to there; until: that time in s.
    judged: whether the reference is at least MARGIN times surer than `worst`; otherwise `worst`
        is known to be below `bound` only.
    """

    final: float
    worst: float
    until: float
    judged: bool
    bound: float


class ReferenceSet:
    """What the outputs `paths` are, for the scene's starts or an ensemble of them.

    model: the most accurate one, as enumeration values by path; judged against by default.
    changes: start values by path on top of the scene's, numbers or arrays over the members.
    """

    def __init__(
        self,
        system: System,
        model: Mapping[str, str],
        paths: Sequence[str],
        *,
        changes: Mapping[str, Value] | None = None,
        continuous: bool = False,
    ) -> None:
        self.system = system
        self.model = dict(model)
        self.paths = list(paths)
        self.changes = dict(changes or {})
        self.continuous = continuous
        self._references: dict[tuple[tuple[str, str], ...], Reference] = {}
        self._values: dict[tuple[Any, ...], dict[str, NDArray[Any]]] = {}

    def of_model(self, model: Mapping[str, str]) -> Reference:
        """The reference of a model, given as enumeration values by path."""
        key = tuple(sorted(model.items()))
        if key not in self._references:
            self._references[key] = refer(
                self.system,
                self.paths,
                changes={**self.changes, **model},
                continuous=self.continuous,
            )
        return self._references[key]

    @property
    def reference(self) -> Reference:
        """That of the most accurate model."""
        return self.of_model(self.model)

    def values(self, model: Mapping[str, str], times: NDArray[Any]) -> dict[str, NDArray[Any]]:
        """Outputs (k, members) of a model; those of the times asked for last are kept."""
        key = (tuple(sorted(model.items())), len(times), float(times[0]), float(times[-1]))
        known = self._values.get(key)
        if known is None or not np.array_equal(known["time"], times):
            known = {**self.of_model(model).values(times), "time": times}
            if len(self._values) > 40:
                self._values.clear()
            self._values[key] = known
        return known

    def errors(
        self,
        times: NDArray[Any],
        outputs: Mapping[str, NDArray[Any]],
        *,
        model: Mapping[str, str] | None = None,
        member: int = 0,
        least: Mapping[str, float] | None = None,
    ) -> dict[str, Verdict]:
        """A verdict on each output, shape (k,), at times (k,).

        model: judge against this model instead of the most accurate one.
        least: error by path below which one need not know it.
        """
        which = self.model if model is None else model
        exact = self.values(which, times)
        reference = self.of_model(which)
        return {
            path: judge(
                times,
                np.asarray(outputs[path]) - exact[path][:, member],
                reference.uncertainty(path, times)[:, member],
                least=(least or {}).get(path, 0.0),
            )
            for path in self.paths
        }

    def modelling(self, model: Mapping[str, str], times: NDArray[Any]) -> dict[str, Verdict]:
        """Error of a simpler model itself, were it computed exactly."""
        simpler = self.values(model, times)
        return self.errors(times, {path: simpler[path][:, 0] for path in self.paths})


def judge(
    times: NDArray[Any], error: NDArray[Any], doubt: NDArray[Any], *, least: float = 0.0
) -> Verdict:
    """Judge an error, shape (k,), given the reference's uncertainty at the same times.

    least: error in the output's unit below which one need not know it: an uncertainty MARGIN times
        below that will do.
    """
    size = np.abs(np.asarray(error, dtype=float))
    size = np.where(np.isfinite(size), size, np.inf)
    running = np.maximum.accumulate(size)
    sure = doubt * MARGIN <= np.maximum(running, least)
    whole = times[-1] - times[0]
    last = int(np.flatnonzero(sure)[-1]) if sure.any() else 0
    until = float(times[last])
    bound = float(running[-1] + doubt[-1])
    if last < len(times) - 1 and until - times[0] < _SHORTEST * whole:
        return Verdict(float(size[-1]), float(running[-1]), float(times[-1]), False, bound)
    return Verdict(float(size[last]), float(running[last]), until, True, bound)

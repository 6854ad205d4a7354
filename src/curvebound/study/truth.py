"""The references of one scene, made when first needed, and rows judged against them."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from .judge import Verdict, judge
from .reference import Reference, refer

if TYPE_CHECKING:
    from ..cosim.system import System
    from .monolith import Value
    from .settings import Setting, Space

__all__ = ["Truths"]


class Truths:
    """What the outputs `paths` are, for the scene's starts or an ensemble of them.

    changes: start values by path on top of the scene's, numbers or arrays over the members.
    """

    def __init__(
        self,
        system: System,
        space: Space,
        paths: Sequence[str],
        *,
        changes: Mapping[str, Value] | None = None,
        continuous: bool = False,
    ) -> None:
        self.system = system
        self.space = space
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
        return self.of_model(self.space.truth)

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
        which = self.space.truth if model is None else model
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

    def modelling(self, setting: Setting, times: NDArray[Any]) -> dict[str, Verdict]:
        """Error of the setting's model itself, were it computed exactly."""
        simpler = self.values(self.space.model(setting), times)
        return self.errors(times, {path: simpler[path][:, 0] for path in self.paths})

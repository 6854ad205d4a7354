"""References: what a scene's outputs are, and how sure that is.

The solution is computed twice, on two formulations, both in extended precision: Gauss collocation
on coordinates and rates gives the values, and the closed form where there is one, else collocation
of another order on coordinates and momenta, the witness.
Twice the largest difference between them up to a time is the uncertainty stated for that time.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from .collocation import NOISE, Trajectory, collocate
from .equations import Array, system_of
from .monolith import Monolith, Value, _Inputs
from .reference_cache import kept, question

if TYPE_CHECKING:
    from ...cosim.system import System

__all__ = ["Reference", "refer"]

Number = np.longdouble
_CHECKS = 100  # times at which the two computations are compared
_FIRST = 1e-2  # s, first step tried
_BETWEEN = 1e-15  # relative error between the ends of steps, where that is all that can be had


class Reference:
    """Exact outputs of a scene for one or more starts.

    paths: the outputs; members: the number of starts.
    how: the two computations, in words.
    """

    def __init__(
        self,
        monolith: Monolith,
        trajectory: Trajectory,
        paths: Sequence[str],
        checks: Sequence[float] | Array,
        uncertainty: Mapping[str, Array],
        how: str,
    ) -> None:
        self.paths = list(paths)
        self.members = monolith.members
        self.how = how
        self.stop = trajectory.end
        self._monolith = monolith
        self._trajectory = trajectory
        self._checks = np.array(checks)
        self._uncertainty = dict(uncertainty)

    def values(self, times: Sequence[float] | NDArray[Any]) -> dict[str, Array]:
        """Outputs by path at times (k,), each of shape (k, members), in extended precision."""
        times = np.asarray(times, dtype=float)
        return self._monolith.observe(self.paths, times, self._trajectory.states(times))

    def uncertainty(self, path: str, times: Sequence[float] | NDArray[Any]) -> NDArray[Any]:
        """Bound of the values' own error up to each time, shape (k, members)."""
        index = np.searchsorted(self._checks, np.asarray(times, float) - 1e-12, "left")
        table: NDArray[Any] = self._uncertainty[path]
        return table[np.minimum(index, len(self._checks) - 1)]


def refer(
    system: System,
    paths: Sequence[str],
    *,
    stop: float | None = None,
    changes: Mapping[str, Value] | None = None,
    continuous: bool = False,
    progress: Callable[[float], None] | None = None,
) -> Reference:
    """The reference of a scene that was checked, for its outputs `paths` up to `stop` (s).

    changes: parameter values by path on top of the scene's: numbers, items of enumerations, or
        arrays, one value for each member of an ensemble.
    continuous: whether control laws and input functions act all the time, see monolith; they do in
        a scene whose hold is first.
    progress: called now and then with the share done.
    Raises CurveboundError for a component without equations or a motion that ends in between.
    References are kept on disk, see reference_cache.py.
    """
    end = system.scene.stop_time if stop is None else stop
    begin = system.scene.start_time
    # inputs that are not held tend to what acts all the time
    continuous = continuous or system.scene.hold == "first"

    def tell(share: float) -> None:
        if progress is not None:
            progress(share)

    own = Monolith(system, changes, continuous=continuous)

    def compute() -> dict[str, Array]:
        own.observe(paths, np.array([begin]), own.start()[:, None])  # what is unknown, first
        return _compute(own, paths, begin, end, changes, tell)

    known = kept(question(system, paths, end, changes, continuous), own, compute)
    doubts = {path: known[f"uncertainty {path}"] for path in paths}
    trajectory = Trajectory.of_arrays(known)
    return Reference(own, trajectory, paths, known["checks"], doubts, str(known["how"]))


def _compute(
    own: Monolith,
    paths: Sequence[str],
    begin: float,
    end: float,
    changes: Mapping[str, Value] | None,
    tell: Callable[[float], None],
) -> dict[str, Array]:
    """Both computations: the trajectory's arrays, `checks`, `how` and `uncertainty PATH`."""
    system, continuous = own.system, own.continuous
    nodes = 9 if own.is_sampled else 14
    trajectory, checks, _ = _collocated(own, begin, end, nodes, lambda x: tell(0.5 * x))
    exact_at, exact = _closed_form(system, own, changes, continuous, begin, end)
    if exact is not None:
        plain = Monolith(system, changes, continuous=continuous)
        checks, states = exact_at, exact
        witness = plain.observe(paths, np.array(checks), states)
        how = "collocation; " + _closed_form_name(system)
    else:
        other = Monolith(system, changes, continuous=continuous, witness=True)
        _, _, states = _collocated(
            other, begin, end, nodes + 3, lambda x: tell(0.5 + 0.5 * x), checks
        )
        how = "collocation; collocation of another order on coordinates and momenta"
        witness = other.observe(paths, np.array(checks), states)
    values = own.observe(paths, np.array(checks), trajectory.states(checks))
    doubts = {f"uncertainty {path}": _doubt(values[path], witness[path]) for path in paths}
    return {**doubts, **trajectory.arrays(), "checks": np.array(checks), "how": np.array(how)}


def _doubt(values: Array, witness: Array) -> Array:
    """Uncertainty up to each check, shape (k, members), from two computations."""
    difference = np.abs(values - witness)
    doubt = 2.0 * difference + NOISE * np.abs(values)
    doubt = np.where(np.isfinite(doubt), doubt, np.inf)
    doubts: Array = np.maximum.accumulate(doubt, axis=0).astype(float)
    return doubts


def _collocated(
    monolith: Monolith,
    begin: float,
    end: float,
    nodes: int,
    tell: Callable[[float], None],
    checks: Sequence[float] | None = None,
) -> tuple[Trajectory, list[float], Array]:
    """The solution by collocation; times at which to compare it, and states there."""
    trajectory = Trajectory(begin, monolith.start())
    monolith.sample(begin, trajectory.final)
    size, before = _FIRST, begin
    # results of a sampled loop are wanted where its steps end; a function of time is no smoother
    # than the double numbers that it returns, and no short step would make it so
    rough = monolith.is_sampled or monolith.system.signals
    dense = max(_BETWEEN, 100.0 * NOISE) if rough else 30.0 * NOISE
    events = list(monolith.events(end))
    for event in events:
        size = collocate(
            monolith.rates, before, event, trajectory, nodes=nodes, size=size, dense=dense
        )
        monolith.sample(event, trajectory.final)
        before = event
        tell((event - begin) / (end - begin))
    if checks is None:
        spacing = (end - begin) / _CHECKS
        if monolith.is_sampled:
            checks = [begin, *_thinned(events, begin, spacing)]
        else:
            between = (begin + i * spacing for i in range(1, _CHECKS))
            checks = [begin, *sorted({*events, *between, end})]
    return trajectory, list(checks), trajectory.states(checks)


def _thinned(events: Sequence[float], begin: float, spacing: float) -> list[float]:
    """Events about `spacing` apart, the last one included."""
    kept, last = [], begin
    for event in events:
        if event - last >= spacing * (1.0 - 1e-9):
            kept.append(event)
            last = event
    if not kept or kept[-1] != events[-1]:
        kept.append(events[-1])
    return kept


def _closed_form(
    system: System,
    own: Monolith,
    changes: Mapping[str, Value] | None,
    continuous: bool,
    begin: float,
    end: float,
) -> tuple[list[float], Array | None]:
    """Check times and states there from closed forms, if every component has one that applies."""
    if begin != 0.0 or any(s is not None for p in own.parts.values() for s in p.sources.values()):
        return [], None
    times = [end * i / 64 for i in range(1, 65)]
    states = np.zeros((own.size, len(times), own.members), dtype=Number)
    fresh = Monolith(system, changes, continuous=continuous)
    for name, part in fresh.parts.items():
        form = system_of(system.nodes[name].fmu).closed_form
        if form is None:
            return [], None
        zero = np.zeros((1, 1), dtype=Number)
        inputs = _Inputs(fresh, part, zero, fresh.start()[:, None])
        found = form(part.equations, inputs, times)
        if found is None:
            return [], None
        states[part.place] = found
    return times, states


def _closed_form_name(system: System) -> str:
    names = {system_of(n.fmu).closed_form_name for n in system.nodes.values()}
    return ", ".join(sorted(names))

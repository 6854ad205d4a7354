"""Reference results: where an FMU carries one, what it says, and how far a run is from it."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ..cosim.fmu import Fmu, extracted
from ..cosim.tables import read_csv
from ..numbers import plain
from .finding import Wrong

__all__ = ["Distance", "ReferenceTable", "carried", "require_few"]

Array = NDArray[np.float64]
_MOST = 1_000_000  # communication points of a run


@dataclass(frozen=True)
class Distance:
    """The output that is farthest off, for its scale, and when it first leaves the bound (s)."""

    name: str
    relative: float
    difference: float
    first: float


def require_few(count: float, start: float, stop: float, step: float) -> None:
    """Wrong where a run has more communication points than a check takes."""
    if not count <= _MOST:
        raise Wrong(
            f"a run from {start:g} s to {stop:g} s in steps of {step:g} s has "
            f"{plain(count)} communication points, and a check takes {_MOST} at most: give --step "
            "or --stop"
        )


class ReferenceTable:
    """Outputs over time, read from `path`; inputs (from another file) by name, or none.

    Raises CurveboundError where a file is no table, Wrong where it has nothing of this FMU.
    """

    def __init__(self, fmu: Fmu, path: Path, inputs: Path | None = None) -> None:
        self.path = path
        units = {variable.name: variable.unit for variable in fmu.variables.values()}
        table = read_csv(path, units)
        names = table.dtype.names or ()
        if "time" not in names:
            raise Wrong(f"{path.name} has no column time")
        for name in names:
            if not np.all(np.isfinite(table[name])):
                raise Wrong(f"{path.name}: its column {name} holds NaN or infinity")
        if np.any(np.diff(table["time"]) < 0.0):
            raise Wrong(f"{path.name}: its times go back")
        keep = np.append(np.diff(table["time"]) > 0.0, True)  # the later of two at one time
        table = table[keep]
        self.time: Array = table["time"].astype(float)
        self.columns: dict[str, Array] = {
            name: table[name].astype(float) for name in names if name in fmu.outputs
        }
        if not self.columns or len(self.time) < 2:
            raise Wrong(f"{path.name} has no output of {fmu.model_name} over time")
        self.units = {name: fmu.variables[name].unit or name for name in self.columns}
        self._given: Any = None if inputs is None else read_csv(inputs, units)
        self._settable = [v.name for v in fmu.variables.values() if v.is_drivable]

    def inputs(self, points: Array) -> dict[str, Array]:
        """The values of its inputs at times (s): those of the latest row until then."""
        if self._given is None:
            return {}
        near = 1e-9 * (points[-1] - points[0])
        rows = np.searchsorted(self._given["time"], points + near, "right") - 1
        return {
            name: self._given[name].astype(float)[np.maximum(rows, 0)]
            for name in self._given.dtype.names
            if name in self._settable
        }

    def points(self, start: float, step: float | None) -> Array:
        """Communication points: multiples of `step` from `start` where they are all its times.

        Otherwise its times themselves.
        """
        if step is None:
            return self.time
        numbers = (self.time - start) / step
        if numbers[0] < -0.5 or np.abs(numbers - np.round(numbers)).max() > 1e-6:
            return self.time
        count = round(float(numbers[-1]))
        require_few(count, start, float(self.time[-1]), step)
        return np.array([start + step * k for k in range(count + 1)])

    def relative(self, names: list[str], points: Array, rows: Array) -> Array:
        """Differences of outputs `rows` (points, names) from it, shape (times, columns).

        Each relative to the largest value of the outputs of the same unit.
        """
        places = np.searchsorted(points, self.time - 1e-9 * (points[-1] - points[0]))
        places = np.minimum(places, len(points) - 1)
        scales = self._scales()
        off = [
            np.abs(rows[places, names.index(name)] - values) / scales[name]
            for name, values in self.columns.items()
        ]
        return np.stack(off, axis=1)

    def distance(self, names: list[str], points: Array, rows: Array, bound: float) -> Distance:
        """How far a run is from it, and when it is first farther than `bound`, relative."""
        off = self.relative(names, points, rows)
        worst = int(np.argmax(np.where(np.isfinite(off), off, np.inf).max(axis=0)))
        name = list(self.columns)[worst]
        largest = float(off[:, worst].max())
        beyond = np.flatnonzero(~(off[:, worst] <= bound))
        first = float(self.time[beyond[0]]) if len(beyond) else float(self.time[-1])
        return Distance(name, largest, largest * self._scales()[name], first)

    def _scales(self) -> dict[str, float]:
        largest: dict[str, float] = {}
        for name, values in self.columns.items():
            unit = self.units[name]
            largest[unit] = max(largest.get(unit, 0.0), float(np.abs(values).max()))
        return {name: largest[unit] or 1.0 for name, unit in self.units.items()}


def carried(fmu: Fmu) -> tuple[Path, Path | None] | None:
    """The reference result that an FMU carries, and its inputs; None where there is none.

    documentation/reference.csv with reference_inputs.csv; or, in the manner of the FMI Cross-Check,
    NAME_ref.csv with NAME_in.csv in the FMU or beside it.
    """
    folder = extracted(fmu)
    pairs = [
        (folder / "documentation/reference.csv", folder / "documentation/reference_inputs.csv")
    ]
    name = fmu.path.stem
    for place in (folder / "documentation", folder / "resources", folder, fmu.path.parent):
        pairs.append((place / f"{name}_ref.csv", place / f"{name}_in.csv"))
    for outputs, inputs in pairs:
        if outputs.is_file():
            return outputs, inputs if inputs.is_file() else None
    return None

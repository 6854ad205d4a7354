"""One experiment on one FMU: start values, communication points, inputs; run as often as wanted.

The order at each communication point is that of fmpy: the outputs are read, then the inputs of that
time are set, and held over the step; those of the first are set in initialization mode too.
"""

from __future__ import annotations

import ctypes
from collections.abc import Iterator, Mapping, Sequence
from contextlib import contextmanager
from ctypes import byref, c_double, c_int, c_size_t, c_uint, c_void_p
from dataclasses import dataclass, field
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ..cosim.fmu import Fmu, Value, Variable
from ..cosim.instance import Instance, Library, Log

__all__ = ["Experiment", "Runner"]

Array = NDArray[np.float64]
_TYPES: dict[str, Any] = {"Real": c_double, "Integer": c_int, "Boolean": c_int}


@dataclass
class Experiment:
    """points: communication points in s, the first is the start; inputs: name -> value at each."""

    points: Array
    start: dict[str, Value] = field(default_factory=dict)
    inputs: dict[str, Array] = field(default_factory=dict)
    tolerance: float | None = None


class Runner:
    """Runs an experiment on instances of an FMU; `names` are the outputs that are looked at.

    Without an output, whatever can be read as a number.
    """

    def __init__(self, fmu: Fmu, experiment: Experiment) -> None:
        self.fmu = fmu
        self.experiment = experiment
        self.log = Log()
        numbers = [v for v in fmu.variables.values() if v.kind in _TYPES]
        seen = [v for v in numbers if v.causality == "output"] or numbers
        self.names = [v.name for v in seen]
        self._readers = [_Reader(seen, kind) for kind in _TYPES]
        self._library = Library(fmu)

    def close(self) -> None:
        """Unload the binary."""
        self._library.unload()

    @contextmanager
    def instance(self) -> Iterator[Instance]:
        """A new instance, freed at the end."""
        made = Instance(self.fmu.model_name, self._library, self.log)
        try:
            yield made
        finally:
            made.free()

    def run(self, changes: Mapping[str, Value] | None = None) -> Array:
        """The outputs at all points, shape (points, names), of a new instance."""
        with self.instance() as made:
            self.begin(made, changes)
            return self.advance(made)

    def begin(self, made: Instance, changes: Mapping[str, Value] | None = None) -> None:
        """Bring an instance to its first communication point; changes: start values on top."""
        experiment = self.experiment
        given = {**experiment.start, **(changes or {})}
        typed = {name: self.fmu.variables[name].value(value) for name, value in given.items()}
        first, last = float(experiment.points[0]), float(experiment.points[-1])
        made.initialize(typed.items(), experiment.tolerance, first, last)
        self._set_inputs(made, 0)
        made.call("ExitInitializationMode")

    def advance(self, made: Instance, first: int = 0, last: int | None = None) -> Array:
        """The outputs from point `first` on; to `last`, which is reached but not read, or all."""
        points = self.experiment.points
        count = len(points)
        end = count if last is None else last
        rows = np.zeros((end - first, len(self.names)))
        for k in range(first, end):
            self.read(made, rows[k - first])
            if k + 1 < count:
                self._set_inputs(made, k)
                size = points[k + 1] - points[k]
                made.call("DoStep", c_double(points[k]), c_double(size), c_int(1))
        return rows

    def read(self, made: Instance, row: Array) -> None:
        """The present outputs."""
        for reader in self._readers:
            reader.read(made, row)

    def values(self, made: Instance, variables: Sequence[Variable]) -> list[float]:
        """The present values of some numeric variables."""
        row = np.zeros(len(variables))
        for kind in _TYPES:
            _Reader(variables, kind).read(made, row)
        return [float(value) for value in row]

    def moved(self, made: Instance, other: Instance) -> None:
        """Take the state of one instance to another, as bytes."""
        state, size = c_void_p(), c_size_t()
        made.call("GetFMUstate", byref(state))
        made.call("SerializedFMUstateSize", state, byref(size))
        data = ctypes.create_string_buffer(size.value)
        made.call("SerializeFMUstate", state, data, size)
        made.call("FreeFMUstate", byref(state))
        taken = c_void_p()
        other.call("DeSerializeFMUstate", data, size, byref(taken))
        other.call("SetFMUstate", taken)
        other.call("FreeFMUstate", byref(taken))

    def _set_inputs(self, made: Instance, k: int) -> None:
        for name, values in self.experiment.inputs.items():
            variable = self.fmu.variables[name]
            made.set(name, variable.value(float(values[k])))


class _Reader:
    """Reads the variables of one type."""

    def __init__(self, variables: Sequence[Variable], kind: str) -> None:
        mine = [(i, v.reference) for i, v in enumerate(variables) if v.kind == kind]
        self._places = [i for i, _ in mine]
        self._references = (c_uint * len(mine))(*(reference for _, reference in mine))
        self._values = (_TYPES[kind] * len(mine))()
        self._function = f"Get{kind}"

    def read(self, made: Instance, row: Array) -> None:
        if self._places:
            count = c_size_t(len(self._places))
            made.call(self._function, self._references, count, self._values)
            row[self._places] = self._values[:]

"""An FMU as it is to be checked: the experiment that was asked for, and its reference result."""

from __future__ import annotations

from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from ..cosim.fmu import Fmu
from ..cosim.points import communication_times
from ..errors import CurveboundError, nearest
from .experiment import Experiment, Runner
from .finding import Wrong
from .reference import Distance, ReferenceTable, carried, require_few
from .request import Request

__all__ = ["Subject"]

Array = NDArray[np.float64]


class Subject:
    """What runs `fmu` as requested, and how far from its reference that is; made when asked for.

    Raises CurveboundError where the request does not fit, Wrong where the reference is none.
    """

    def __init__(self, fmu: Fmu, request: Request) -> None:
        self.fmu = fmu
        self.request = request

    @cached_property
    def reference(self) -> ReferenceTable | None:
        """The one given, or that carried if the run is the one it belongs to."""
        request = self.request
        if request.reference is not None:
            return ReferenceTable(self.fmu, request.reference, request.inputs)
        if request.start or request.stop is not None or request.step is not None:
            return None
        there = carried(self.fmu)
        return None if there is None else ReferenceTable(self.fmu, *there)

    @cached_property
    def runner(self) -> Runner:
        """What runs the experiment."""
        fmu, request, table = self.fmu, self.request, self.reference
        start = fmu.start_time or 0.0
        step = fmu.step or None if request.step is None else request.step
        stop = (fmu.stop_time or start + 1.0) if request.stop is None else request.stop
        if table is not None and request.stop is None and request.step is None:
            points = table.points(start, step)
        else:
            step = (stop - start) / 100.0 if step is None else step
            if not (stop > start and step > 0.0):
                raise Wrong(f"there is no run from {start:g} s to {stop:g} s by {step:g} s")
            require_few((stop - start) / step, start, stop, step)
            points = np.array(communication_times(start, stop, step))
        inputs = {} if table is None else table.inputs(points)
        for name in request.start:
            if name not in fmu.variables or not fmu.variables[name].is_settable_start:
                able = [v.name for v in fmu.variables.values() if v.is_settable_start]
                raise CurveboundError(f"{name} takes no start value; {nearest(name, able)}")
        return Runner(fmu, Experiment(points, dict(request.start), inputs, fmu.tolerance))

    @property
    def _compared(self) -> ReferenceTable:
        assert self.reference is not None
        return self.reference

    def distance(self, rows: Array) -> Distance:
        """How far outputs of a run, of shape (points, names), are from the reference."""
        runner = self.runner
        return self._compared.distance(
            runner.names, runner.experiment.points, rows, self.request.tolerance
        )

    def off(self, rows: Array) -> Array:
        """The largest relative error at each time of the reference."""
        runner = self.runner
        apart = self._compared.relative(runner.names, runner.experiment.points, rows)
        largest: Array = apart.max(axis=1)
        return largest

    def too_far(self, distance: Distance) -> str:
        """In words what is wrong with a distance that is not allowed."""
        table = self._compared
        unit = self.fmu.variables[distance.name].unit or ""
        text = f"{distance.name} differs from {table.path.name} by up to {distance.difference:.3g}"
        text = f"{text} {unit}".rstrip() + f" ({distance.relative:.2g} of the largest value, "
        text += f"{self.request.tolerance:g} is allowed), first at t = {distance.first:.6g} s"
        if distance.first <= float(table.time[0]):
            return text + ": at the start already, so a start value or an output is another one"
        return text + ": the start is right, so the equations or the integration are others"

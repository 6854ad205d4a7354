"""The reference result of an FMU: its default experiment, computed as exactly as the kernel can.

Plants are integrated by `adaptive` at a relative tolerance of 1e-13; the inputs are those that the
declaration names, held from one communication point to the next.
"""

from __future__ import annotations

import math
from typing import NamedTuple

from .declaration import CHOICE, OUTPUT, Fmu
from .slave import table_of

__all__ = ["ReferenceResult", "reference_inputs", "reference_result"]

TOLERANCE = 1e-13


class ReferenceResult(NamedTuple):
    """Columns by name (`time` in s first, then SI units), all of one length."""

    inputs: dict[str, list[float]]
    outputs: dict[str, list[float]]

    @property
    def time(self) -> list[float]:
        """Communication points in s."""
        return self.outputs["time"]


def reference_inputs(fmu: Fmu, time: float) -> dict[str, float]:
    """The inputs of the reference experiment at `time` (s): sines, given as (amplitude, Hz)."""
    return {
        name: amplitude * math.sin(2.0 * math.pi * frequency * time)
        for name, (amplitude, frequency) in fmu.reference_inputs.items()
    }


def reference_result(fmu: Fmu, *, exact: bool = True) -> ReferenceResult:
    """The default experiment: as exactly as possible, or with the default solver settings.

    Raises RuntimeError where the experiment fails, which is a mistake in the declaration.
    """
    engine = fmu.system.create(table_of(fmu), "")
    by_name = engine.table.by_name
    choices = {v.name: v for v in fmu.variables if v.kind == CHOICE}
    for name, value in fmu.reference_start.items():
        type_ = choices[name].type if name in choices else None
        if type_ is not None:
            engine.set_integer([by_name[name]], [type_.number(str(value))])
        else:
            engine.set_real([by_name[name]], [float(value)])
    method = choices.get("solver.method")
    if exact and method is not None and method.type is not None:
        engine.set_integer([by_name[method.name]], [method.type.number("adaptive")])
    engine.setup_experiment(0.0, None, TOLERANCE if exact else None)
    engine.enter_initialization()
    names = [v.name for v in fmu.ordered() if v.kind == OUTPUT]
    references = [by_name[name] for name in names]
    inputs: dict[str, list[float]] = {"time": [], **{n: [] for n in fmu.reference_inputs}}
    outputs: dict[str, list[float]] = {"time": [], **{n: [] for n in names}}
    count = round(fmu.stop_time / fmu.step_size)
    for i in range(count + 1):
        time = i * fmu.step_size
        inputs["time"].append(time)
        for name, x in reference_inputs(fmu, time).items():
            engine.set_real([by_name[name]], [x])
            inputs[name].append(x)
        if i == 0:
            engine.exit_initialization()
        outputs["time"].append(time)
        for name, x in zip(names, engine.get_real(references), strict=True):
            outputs[name].append(x)
        if i < count:
            engine.do_step(time, (i + 1) * fmu.step_size - time)
        if engine.queue:
            raise RuntimeError(f"{fmu.name}: {engine.queue[0].msg}")
    return ReferenceResult(inputs, outputs)

"""The reference result of an FMU: its default experiment, computed as exactly as the kernel can.

From the default start values, with the inputs that the declaration names, in the order in which
fmpy and others call: at each communication point the outputs are read, then the inputs of that
point are set, and held over the step. (Those of the first are set in initialization mode too.) What
an output with direct feedthrough shows thus belongs to the inputs of the step that ends there.
Plants are integrated by `adaptive` at a relative tolerance of 1e-13.
"""

from __future__ import annotations

import math
from typing import NamedTuple

from ..errors import CurveboundError
from .declaration import CHOICE, OUTPUT, Fmu
from .slave import table_of
from .table import ERROR

__all__ = ["ReferenceResult", "reference_inputs", "reference_result"]

TOLERANCE = 1e-13


class ReferenceResult(NamedTuple):
    """Columns by name (`time` in s first, then SI units), all of one length.

    doubts: warnings of the engine, of a motion that the tolerance is too close for.
    """

    inputs: dict[str, list[float]]
    outputs: dict[str, list[float]]
    doubts: list[str]

    @property
    def time(self) -> list[float]:
        """Communication points in s."""
        return self.outputs["time"]


def reference_inputs(fmu: Fmu, time: float) -> dict[str, float]:
    """The inputs of the reference experiment at `time` (s); enumerations by number."""
    return {name: _value(fmu, name, given, time) for name, given in fmu.reference_inputs.items()}


def _value(fmu: Fmu, name: str, given: float | str | tuple[float, float], time: float) -> float:
    if isinstance(given, tuple):
        amplitude, frequency = given
        return amplitude * math.sin(2.0 * math.pi * frequency * time)
    if isinstance(given, str):
        type_ = next(v.type for v in fmu.variables if v.name == name)
        if type_ is None:
            raise RuntimeError(f"{fmu.name}: {name} is no enumeration, and cannot be {given}")
        return float(type_.number(given))
    return given


def reference_result(fmu: Fmu, *, exact: bool = True) -> ReferenceResult:
    """The default experiment: as exactly as possible, or with the default solver settings.

    Raises CurveboundError where the experiment fails, which is a mistake in the declaration.
    """
    assert fmu.system is not None
    engine = fmu.system.create(table_of(fmu), "")
    by_name = engine.table.by_name
    choices = {v.name: v for v in fmu.variables if v.kind == CHOICE}
    method = choices.get("solver.method")
    if exact and method is not None and method.type is not None:
        engine.set_integer([by_name[method.name]], [method.type.number("adaptive")])
    names = [v.name for _, v in fmu.described() if v.kind == OUTPUT]
    references = [by_name[name] for name in names]
    doubts: list[str] = []
    inputs: dict[str, list[float]] = {"time": [], **{n: [] for n in fmu.reference_inputs}}
    outputs: dict[str, list[float]] = {"time": [], **{n: [] for n in names}}

    def hear(time: float) -> None:
        for message in engine.queue:
            if message.status == ERROR:
                raise CurveboundError(
                    f"The reference experiment of {fmu.name}, from the start values in its fmu.py, "
                    f"fails at t = {time:.6g} s: {message.msg}. Declare start values, inputs "
                    "(reference_inputs) or a stop_time with which it runs."
                )
            doubts.append(message.msg)
        engine.queue.clear()

    def set_inputs(time: float) -> None:
        for name, x in reference_inputs(fmu, time).items():
            if name in choices:
                engine.set_integer([by_name[name]], [int(x)])
            else:
                engine.set_real([by_name[name]], [x])

    engine.setup_experiment(0.0, None, TOLERANCE if exact else None)
    engine.enter_initialization()
    set_inputs(0.0)
    engine.exit_initialization()
    hear(0.0)
    count = round(fmu.stop_time / fmu.step_size)
    for i in range(count + 1):
        time = i * fmu.step_size
        outputs["time"].append(time)
        values = engine.get_real(references)
        hear(time)
        for name, x in zip(names, values, strict=True):
            outputs[name].append(x)
        inputs["time"].append(time)
        for name, x in reference_inputs(fmu, time).items():
            inputs[name].append(x)
        set_inputs(time)
        if i < count:
            engine.do_step(time, (i + 1) * fmu.step_size - time)
        hear(time)
    return ReferenceResult(inputs, outputs, doubts)

"""An FMU through fmpy alone, with its log messages collected."""

from __future__ import annotations

import array
import copy
import sys
from collections.abc import Iterable, Mapping, Sequence
from ctypes import CFUNCTYPE, c_char_p, c_int, c_void_p, cast, string_at
from pathlib import Path

import numpy as np
from fmpy import calloc, extract, free, read_model_description, simulate_fmu
from fmpy.fmi1 import FMICallException
from fmpy.fmi2 import (
    FMU2Slave,
    fmi2CallbackAllocateMemoryTYPE,
    fmi2CallbackFreeMemoryTYPE,
    fmi2CallbackFunctions,
    fmi2CallbackLoggerTYPE,
)

OK, WARNING, DISCARD, ERROR, FATAL = range(5)

Value = float | int | str

#: fmi2CallbackLogger with the first of its variadic arguments. fmpy's proxy for these serves one
#: instance at a time: it passes the messages of all to the logger that was added last.
_Logger = CFUNCTYPE(None, c_void_p, c_char_p, c_int, c_char_p, c_char_p, c_void_p)


class Extracted:
    """An extracted FMU: folder, description and its variables by name.

    `path` is the .fmu, or a folder into which it was extracted before.
    """

    def __init__(self, path: Path) -> None:
        self.path = path
        self.folder = path if path.is_dir() else Path(extract(str(path)))
        self.description = read_model_description(str(self.folder))
        self.name = self.description.modelName
        self.guid = self.description.guid
        self.variables = {v.name: v for v in self.description.modelVariables}
        reals = [v for v in self.variables.values() if v.type == "Real"]
        self.inputs = [v.name for v in reals if v.causality == "input"]
        self.outputs = [v.name for v in reals if v.causality == "output"]
        #: whether a binary of this project turns every failure into fmi2Error
        own = (
            self.folder
            / "binaries"
            / ("win64" if sys.platform == "win32" else "linux64")
            / "guid.txt"
        )
        self.forwarded = own.is_file()

        self._loaded: FMU2Slave | None = None

    def slave(self, name: str) -> FMU2Slave:
        """A new FMU2Slave. fmpy looks up the library's functions once: that takes milliseconds."""
        if self._loaded is None:
            self._loaded = FMU2Slave(
                guid=self.guid,
                unzipDirectory=str(self.folder),
                modelIdentifier=self.description.coSimulation.modelIdentifier,
            )
        slave = copy.copy(self._loaded)
        slave.instanceName = name
        return slave

    def number(self, name: str, value: Value) -> float:
        """A value for the variable `name`: items of an enumeration may be given by their names."""
        if isinstance(value, str):
            items = [item.name for item in self.variables[name].declaredType.items]
            return items.index(value) + 1
        return value

    def numbers(self, values: Mapping[str, Value]) -> dict[str, float]:
        """Start values as fmpy.simulate_fmu takes them."""
        return {name: self.number(name, value) for name, value in values.items()}


class Instance:
    """One instance of an extracted FMU; `messages` collects (status, text) of its log."""

    def __init__(self, fmu: Extracted, *, name: str = "instance", logging: bool = True) -> None:
        self.fmu = fmu
        self.messages: list[tuple[int, str]] = []
        self.time = 0.0
        #: fmi2Fatal: nothing may be called any more
        self.lost = False
        callbacks = fmi2CallbackFunctions()
        self._logger = _Logger(self._log)
        callbacks.logger = cast(self._logger, fmi2CallbackLoggerTYPE)
        callbacks.allocateMemory = fmi2CallbackAllocateMemoryTYPE(calloc)
        callbacks.freeMemory = fmi2CallbackFreeMemoryTYPE(free)
        self.slave = fmu.slave(name)
        self.slave.instantiate(callbacks=callbacks, loggingOn=logging)
        self._reals = [fmu.variables[n].valueReference for n in fmu.outputs]

    def _log(
        self, _: object, name: bytes, status: int, category: bytes, text: bytes, first: int | None
    ) -> None:
        if text == b"%s":
            text = string_at(first)
        self.messages.append((status, text.decode()))

    @property
    def errors(self) -> list[str]:
        """The texts of the error messages so far."""
        return [text for status, text in self.messages if status >= ERROR]

    def status(self, function: str, *arguments: object) -> int:
        """The status of a call of a method of FMU2Slave."""
        try:
            result = getattr(self.slave, function)(*arguments)
        except FMICallException as error:
            self.lost = error.status == FATAL
            return error.status
        return result if isinstance(result, int) else OK

    # -- values ------------------------------------------------------------------------------------
    def set(self, values: Mapping[str, Value]) -> None:
        for name, value in values.items():
            variable = self.fmu.variables[name]
            number = self.fmu.number(name, value)
            if variable.type == "Real":
                self.slave.setReal([variable.valueReference], [number])
            else:
                self.slave.setInteger([variable.valueReference], [int(number)])

    def slope(self, slopes: Mapping[str, float]) -> None:
        """Derivatives of inputs over the next step."""
        vrs = [self.fmu.variables[name].valueReference for name in slopes]
        self.slave.setRealInputDerivatives(vrs, [1] * len(vrs), list(slopes.values()))

    def rates(self, *names: str) -> list[float]:
        """Derivatives of outputs."""
        vrs = [self.fmu.variables[name].valueReference for name in names]
        return self.slave.getRealOutputDerivatives(vrs, [1] * len(vrs))

    def get(self, *names: str) -> list[float]:
        values = []
        for name in names:
            variable = self.fmu.variables[name]
            read = self.slave.getReal if variable.type == "Real" else self.slave.getInteger
            values += read([variable.valueReference])
        return values

    def __getitem__(self, name: str) -> float:
        return self.get(name)[0]

    def reals(self) -> list[float]:
        """All Real outputs."""
        return self.slave.getReal(self._reals)

    def bits(self) -> bytes:
        """All outputs, bit for bit."""
        return array.array("d", self.reals()).tobytes()

    # -- life cycle --------------------------------------------------------------------------------
    def start(
        self,
        parameters: Mapping[str, Value] | None = None,
        *,
        start_time: float = 0.0,
        stop_time: float | None = None,
        tolerance: float | None = None,
    ) -> Instance:
        """Set the parameters (and initial inputs) and initialise."""
        self.slave.setupExperiment(tolerance=tolerance, startTime=start_time, stopTime=stop_time)
        self.set(parameters or {})
        self.slave.enterInitializationMode()
        self.slave.exitInitializationMode()
        self.time = start_time
        return self

    def step(self, size: float) -> None:
        """A communication step from the present time on."""
        self.slave.doStep(
            currentCommunicationPoint=self.time,
            communicationStepSize=size,
            noSetFMUStatePriorToCurrentPoint=1,
        )
        self.time += size

    def run(self, count: int, size: float) -> None:
        """`count` steps that end at multiples of `size` after the present time."""
        begin = self.time
        for i in range(count):
            end = begin + (i + 1) * size
            self.step(end - self.time)
            self.time = end

    def step_status(self, time: float, size: float) -> int:
        """The status of a communication step that may fail."""
        return self.status("doStep", time, size)

    def free(self) -> None:
        if not self.lost and self.slave.component is not None:
            # not freeInstance(), which also closes the library that others share
            self.slave.fmi2FreeInstance(self.slave.component)
            self.slave.component = None

    def __enter__(self) -> Instance:
        return self

    def __exit__(self, *_: object) -> None:
        self.free()

    # -- states ------------------------------------------------------------------------------------
    def serialized(self) -> bytes:
        """The present state as bytes."""
        state = self.slave.getFMUstate()
        data = self.slave.serializeFMUstate(state)
        self.slave.freeFMUstate(state)
        return data

    def inner_state(self) -> bytes:
        """What the FMU's own code saves, without what the binary adds to it."""
        data = self.serialized()
        return data[data.index(b'{"guid"') :]

    def restore(self, data: bytes, time: float) -> None:
        """Return to serialised bytes."""
        state = self.slave.deSerializeFMUstate(data)
        self.slave.setFMUstate(state)
        self.slave.freeFMUstate(state)
        self.time = time


def simulated(
    fmu: Extracted,
    parameters: Mapping[str, Value],
    output: Sequence[str],
    *,
    stop_time: float = 10.0,
    interval: float = 0.01,
    **settings: object,
) -> np.ndarray:
    """fmpy.simulate_fmu from 0 to `stop_time` with communication steps of `interval`."""
    return simulate_fmu(
        str(fmu.folder),
        start_values=fmu.numbers(parameters),
        output=list(output),
        stop_time=stop_time,
        output_interval=interval,
        model_description=fmu.description,
        **settings,
    )


def final(result: np.ndarray, names: Iterable[str]) -> list[float]:
    """The last values of some columns."""
    return [float(result[name][-1]) for name in names]

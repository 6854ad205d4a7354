"""FMU instances on fmpy's FMU2Slave: loading, the state machine, logging, ending."""

from __future__ import annotations

import copy
import ctypes
import math
from collections.abc import Callable, Iterable
from contextlib import suppress
from ctypes import byref, c_double, c_int, c_size_t, c_uint, c_void_p
from functools import cache
from itertools import count
from typing import Any
from weakref import WeakValueDictionary

from .fmu import Fmu, Value, extracted, loading

__all__ = ["CallFailed", "Ended", "Instance", "Library", "Log", "status_name"]

WARNING, DISCARD, ERROR, FATAL = 1, 2, 3, 4
_STATUS = ("OK", "Warning", "Discard", "Error", "Fatal", "Pending")
_LAST_SUCCESSFUL_TIME, _TERMINATED = 2, 3  # fmi2StatusKind
_KEPT = 200  # log messages kept per run: a chatty FMU must not fill the memory


def status_name(status: int) -> str:
    """An fmi2Status as FMI calls it, fmi2Error say."""
    return f"fmi2{_STATUS[status] if 0 <= status < len(_STATUS) else status}"


class CallFailed(Exception):
    """An FMI call that returned neither OK nor Warning."""

    def __init__(self, component: str, function: str, status: int, cause: str):
        super().__init__(f"{component}: {cause}")
        self.component = component
        self.function = function
        self.status = status
        self.cause = cause


class Ended(Exception):
    """A component asked to end the simulation: when, in s, and what it said about it."""

    def __init__(self, component: str, time: float, said: str):
        super().__init__(f"{component} ended the simulation at t = {time:.9g} s")
        self.component = component
        self.time = time
        self.said = said


class Log:
    """Callbacks shared by all instances of a scene: keeps what the FMUs say, by component.

    fmpy's library, which puts printf arguments into a message, knows one logger in a process: that
    is `_hand_on` here, which lives as long, and tells the scenes apart by their environment.
    """

    def __init__(self) -> None:
        from fmpy import calloc, free
        from fmpy.fmi2 import (
            fmi2CallbackAllocateMemoryTYPE,
            fmi2CallbackFreeMemoryTYPE,
            fmi2CallbackFunctions,
        )

        self.entries: list[tuple[str, int, str]] = []
        self.callbacks = fmi2CallbackFunctions()
        self.callbacks.allocateMemory = fmi2CallbackAllocateMemoryTYPE(calloc)
        self.callbacks.freeMemory = fmi2CallbackFreeMemoryTYPE(free)
        number = next(_numbers)
        self.callbacks.componentEnvironment = number
        _logs[number] = self
        self._register()

    def _register(self) -> None:
        """Be the process's logger: another user of fmpy may have become it meanwhile."""
        self.callbacks.logger = _logger()
        with suppress(ImportError, OSError):  # where there is a binary of it
            from fmpy.logging import addLoggerProxy

            addLoggerProxy(byref(self.callbacks))

    def write(self, name: bytes, status: int, text: bytes) -> None:
        """Take a message."""
        entry = (_text(name), int(status), _text(text).strip())
        room = len(self.entries) < _KEPT or status > WARNING  # why a run failed is always kept
        if status >= WARNING and room and entry not in self.entries:
            self.entries.append(entry)

    def clear(self) -> None:
        """Forget everything: at the start of a run."""
        self.entries.clear()
        self._register()

    def cause(self, component: str, least: int = DISCARD) -> str:
        """The last thing that `component` said with a status of `least` or worse, or ''."""
        for name, status, text in reversed(self.entries):
            if name == component and status >= least and text:
                return text
        return ""

    def warnings(self) -> list[str]:
        """One line per different warning."""
        return [f"{name}: {text}" for name, status, text in self.entries if status == WARNING]


_numbers = count(1)
_logs: WeakValueDictionary[int, Log] = WeakValueDictionary()


@cache
def _logger() -> Any:
    """The C function of `_hand_on`, one for the whole process."""
    from fmpy.fmi2 import fmi2CallbackLoggerTYPE

    return fmi2CallbackLoggerTYPE(_hand_on)


def _hand_on(
    environment: int | None, name: bytes, status: int, category: bytes, text: bytes
) -> None:
    """Give a message to the scene that it belongs to, or treat it as fmpy does where there is none.

    An fmi2CallbackLogger.
    """
    log = _logs.get(environment or 0)
    if log is not None:
        log.write(name, status, text)
    else:
        from fmpy.fmi2 import printLogMessage

        printLogMessage(environment, name, status, category, text)


def _text(data: bytes | None) -> str:
    return (data or b"").decode("utf-8", "replace")


class Library:
    """The loaded binary of one FMU: its functions, shared by all instances in the scene.

    The functions are FMU2Slave's own library's, fetched without argument types: they are called
    with prepared ctypes objects only, which spares the conversion at each call.
    """

    def __init__(self, fmu: Fmu) -> None:
        from fmpy.fmi2 import FMU2Slave

        self.fmu = fmu
        with loading(fmu):
            self.slave = FMU2Slave(
                guid=fmu.guid,
                unzipDirectory=str(extracted(fmu)),
                modelIdentifier=fmu.identifier,
                instanceName=fmu.identifier,
                requireFunctions=False,
            )
        self._functions: dict[str, Any] = {}

    def function(self, name: str) -> Any:
        """The C function `name`, to be called with ctypes objects; returns the status."""
        function = self._functions.get(name)
        if function is None:
            function = self.slave.dll[name]
            function.restype = c_int
            self._functions[name] = function
        return function

    def unload(self) -> None:
        """Close the binary; no instance of it may be left."""
        self._functions.clear()
        self.slave.freeLibrary()


class Instance:
    """One instance, from instantiation to its end; every failing call raises CallFailed."""

    def __init__(self, name: str, library: Library, log: Log) -> None:
        self.name = name
        self.fmu = library.fmu
        self.library = library
        self.log = log
        self.alive = True
        self.running = False  # between the entry to initialization and terminate
        self.failed = False
        self._saved: dict[int, c_void_p] = {}
        self._changed: set[str] = set()
        self.slave = copy.copy(library.slave)
        self.slave.instanceName = name
        self.alive = False
        with loading(self.fmu):
            try:
                self.slave.instantiate(callbacks=log.callbacks, loggingOn=True)
            except Exception as error:
                raise ValueError(log.cause(name) or str(error)) from error
        self.alive = True
        self.pointer = c_void_p(self.slave.component)

    def call(self, name: str, *arguments: Any) -> int:
        """Call fmi2`name` of this instance and judge its status."""
        status = int(self.library.function("fmi2" + name)(self.pointer, *arguments))
        if status > WARNING:
            self.fail(name, status)
        return status

    def fail(self, function: str, status: int) -> None:
        """What follows from a call that returned `status`.

        Raises Ended where a discarded step means that the FMU ends the simulation (one that logs an
        error has failed, whatever it asks for), otherwise CallFailed with what the FMU said.
        """
        said = self.log.cause(self.name)
        discarded = status == DISCARD and not self.log.cause(self.name, ERROR)
        if discarded and self._status("Boolean", _TERMINATED, c_int(0)):
            time = self._status("Real", _LAST_SUCCESSFUL_TIME, c_double(math.nan))
            raise Ended(self.name, float(time), said)
        self.failed = not discarded
        if status >= FATAL:
            self.alive = False  # nothing may be called any more, fmi2FreeInstance included
        cause = f"fmi2{function} returned {status_name(status)}" + (f": {said}" if said else "")
        if discarded:
            cause += " (it cannot make a step of this size: try a smaller one)"
        raise CallFailed(self.name, "fmi2" + function, status, cause)

    def _status(self, kind: str, what: int, value: Any) -> Any:
        """An answer of the FMU about its last step; `value`, of the type to ask for, if none."""
        with suppress(Exception):
            answer = type(value)(value.value)
            ask = self.library.function(f"fmi2Get{kind}Status")
            if ask(self.pointer, c_int(what), byref(answer)) == 0:
                return answer.value
        return value.value

    # values, one by one: for set-up only

    def set(self, name: str, value: Value) -> None:
        """Set a variable; `value` is of its type."""
        variable = self.fmu.variables[name]
        reference = (c_uint * 1)(variable.reference)
        data: Any
        if variable.kind == "Real":
            data = (c_double * 1)(float(value))
        elif variable.kind == "String":
            data = (ctypes.c_char_p * 1)(str(value).encode())
        else:
            data = (c_int * 1)(int(value))
        self.call("Set" + variable.kind, reference, c_size_t(1), data)

    # life

    def initialize(
        self,
        start: Iterable[tuple[str, Value]],
        tolerance: float | None,
        start_time: float,
        stop_time: float,
    ) -> None:
        """Set up the experiment, set start values and enter initialization mode."""
        self.running = True
        self.call(
            "SetupExperiment",
            c_int(tolerance is not None),
            c_double(tolerance or 0.0),
            c_double(start_time),
            c_int(1),
            c_double(stop_time),
        )
        values = dict(start)
        # what an earlier run changed goes back to the FMU's own start, should its reset forget it
        for name in self._changed - values.keys():
            variable = self.fmu.variables[name]
            if variable.start is not None:
                if variable.kind == "String":
                    self.set(name, variable.start)
                else:
                    self.set(name, variable.value(variable.start))
        for name, value in values.items():
            self.set(name, value)
        self._changed = set(values)
        self.call("EnterInitializationMode")

    def reset(self) -> bool:
        """Back to the state after instantiation; False if that needs a new instance."""
        if not self.alive or self.failed:
            return False
        status = int(self.library.function("fmi2Reset")(self.pointer))
        self.alive = status < FATAL
        return status <= WARNING

    def save(self, place: int = 0) -> None:
        """Keep the present state for `restore`, in place of the one kept there before.

        place: any number.
        """
        self.drop(place)
        state = self._saved[place] = c_void_p()
        self.call("GetFMUstate", byref(state))

    def restore(self, place: int = 0) -> None:
        """Back to the state saved in that place, which stays saved."""
        self.call("SetFMUstate", self._saved[place])

    def forget(self) -> None:
        """Free the saved states."""
        for place in list(self._saved):
            self.drop(place)

    def drop(self, place: int) -> None:
        """Free the state saved in that place, if there is one."""
        state = self._saved.pop(place, None)
        if state is not None and state.value and self.alive:
            self.library.function("fmi2FreeFMUstate")(self.pointer, byref(state))

    def terminate(self) -> None:
        """End the run; a failed instance may not be asked to."""
        if self.alive and self.running and not self.failed:
            self.forget()
            status = int(self.library.function("fmi2Terminate")(self.pointer))
            self.alive = status < FATAL
        self.running = False

    def free(self) -> None:
        """Give the instance back; safe to call at any time, any number of times."""
        self.terminate()
        if self.alive:
            self.forget()
            function: Callable[..., Any] = self.library.function("fmi2FreeInstance")
            function(self.pointer)
            self.alive = False

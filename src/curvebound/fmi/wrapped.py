"""The class for FMUs, and systems, without a binary of this project's: PythonFMU's wrapper runs it.

What is here works around PythonFMU 0.7.0's wrapper, which takes no notice of error messages and
gives references up that it does not own.
"""

from __future__ import annotations

import atexit
import contextlib
import os
import sys
from typing import Any

from .slave import Slave

__all__ = ["InitializationError", "Wrapped", "hold"]

_SETTLED: set[str] = set()


class InitializationError(Exception):
    """Initialization failed; the text is that of the log message."""


def hold(namespace: dict[str, object]) -> None:
    """Take one more reference to a main module's namespace, for ever.

    The wrapper releases a reference that it does not own each time it instantiates; without this
    the namespace would be freed while in use.
    """
    import ctypes  # here only: it takes milliseconds, and most FMUs do without

    ctypes.pythonapi.Py_IncRef(ctypes.py_object(namespace))


def settle(binary: str) -> None:
    """Let the wrapper give up its interpreter's state when Python ends.

    At the end of the process it frees that state, and after that gives it up a second time, in
    memory that may be anybody's; having given it up before, it does neither.
    """
    import ctypes

    if binary in _SETTLED:
        return
    _SETTLED.add(binary)
    # without it: a wrapper at another place, or of another make
    with contextlib.suppress(OSError, AttributeError):
        atexit.register(ctypes.CDLL(binary, mode=os.RTLD_NOLOAD).finalizePythonInterpreter)


class Wrapped(Slave):
    """A slave whose failed initialization surfaces by an exception: there is no other way."""

    def __init__(self, **kwargs: Any) -> None:
        super().__init__(**kwargs)
        for name in ("setup_experiment", "enter_initialization_mode", "exit_initialization_mode"):
            delattr(self, name)
        resources = self.resources
        if resources and sys.path.count(resources) > 1:
            sys.path.remove(resources)
        if resources and sys.platform == "linux":
            folder = os.path.dirname(resources)
            settle(os.path.join(folder, "binaries", "linux64", f"{self.modelName}.so"))

    def setup_experiment(
        self,
        start_time: float,
        stop_time: float | None = None,
        tolerance: float | None = None,
    ) -> None:
        """fmi2SetupExperiment."""
        self._surface(self.engine.setup_experiment(start_time, stop_time, tolerance))

    def enter_initialization_mode(self) -> None:
        """fmi2EnterInitializationMode."""
        self._surface(self.engine.enter_initialization())

    def exit_initialization_mode(self) -> None:
        """fmi2ExitInitializationMode."""
        self._surface(self.engine.exit_initialization())

    def _surface(self, succeeded: bool) -> None:
        if not succeeded:
            queue = self.engine.queue
            text = queue[-1].msg
            queue.clear()
            raise InitializationError(text)

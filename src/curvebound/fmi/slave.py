"""The class that PythonFMU's wrapper instantiates: a thin shell around an Engine.

Nothing here raises towards the wrapper once an instance exists, with one exception: where no
forwarding library turns error messages into fmi2Error (see forward.c), a failed initialization has
no other way to surface.
"""

from __future__ import annotations

import atexit
import contextlib
import ctypes
import json
import os
import sys
import zlib
from threading import get_ident
from typing import TYPE_CHECKING, Any

from pythonfmu.fmi2slave import Fmi2Slave

from .declaration import CHOICE, COUNT, COUNT_PARAMETER, INPUT, OUTPUT, PARAMETER, Fmu
from .engine import Engine
from .table import ERROR, Message, Table

if TYPE_CHECKING:
    from xml.etree.ElementTree import Element

__all__ = ["Slave", "StateError", "hold", "table_of"]

_KINDS = (PARAMETER, CHOICE, COUNT_PARAMETER, INPUT, OUTPUT, COUNT)
_TABLES: dict[int, Table] = {}
_SETTLED: set[str] = set()


def hold(namespace: dict[str, object]) -> None:
    """Take one more reference to a main module's namespace, for ever.

    PythonFMU 0.7.0's wrapper releases a reference that it does not own each time it instantiates;
    without this the namespace would be freed while in use.
    """
    ctypes.pythonapi.Py_IncRef(ctypes.py_object(namespace))


def settle(binary: str) -> None:
    """Let PythonFMU's wrapper give up its interpreter's state when Python ends.

    At the end of the process PythonFMU 0.7.0's wrapper frees that state, and after that gives it up
    a second time, in memory that may be anybody's; having given it up before, it does neither.
    """
    if binary in _SETTLED:
        return
    _SETTLED.add(binary)
    # without it: a wrapper at another place, or of another make
    with contextlib.suppress(OSError, AttributeError):
        atexit.register(ctypes.CDLL(binary, mode=os.RTLD_NOLOAD).finalizePythonInterpreter)


class InitializationError(Exception):
    """Initialization failed; the text is that of the log message."""


class StateError(Exception):
    """A saved state cannot be used."""


def table_of(fmu: Fmu) -> Table:
    """The engine's table of an FMU's variables; made once."""
    table = _TABLES.get(id(fmu))
    if table is None:
        variables = fmu.ordered()
        table = _TABLES[id(fmu)] = Table(
            [v.name for v in variables],
            [_KINDS.index(v.kind) for v in variables],
            [v.unit for v in variables],
            [float(v.start) for v in variables],
            [float("-inf") if v.minimum is None else float(v.minimum) for v in variables],
            [v.above for v in variables],
            [v.tunable for v in variables],
            [[name for name, _ in v.type.items] if v.type else [] for v in variables],
        )
    return table


class Slave(Fmi2Slave):  # type: ignore[misc]
    """Base of the generated main class of every FMU, which sets the class attributes."""

    fmu: Fmu
    guid_text: str
    #: platforms (sys.platform) for which the FMU holds a forwarding library
    forwarded: tuple[str, ...] = ()

    def __init__(self, **kwargs: Any) -> None:
        # Not the base class's: it draws a random guid and keeps tables that are not used here.
        self.instance_name = kwargs["instance_name"]
        self.resources = kwargs.get("resources")
        self.modelName = self.fmu.name
        fmu = self.fmu
        engine: Engine = fmu.system.create(table_of(fmu), self.guid_text)
        self.engine = engine
        # Instance attributes: the wrapper then calls the compiled methods without a Python frame.
        for name in ("do_step", "get_real", "set_real", "get_integer", "set_integer"):
            setattr(self, name, getattr(engine, name))
        if sys.platform in self.forwarded:
            # to the forwarding library, which takes it as soon as the wrapper has returned
            handover = sys.__dict__.setdefault("curvebound_handover", {})
            handover[get_ident()] = (engine.do_step, engine.get_real, engine.set_real, engine.queue)
        resources = self.resources
        if resources and sys.path.count(resources) > 1:
            sys.path.remove(resources)
        if resources and sys.platform == "linux" and "linux" not in self.forwarded:
            folder = os.path.dirname(resources)
            settle(os.path.join(folder, "binaries", "linux64", f"{self.modelName}.so"))

    # -- called by the wrapper ---------------------------------------------------------------------
    def do_step(self, current_time: float, step_size: float) -> bool:
        """Replaced by the engine's method in each instance."""
        return self.engine.do_step(current_time, step_size)

    def setup_experiment(
        self,
        start_time: float,
        stop_time: float | None = None,
        tolerance: float | None = None,
    ) -> None:
        """fmi2SetupExperiment."""
        self._surface(
            self.engine.setup_experiment(
                start_time, tolerance is not None, 0.0 if tolerance is None else tolerance
            )
        )

    def enter_initialization_mode(self) -> None:
        """fmi2EnterInitializationMode."""
        self._surface(self.engine.enter_initialization())

    def exit_initialization_mode(self) -> None:
        """fmi2ExitInitializationMode."""
        self._surface(self.engine.exit_initialization())

    def terminate(self) -> None:
        """fmi2Terminate."""
        self.engine.terminate()

    def get_boolean(self, vrs: list[int]) -> list[bool]:
        """There is no Boolean variable."""
        return [bool(self._none_of(vr, "Boolean")) for vr in vrs]

    def set_boolean(self, vrs: list[int], values: list[bool]) -> None:
        """There is no Boolean variable."""
        self.get_boolean(vrs)

    def get_string(self, vrs: list[int]) -> list[str]:
        """There is no String variable."""
        return [self._none_of(vr, "String") for vr in vrs]

    def set_string(self, vrs: list[int], values: list[str]) -> None:
        """There is no String variable."""
        self.get_string(vrs)

    def _none_of(self, vr: int, type_: str) -> str:
        self.engine.unknown(vr, type_)
        return ""

    def _surface(self, succeeded: bool) -> None:
        """Make a failed initialization known to a host without forwarding library."""
        if not succeeded and sys.platform not in self.forwarded:
            queue = self.engine.queue
            text = queue[-1].msg
            queue.clear()
            raise InitializationError(text)

    def _get_log_queue(self) -> list[Message]:
        return self.engine.queue

    # -- saved states ------------------------------------------------------------------------------
    def _get_fmu_state(self) -> dict[str, Any]:
        return {"guid": self.guid_text, "state": self.engine.get_state()}

    def _set_fmu_state(self, state: dict[str, Any]) -> None:
        if state.get("guid") != self.guid_text:
            self.engine.say(
                ERROR,
                f"the state has guid {state.get('guid')!r}, this FMU has {self.guid_text!r}: "
                "only a state that this FMU wrote can be restored",
            )
            return
        self.engine.set_state(state["state"])

    @staticmethod
    def _fmu_state_to_bytes(state: dict[str, Any]) -> bytes:
        """JSON (repr of floats, hence every bit) with a checksum in front."""
        text = json.dumps(state).encode()
        return f"{zlib.crc32(text):08x}".encode() + text

    @staticmethod
    def _fmu_state_from_bytes(data: bytes) -> dict[str, Any]:
        text = data[8:]
        if data[:8] != f"{zlib.crc32(text):08x}".encode():
            raise StateError(
                f"the {len(data)} bytes of serialised state are truncated or altered: "
                "only bytes as fmi2SerializeFMUstate wrote them can be restored"
            )
        state: dict[str, Any] = json.loads(text)
        return state

    # -- called by PythonFMU's builder -------------------------------------------------------------
    def to_xml(self, model_options: dict[str, str] | None = None) -> Element:
        """modelDescription.xml; needs the package curvebound, hence only where FMUs are built."""
        from curvebound.fmi.description import describe

        return describe(self.fmu, self.guid_text, self.engine)

"""The class that an FMU's binary instantiates: a thin shell around an Engine.

Nothing here raises once an instance exists, but for what interrupts interpreted code from outside.
"""

from __future__ import annotations

import json
import os
import sys
import zlib
from typing import TYPE_CHECKING, Any

from pythonfmu.fmi2slave import Fmi2Slave

from .declaration import CHOICE, COUNT, COUNT_PARAMETER, INPUT, OUTPUT, PARAMETER, Fmu
from .derivatives import DerivativeEngine
from .engine import Engine
from .table import ERROR, WARNING, Message, Table

if TYPE_CHECKING:
    from xml.etree.ElementTree import Element

__all__ = ["Slave", "StateError", "table_of"]

_KINDS = (PARAMETER, CHOICE, COUNT_PARAMETER, INPUT, OUTPUT, COUNT)
#: by the declaration's id, with the declaration, so that the id stays its own
_TABLES: dict[int, tuple[Fmu, Table]] = {}


#: FMUs of which it was said that they run interpreted
_SAID: set[str] = set()
#: files of extension modules -> the platform they are for
_SUFFIXES = {".abi3.so": "linux64", ".pyd": "win64"}

#: methods of the engine that stand for the slave's own, without a Python frame in between
_ENGINE = {
    **{
        name: name
        for name in (
            *("do_step", "get_real", "set_real", "get_integer", "set_integer"),
            *("set_real_input_derivatives", "get_real_output_derivatives"),
            "get_directional_derivative",
        )
    },
    "setup_experiment": "setup_experiment",
    "enter_initialization_mode": "enter_initialization",
    "exit_initialization_mode": "exit_initialization",
    "terminate": "terminate",
}


class StateError(Exception):
    """A saved state cannot be used."""


def table_of(fmu: Fmu) -> Table:
    """The engine's table of an FMU's variables; made once."""
    if id(fmu) not in _TABLES:
        variables = fmu.ordered()
        table = Table(
            [v.name for v in variables],
            [_KINDS.index(v.kind) for v in variables],
            [v.unit for v in variables],
            [float(v.start) for v in variables],
            [float("-inf") if v.minimum is None else float(v.minimum) for v in variables],
            [v.above for v in variables],
            [v.tunable for v in variables],
            [[name for name, _ in v.type.items] if v.type else [] for v in variables],
        )
        _TABLES[id(fmu)] = fmu, table
    return _TABLES[id(fmu)][1]


def interpreted(name: str, resources: str | None) -> str:
    """What to say, once in a process, of an FMU whose code is not compiled for this Python."""
    package = sys.modules.get(__name__.partition(".")[0])
    reason = getattr(package, "NOT_COMPILED", "")
    if not reason or name in _SAID:
        return ""
    _SAID.add(name)
    # Here only: it takes milliseconds, and most FMUs do without. Not `platform`: it asks Windows'
    # management service from 3.12 on: that may take seconds, and ends the process under Wine.
    import sysconfig

    files = os.listdir(resources) if resources and os.path.isdir(resources) else []
    places = [
        place for suffix, place in _SUFFIXES.items() if any(f.endswith(suffix) for f in files)
    ]
    version = ".".join(map(str, sys.version_info[:3]))
    here = f"{sys.implementation.name} {version} on {sysconfig.get_platform()}"
    if not places:
        return (
            f"{name} runs interpreted, 25 to 70 times slower per step, in {here}, since it was "
            "built without compiled code: build it where there is a C compiler, without "
            "--no-compile"
        )
    return (
        f"{name} runs interpreted, 25 to 70 times slower per step, in {here} ({reason}): it is "
        f"compiled for CPython 3.10 and later on {' and '.join(places)}; let the tool use such a "
        "Python, or build the FMU on a machine like this"
    )


class Slave(Fmi2Slave):  # type: ignore[misc]
    """Base of the generated main class of every FMU, which sets the class attributes."""

    fmu: Fmu
    guid_text: str
    #: whether the binaries of all platforms pass the functions about derivatives on
    derivatives = True

    def __init__(self, **kwargs: Any) -> None:
        # Not the base class's: it draws a random guid and keeps tables that are not used here.
        self.instance_name = kwargs["instance_name"]
        self.resources = kwargs.get("resources")
        self.modelName = self.fmu.name
        assert self.fmu.system is not None
        self.engine: Engine = self.fmu.system.create(table_of(self.fmu), self.guid_text)
        for name, own in _ENGINE.items():
            setattr(self, name, getattr(self.engine, own))
        # the C functions of a compiled engine, which the binary calls in place of its methods
        self.direct: object = None
        if isinstance(self.engine, DerivativeEngine):
            module = sys.modules[DerivativeEngine.__module__]
            self.direct = getattr(module, "__pyx_capi__", None)
        warning = interpreted(self.modelName, self.resources)
        if warning:
            self.engine.say(WARNING, warning)

    def do_step(self, current_time: float, step_size: float) -> bool:
        """Replaced by the engine's method in each instance."""
        return self.engine.do_step(current_time, step_size)

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

        return describe(self.fmu, self.guid_text, self.engine, derivatives=self.derivatives)

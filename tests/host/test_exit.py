"""The end of a process that has used FMUs: nothing is touched that has been freed."""

from __future__ import annotations

import subprocess
import sys
from collections.abc import Callable
from pathlib import Path

import pytest

from curvebound.fmi import binaries
from curvebound.fmi.build import build

from .conftest import PLAIN, Host, Unpacked, unpacked

_PYTHON_HOST = """
import sys
from fmpy.fmi2 import FMU2Slave

folder, guid, identifier = sys.argv[1:]
for round in range(2):
    instances = []
    for k in range(3):
        fmu = FMU2Slave(
            guid=guid, unzipDirectory=folder, modelIdentifier=identifier, instanceName=str(k)
        )
        fmu.instantiate()
        fmu.setupExperiment(startTime=0.0)
        fmu.enterInitializationMode()
        fmu.exitInitializationMode()
        fmu.doStep(0.0, 0.01)
        instances.append(fmu)
    for fmu in instances:
        fmu.terminate()
        fmu.fmi2FreeInstance(fmu.component)
print("done")
"""


@pytest.fixture(scope="session")
def poison(compile_host: Callable[..., Path], tmp_path_factory: pytest.TempPathFactory) -> Path:
    library = tmp_path_factory.mktemp("poison") / "poison.so"
    return compile_host("poison.c", library, "-O1", "-shared", "-fPIC", "-fno-builtin")


def run_python(fmu: Unpacked, poison: Path) -> None:
    done = subprocess.run(
        [sys.executable, "-c", _PYTHON_HOST, str(fmu.folder), fmu.guid, fmu.identifier],
        env={**PLAIN, "LD_PRELOAD": str(poison)},
        capture_output=True,
        text=True,
        timeout=120,
    )
    assert (done.returncode, done.stdout) == (0, "done\n"), done.stderr


def test_a_python_process_ends_cleanly(bead: Unpacked, poison: Path) -> None:
    run_python(bead, poison)


@pytest.mark.usefixtures("short_reference")
def test_one_with_pythonfmus_binary_ends_cleanly(
    poison: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(binaries, "compiler_for", lambda target: None)
    monkeypatch.setattr(binaries, "compiled_directory", lambda: tmp_path)
    run_python(unpacked(build("BeadOnWire", tmp_path).path, tmp_path / "bead"), poison)


@pytest.mark.usefixtures("system_python")
def test_a_c_process_ends_cleanly(host: Host, bead: Unpacked, poison: Path) -> None:
    commands = [*bead.start(), bead.new(instance=1), "free 0", "free 1"]
    result = host(commands, {**PLAIN, "LD_PRELOAD": str(poison)}, check=False)
    assert result.answers[-1] == ["OK"]
    assert result.status == 0


_LOADED_AGAIN = """
import _ctypes, ctypes, sys

binary, guid, uri, count = sys.argv[1:]
LOG = ctypes.CFUNCTYPE(None, ctypes.c_void_p, ctypes.c_char_p, ctypes.c_int, ctypes.c_char_p,
                       ctypes.c_char_p)


class Callbacks(ctypes.Structure):
    _fields_ = [("logger", LOG), *((name, ctypes.c_void_p) for name in "abcd")]


callbacks = Callbacks(LOG(lambda *message: print(message)), None, None, None, None)


def once():
    fmu = ctypes.CDLL(binary)
    fmu.fmi2Instantiate.restype = ctypes.c_void_p
    given = guid.encode(), uri.encode(), ctypes.byref(callbacks)
    component = ctypes.c_void_p(fmu.fmi2Instantiate(b"i", 1, *given, 0, 0))
    assert component
    fmu.fmi2FreeInstance(component)
    _ctypes.dlclose(fmu._handle)


def resident():
    with open("/proc/self/statm") as statm:
        return int(statm.read().split()[1]) * 4096


count = int(count)
for _ in range(100):
    once()
before = resident()
for _ in range(count):
    once()
print((resident() - before) // count)
"""


def test_a_library_loaded_again_and_again_leaves_little(bead: Unpacked) -> None:
    """What is left is what ctypes keeps."""
    own = (str(bead.binary), bead.guid, bead.uri, "1000")
    done = subprocess.run(
        [sys.executable, "-c", _LOADED_AGAIN, *own],
        capture_output=True,
        text=True,
        timeout=120,
    )
    assert int(done.stdout) < 1500, done.stderr

"""Processes in which no Python can run the FMU: a message with cause and remedy, and no crash."""

from __future__ import annotations

import re
import resource
import shutil
import subprocess

import pytest

from .conftest import PLAIN, parse

_PYPY = """
import ctypes, sys
folder, binary, guid = sys.argv[1:]
LOG = ctypes.CFUNCTYPE(None, ctypes.c_void_p, ctypes.c_char_p, ctypes.c_int, ctypes.c_char_p,
                       ctypes.c_char_p)


class Callbacks(ctypes.Structure):
    _fields_ = [("logger", LOG), *((name, ctypes.c_void_p) for name in "abcd")]


log = LOG(lambda environment, name, status, category, text: print(status, text.decode()))
instantiate = ctypes.CDLL(binary).fmi2Instantiate
instantiate.restype = ctypes.c_void_p
instantiate.argtypes = [ctypes.c_char_p, ctypes.c_int, ctypes.c_char_p, ctypes.c_char_p,
                        ctypes.c_void_p, ctypes.c_int, ctypes.c_int]
callbacks = Callbacks(log, None, None, None, None)
where = f"file://{folder}/resources".encode()
print(instantiate(b"i", 1, guid.encode(), where, ctypes.byref(callbacks), 0, 0))
"""


@pytest.mark.slow  # .ci/run waits for its installations before the slow tests
def test_pypy(bead):
    program = shutil.which("pypy3") or pytest.skip("no pypy3: run .ci/importers")
    done = subprocess.run(
        [program, "-c", _PYPY, str(bead.folder), str(bead.binary), bead.guid],
        capture_output=True,
        text=True,
    )
    assert done.returncode == 0, done.stderr
    message, component = done.stdout.splitlines()
    assert message.startswith("3 ")
    assert "PyPy" in message
    assert "load it in CPython 3.10 or newer" in message
    assert component == "None"


def test_a_process_that_has_only_some_of_pythons_functions(compile_host, bead, tmp_path):
    stub = compile_host("stub.c", tmp_path / "stub.so", "-shared", "-fPIC", "-DPyList_New=Other")
    program = compile_host("cost.c", tmp_path / "cost", "-O2")
    done = subprocess.run(
        [program, bead.binary, stub, bead.guid, bead.uri],
        env=PLAIN,
        capture_output=True,
        text=True,
    )
    assert done.returncode == 1
    assert "lacks the function PyList_New" in done.stdout
    assert "load this FMU in CPython" in done.stdout


@pytest.mark.usefixtures("system_python")
@pytest.mark.parametrize(
    "limits",
    [
        (12, 44, 52, 60, 150),
        pytest.param(
            (12, 20, 30, 40, 44, 48, 50, 52, 54, 56, 60, 70, 80, 100, 150), marks=pytest.mark.slow
        ),
    ],
    ids=("some", "many"),
)
def test_a_process_without_memory_for_an_interpreter(host_program, bead, limits):
    """Whatever the limit of its address space: an instance, or a message with the remedy."""
    commands = [*bead.start(), "setup 0 - 0 -", "enter 0", "exit 0", "step 0 0 0.1"]
    text = "".join(command.replace(" ", "\t") + "\n" for command in commands)
    answers = []
    for megabytes in limits:
        limit = megabytes << 20
        done = subprocess.run(
            [str(host_program)],
            input=text,
            env=PLAIN,
            capture_output=True,
            text=True,
            preexec_fn=lambda limit=limit: resource.setrlimit(resource.RLIMIT_AS, (limit, limit)),
        )
        assert done.returncode == 0, (megabytes, done.stderr[-2000:])
        found, logs = parse(done.stdout)
        answers.append(found[1][0])
        if answers[-1] == "OK":
            assert [a[0] for a in found] == ["OK"] * 6
        else:
            (message,) = (m for group in logs for m in group)
            assert re.search(r"cannot have the \d+ MB of memory", message[3])
            assert "ulimit -v" in message[3]
    assert answers[0] == "Error"
    assert answers[-1] == "OK"

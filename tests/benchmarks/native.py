"""The benchmark's C code: compiled with gcc -O2 on first use, called through ctypes."""

from __future__ import annotations

import ctypes
import math
import os
import shutil
import subprocess
import sys
from pathlib import Path

from curvebound import cache, fmi
from curvebound.compiling.toolchain import compiler_parts
from curvebound.errors import CurveboundError

__all__ = [
    "FLAGS",
    "SOURCES",
    "STARTS",
    "Bead",
    "LinearPendulum",
    "Pendulum",
    "State",
    "compiler",
    "kernel",
    "kernel_systems",
    "shared_library",
]

SOURCES = Path(__file__).resolve().parent / "c"
_FMI_TYPES = Path(fmi.__file__).with_name("native") / "fmi2.h"
FLAGS = ("-O2", "-std=c11", "-fPIC", "-shared", "-fvisibility=default")

_GRAVITY = 9.81


def compiler() -> str:
    """The C compiler: that of the variable CC, else gcc, else cc; CurveboundError without one."""
    for name in (os.environ.get("CC"), "gcc", "cc"):
        if name and (found := shutil.which(name)):
            return found
    raise CurveboundError(
        "The comparison with C needs a C compiler, and neither CC, gcc nor cc leads to one: "
        "install gcc, set CC, or leave the sections kernel and fmu out with --only."
    )


def shared_library(source: str, *definitions: str) -> Path:
    """Compile `source` of c/ with -D`definitions`; cached by content, flags and compiler."""
    command = [compiler(), *FLAGS, *(f"-D{text}" for text in definitions)]
    command.append(f"-I{_FMI_TYPES.parent}")
    name = Path(source).stem + (".dll" if sys.platform == "win32" else ".so")

    def make(folder: Path) -> None:
        done = subprocess.run(
            [*command, str(SOURCES / source), "-o", str(folder / name), "-lm"],
            capture_output=True,
            text=True,
            check=False,
        )
        if done.returncode:
            raise CurveboundError(f"{command[0]} failed on {source}:\n{done.stderr.strip()}")

    parts = [
        source,
        *command,
        cache.sources(SOURCES, _FMI_TYPES, Path(__file__)),
        *compiler_parts(),
    ]
    return cache.entry("bench", parts, make) / name


class State(ctypes.Structure):
    """Coordinates and rates, as `state` in physics.h."""

    _fields_ = [(name, ctypes.c_double) for name in ("q0", "q1", "v0", "v1")]


class Bead(ctypes.Structure):
    """`bead` of physics.h."""

    _fields_ = [(name, ctypes.c_double) for name in ("radius", "per_radius", "drag", "gx", "gy")]


class Pendulum(ctypes.Structure):
    """`pendulum` of physics.h."""

    _fields_ = [
        *(
            (name, ctypes.c_double)
            for name in (
                *("m1", "m2", "length", "per_length", "a", "da", "dda", "gx", "gy"),
                *("slider_damping", "pendulum_damping"),
                *("slider_fx", "slider_fy", "bob_fx", "bob_fy"),
            )
        ),
        ("shape_moves", ctypes.c_int),
        ("forced", ctypes.c_int),
    ]


class LinearPendulum(ctypes.Structure):
    """`linear_pendulum` of physics.h."""

    _fields_ = [(name, ctypes.c_double) for name in ("uu", "uth", "thu", "thth")]


def kernel() -> ctypes.CDLL:
    """The library of kernel.c with the types of its functions declared."""
    library = ctypes.CDLL(str(shared_library("kernel.c")))
    steps = [ctypes.c_double, ctypes.c_long, ctypes.POINTER(State)]
    for name, system in (
        ("run_bead_angle", [ctypes.POINTER(Bead)]),
        ("run_bead_cartesian", [ctypes.POINTER(Bead), ctypes.c_int]),
        ("run_pendulum_nonlinear", [ctypes.POINTER(Pendulum)]),
        ("run_pendulum_linear", [ctypes.POINTER(LinearPendulum)]),
    ):
        function = getattr(library, name)
        function.argtypes = [*system, *steps]
        function.restype = None
    return library


def kernel_systems() -> tuple[Bead, Pendulum, LinearPendulum]:
    """The three systems at the default parameters of the FMUs."""
    m1 = m2 = length = 1.0
    a = 0.5
    share = (m1 + m2) / m1
    return (
        Bead(1.0, 1.0, 0.0, 0.0, -_GRAVITY),
        Pendulum(m1, m2, length, 1.0 / length, a, 0.0, 0.0, 0.0, _GRAVITY),
        LinearPendulum(
            -share * 2.0 * _GRAVITY * a,
            m2 / m1 * _GRAVITY,
            share * 2.0 * _GRAVITY * a / length,
            -share * _GRAVITY / length,
        ),
    )


#: states at the defaults: bead (Cartesian), bead (angle), pendulum
STARTS = {
    "cartesian": (1.0, 0.0, 0.0, 0.0),
    "angle": (0.5 * math.pi, 0.0, 0.0, 0.0),
    "pendulum": (0.5, 0.5, 0.0, 0.0),
}

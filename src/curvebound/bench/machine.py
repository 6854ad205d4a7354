"""On what a benchmark ran: processor, compiler, interpreter and packages."""

from __future__ import annotations

import os
import platform
import subprocess
import sys
from importlib.metadata import PackageNotFoundError, version
from pathlib import Path

from ..errors import CurveboundError
from .native import FLAGS, compiler

__all__ = ["machine"]

_PACKAGES = ("curvebound", "pythonfmu", "fmpy", "mypy", "numpy", "scipy", "heyoka", "mujoco")


def _processor() -> str:
    try:
        for line in Path("/proc/cpuinfo").read_text("utf-8").splitlines():
            if line.startswith("model name"):
                return line.partition(":")[2].strip()
    except OSError:
        pass
    return platform.processor() or platform.machine()


def _compiler() -> str:
    try:
        command = compiler()
    except CurveboundError:
        return "none"
    done = subprocess.run([command, "--version"], capture_output=True, text=True, check=False)
    first = (done.stdout or command).splitlines()[0]
    return f"{first} {' '.join(flag for flag in FLAGS if flag.startswith('-O'))}"


def _version(package: str) -> str:
    try:
        return version(package)
    except PackageNotFoundError:
        return "not installed"


def machine() -> dict[str, str]:
    """Name -> value of everything that a figure depends on."""
    return {
        "processor": _processor(),
        "cores": str(os.cpu_count()),
        "system": platform.platform(),
        "compiler": _compiler(),
        "python": f"{platform.python_implementation()} {sys.version.split()[0]}",
        **{package: _version(package) for package in _PACKAGES},
    }

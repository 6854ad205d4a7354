"""Compiling for Windows elsewhere: headers and import libraries, made of what this machine has."""

from __future__ import annotations

import re
import shutil
import subprocess
import sys
from pathlib import Path

from ..errors import CurveboundError

__all__ = ["headers_for_windows", "import_libraries"]

_PYCONFIG = Path(__file__).resolve().parent / "windows" / "pyconfig.h"
_DECLARED = re.compile(r"PyAPI_(?:FUNC|DATA)\([^)]*\)\s*\*?\s*(\w+)")
#: of the C library that Python uses there, so that compiled code has the bits of interpreted
_MATH = ("sin", "cos", "tan", "atan", "atan2", "sqrt", "exp", "log", "pow", "fmod", "tanh")
_MATH_LIBRARY = "api-ms-win-crt-math-l1-1-0.dll"


def headers_for_windows(include: Path, folder: Path) -> Path:
    """Copy Python's headers into the new folder `folder`, with the pyconfig.h of Windows."""
    shutil.copytree(include, folder, ignore=shutil.ignore_patterns("pyconfig*.h"))
    shutil.copy(_PYCONFIG, folder)
    return folder


def import_libraries(include: Path, folder: Path) -> list[Path]:
    """Make, in `folder`, the import libraries of the stable ABI and of the mathematical functions.

    Raises CurveboundError where there is no dlltool.
    """
    names = {
        name
        for header in include.rglob("*.h")
        for name in _DECLARED.findall(header.read_text(encoding="utf-8", errors="replace"))
    }
    return [
        _library(folder, "python3.dll", sorted(names)),
        _library(folder, _MATH_LIBRARY, _MATH),
    ]


def _library(folder: Path, dll: str, names: list[str] | tuple[str, ...]) -> Path:
    definition = folder / f"{dll}.def"
    definition.write_text("\n".join([f"LIBRARY {dll}", "EXPORTS", *names, ""]))
    library = folder / f"lib{dll}.a"
    tool = shutil.which("x86_64-w64-mingw32-dlltool")
    command = [tool] if tool else [sys.executable, "-m", "ziglang", "dlltool"]
    arguments = ["-m", "i386:x86-64", "-d", definition.name, "-l", library.name, "-D", dll]
    done = subprocess.run([*command, *arguments], cwd=folder, capture_output=True, text=True)
    if done.returncode:
        raise CurveboundError(f"{' '.join(command)} failed on {dll}:\n{done.stderr.strip()}")
    return library

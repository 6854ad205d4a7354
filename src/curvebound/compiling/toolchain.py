"""C compilers: which there are, for which platforms, and what their output depends on."""

from __future__ import annotations

import importlib.util
import os
import platform
import shutil
import sys
from collections.abc import Sequence
from pathlib import Path

__all__ = [
    *("HERE", "LINUX", "PLATFORMS", "WINDOWS"),
    *("compiler", "compiler_for", "compiler_parts", "options_for"),
]

LINUX = "linux64"
WINDOWS = "win64"
#: the platforms for which FMUs are compiled, in the words of FMI 2.0
PLATFORMS = (LINUX, WINDOWS)

_IS_64_BIT = platform.machine().lower() in ("x86_64", "amd64")
#: that of this machine, or ''
HERE = {"linux": LINUX, "win32": WINDOWS}.get(sys.platform, "") if _IS_64_BIT else ""

#: in this order, after what CC names
_NATIVE = ("cc", "clang", "gcc")
_ZIG_TARGETS = {LINUX: "x86_64-linux-gnu.2.17", WINDOWS: "x86_64-windows-gnu"}
#: options of GNU's linker -> what zig's has in their place, which does the rest anyway
_OF_ZIG = {
    "-l:libdl.so.2": ["-ldl"],
    "-Wl,-z,noseparate-code": [],
    "-Wl,--no-insert-timestamp": [],
    "-static": [],
}
#: variables that C compilers heed
_HEEDED = (
    *("CC", "CPATH", "C_INCLUDE_PATH", "LIBRARY_PATH", "GCC_EXEC_PREFIX", "COMPILER_PATH"),
    *("MACOSX_DEPLOYMENT_TARGET", "SOURCE_DATE_EPOCH"),
)


def compiler_for(target: str) -> list[str] | None:
    """The command of a C compiler whose output runs on `target`, one of PLATFORMS, or None."""
    names: tuple[str, ...] = ()
    if target == HERE:
        chosen = os.environ.get("CC", "").split()
        if chosen and shutil.which(chosen[0]):
            return chosen
        names = _NATIVE
    elif target == WINDOWS:
        names = ("x86_64-w64-mingw32-gcc",)
    for name in names:
        found = shutil.which(name)
        if found:
            return [found]
    if importlib.util.find_spec("ziglang") is not None:
        return [sys.executable, "-m", "ziglang", "cc", "-target", _ZIG_TARGETS[target]]
    return None


def options_for(command: Sequence[str], options: Sequence[str]) -> list[str]:
    """Options for GNU's compiler and linker as those of `command` take them."""
    if "ziglang" not in command:
        return [*options]
    return [other for option in options for other in _OF_ZIG.get(option, [option])]


def compiler() -> list[str] | None:
    """The command of the C compiler for programs that run here, or None."""
    if HERE:
        return compiler_for(HERE)
    found = next(filter(None, map(shutil.which, _NATIVE)), None)
    return [found] if found else None


def compiler_parts(command: Sequence[str] | None = None) -> list[str]:
    """What a C compiler's output depends on besides its sources and options; else compiler()'s."""
    command = command or compiler()
    parts = [" ".join(command or ())]
    for word in command or ():
        if os.path.isabs(word) and os.path.isfile(word):
            status = os.stat(word)
            parts.append(f"{os.path.realpath(word)} {status.st_size} {status.st_mtime_ns}")
    if command and "ziglang" in command:
        spec = importlib.util.find_spec("ziglang")
        assert spec is not None
        assert spec.origin is not None
        status = os.stat(Path(spec.origin).parent)
        parts.append(f"{spec.origin} {status.st_mtime_ns}")
    return parts + [f"{name}={os.environ.get(name)}" for name in _HEEDED]

"""Compiling the forwarding library, forward.c: the binary of an FMU on Linux.

Compiled once for all FMUs, since it reads from the FMU around it what is particular to one, and
cached by content. The same compiler gives the same bytes.
"""

from __future__ import annotations

import os
import platform
import subprocess
import sys
import tempfile
from collections.abc import Sequence
from pathlib import Path

from .. import cache
from .compile import compiler, compiler_parts

__all__ = ["SOURCE", "compile_forwarder", "compile_source", "why_not"]

#: the source of the forwarding library
SOURCE = Path(__file__).with_name("forward.c")

# Only the FMI functions are visible, bound to this copy: several FMUs share a process. All symbols
# are resolved on loading: what is missing must show there and not in a step. libdl is a separate
# library on systems older than glibc 2.34, and an empty one since.
_FLAGS = (
    *("-std=c11", "-Os", "-s", "-fno-ident", "-Wall", "-Wextra"),
    *("-shared", "-fPIC", "-fvisibility=hidden", "-Wl,-Bsymbolic"),
    *("-Wl,-z,now", "-Wl,-z,relro", "-Wl,-z,noseparate-code", "-Wl,--build-id=none"),
)
_LIBRARIES = ("-Wl,--no-as-needed", "-l:libdl.so.2")

_NAME = "forward.so"
_failure = ""


def why_not() -> str:
    """Why there is no forwarding library here, or ''."""
    if sys.platform != "linux":
        return f"no forwarding library for {sys.platform}"
    if platform.machine() not in ("x86_64", "AMD64"):
        return f"no wrapper of PythonFMU for {platform.machine()}"
    if compiler() is None:
        return "no C compiler found"
    return _failure


def compile_forwarder() -> Path | None:
    """The compiled forwarding library, or None where why_not() gives a reason.

    A compiler that fails is such a reason: FMUs can be built without.
    """
    global _failure
    _failure = ""
    if why_not():
        return None
    try:
        parts = [cache.sources(SOURCE, Path(__file__)), *compiler_parts()]
        folder = cache.entry("forwarders", parts, lambda to: compile_source(to / _NAME))
    except (OSError, subprocess.CalledProcessError) as error:
        detail = getattr(error, "stderr", b"") or b""
        text = detail.decode(errors="replace").strip() or str(error)
        _failure = f"compiling {SOURCE.name} failed: {text}"
        return None
    return folder / _NAME


def compile_source(library: Path, extra: Sequence[str] = ()) -> None:
    """Compile forward.c into `library`, with further flags for the compiler (tests: a sanitizer).

    Raises OSError or subprocess.CalledProcessError, whose stderr holds the compiler's messages.
    """
    library.parent.mkdir(parents=True, exist_ok=True)
    handle, scratch = tempfile.mkstemp(prefix=f".{library.name}-", dir=library.parent)
    os.close(handle)
    command = [str(compiler()), *_FLAGS, *extra, SOURCE.name, "-o", scratch, *_LIBRARIES]
    try:
        subprocess.run(command, cwd=SOURCE.parent, capture_output=True, check=True)
        os.chmod(scratch, 0o755)
        os.replace(scratch, library)
    finally:
        Path(scratch).unlink(missing_ok=True)

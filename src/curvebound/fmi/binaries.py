"""Compiling native/, the binary of an FMU: one for Linux, one for Windows, from the same sources.

Compiled once for all FMUs, since it reads from the FMU around it what is particular to one, and
cached, unless it came with the package. The same compiler gives the same bytes.
"""

from __future__ import annotations

import subprocess
import tempfile
from collections.abc import Iterator, Sequence
from pathlib import Path

from .. import cache
from ..compiling.toolchain import compiler_for, compiler_parts, options_for
from ..places import compiled_directory

__all__ = [
    "PLATFORMS",
    "SOURCES",
    "Platform",
    "compile_binary",
    "compile_sources",
    "why_not",
    "write_shipped",
]

_FOLDER = Path(__file__).with_name("native")

#: all files of native/
SOURCES = tuple(sorted(_FOLDER.iterdir()))

# Only the FMI functions are visible, bound to this copy: several FMUs share a process.
_FLAGS = ("-std=c11", "-O2", "-s", "-Wall", "-Wextra", "-shared", "-fvisibility=hidden")
# All symbols are resolved on loading: what is missing must show there and not in a step. libdl is a
# separate library on systems older than glibc 2.34, and an empty one since.
_LINUX = (
    *("-fPIC", "-Wl,-Bsymbolic", "-Wl,-z,defs", "-Wl,-z,now", "-Wl,-z,relro"),
    *("-Wl,-z,noseparate-code", "-Wl,--build-id=none", "-Wl,--no-as-needed", "-l:libdl.so.2"),
)
# No library but those of Windows itself. The same bytes each time: no time in the file, and no
# address that is made of the path of the file.
_WINDOWS = (
    *("-D__USE_MINGW_ANSI_STDIO=1", "-static", "-ladvapi32"),
    *("-Wl,--no-insert-timestamp", "-Wl,--disable-auto-image-base"),
)


class Platform:
    """A kind of binary in an FMU.

    `folder` is its name in FMI 2.0, `suffix` that of the file, `system` what sys.platform says
    where it runs.
    """

    def __init__(self, folder: str, suffix: str, system: str) -> None:
        self.folder = folder
        self.suffix = suffix
        self.system = system
        #: why compiling has failed, or ''
        self.failure = ""

    def command(self, files: Sequence[str] = ()) -> list[str]:
        """What compiles `files` for this platform; empty where there is no compiler for it."""
        flags = _WINDOWS if self.folder == "win64" else _LINUX
        found = compiler_for(self.folder)
        return [*found, *_FLAGS, *files, *options_for(found, flags)] if found else []

    def shipped(self) -> str:
        """The name of the file that comes with an installed package."""
        return f"native_{_sources()[:12]}{self.suffix}"

    def files(self) -> list[str]:
        """The sources for this platform, relative to native/."""
        other = "_posix.c" if self.folder == "win64" else "_windows.c"
        return [p.name for p in SOURCES if p.suffix == ".c" and not p.name.endswith(other)]


PLATFORMS = {
    "linux64": Platform("linux64", ".so", "linux"),
    "win64": Platform("win64", ".dll", "win32"),
}


def _sources() -> str:
    """A hash of what the binaries are made of."""
    return cache.sources(_FOLDER, Path(__file__))


def why_not(name: str = "linux64") -> str:
    """Why there is no binary for the platform of that name, or ''."""
    target = PLATFORMS[name]
    if (compiled_directory() / target.shipped()).is_file():
        return ""
    return target.failure if target.command() else f"no C compiler for {name} found"


def compile_binary(name: str = "linux64") -> Path | None:
    """The binary for the platform of that name, or None where why_not() gives a reason.

    A compiler that fails is such a reason: FMUs can be built without.
    """
    target = PLATFORMS[name]
    target.failure = ""
    ready = compiled_directory() / target.shipped()
    if ready.is_file():
        return ready
    command = target.command()
    if not command:
        return None
    file = f"native{target.suffix}"
    try:
        parts = [_sources(), *compiler_parts(command)]
        folder = cache.entry("binaries", parts, lambda to: compile_sources(to / file, name))
    except (OSError, subprocess.CalledProcessError) as error:
        detail = (getattr(error, "stderr", b"") or b"").decode(errors="replace")
        text = "; ".join(detail.split("\n")[:4]).strip("; ") or str(error)
        target.failure = f"compiling the binary for {name} failed: {text}"
        return None
    return folder / file


def write_shipped(folder: Path) -> Iterator[str]:
    """Write the binaries that come with the package; yields what it has to do without, and why."""
    for name, target in PLATFORMS.items():
        made = compile_binary(name)
        if made is None:
            yield f"the binary for {name}: {why_not(name)}"
        else:
            (folder / target.shipped()).write_bytes(made.read_bytes())


def compile_sources(library: Path, name: str = "linux64", extra: Sequence[str] = ()) -> None:
    """Compile native/ into `library`, with further flags for the compiler (tests: a sanitizer).

    Raises OSError or subprocess.CalledProcessError, whose stderr holds the compiler's messages.
    """
    target = PLATFORMS[name]
    library.parent.mkdir(parents=True, exist_ok=True)
    with tempfile.TemporaryDirectory(prefix=".native-", dir=library.parent) as scratch:
        made = Path(scratch) / library.name
        command = [*target.command(target.files()), "-o", str(made), *extra]
        subprocess.run(command, cwd=_FOLDER, capture_output=True, check=True)
        made.chmod(0o755)
        made.replace(library)

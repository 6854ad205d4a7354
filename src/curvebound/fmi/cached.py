"""Our FMUs for scenes: described, and built when first asked for, kept in the cache."""

from __future__ import annotations

import hashlib
import platform
import sys
import zipfile
from importlib.metadata import version
from pathlib import Path
from xml.etree.ElementTree import tostring

from .. import cache
from . import compile as kernel
from .binaries import PLATFORMS, compile_binary
from .description import describe, timestamp
from .folder import Folder
from .runtime import runtime, system_sources

__all__ = ["cached_fmu", "write_described"]

_PACKAGE = Path(__file__).resolve().parents[1]


def cached_fmu(folder: Folder) -> Path:
    """The FMU of a system, built from the sources as they are now.

    Raises CurveboundError for a mistake in the system or a failing compiler.
    """
    natives = [(name, binary) for name in PLATFORMS if (binary := compile_binary(name))]
    core = runtime()
    own = system_sources(folder, core)
    extensions = {} if kernel.why_not(own) else kernel.compile_kernel(core, own).files
    binaries = [*sorted(extensions.items()), *((name, path.read_bytes()) for name, path in natives)]
    parts = [
        cache.sources(_PACKAGE, folder.path),
        *(f"{path} {hashlib.sha256(content).hexdigest()}" for path, content in binaries),
        version("pythonfmu"),
        timestamp().isoformat(),
        sys.version,
        platform.platform(),
    ]

    def make(to: Path) -> None:
        from .build import build  # and PythonFMU's builder, which what is kept does not need

        build(folder, to)

    return cache.entry("fmus", parts, make) / f"{folder.name}.fmu"


def write_described(folder: Folder, path: Path) -> Path:
    """Write what an FMU of the system tells of itself, without what runs: nothing is compiled.

    Returns `path`. Raises CurveboundError for a mistake in the system.
    """
    from .slave import table_of  # and PythonFMU, which what is kept does not need

    folder.drawing()
    fmu = folder.fmu()
    assert fmu.system is not None
    root = describe(fmu, "{described}", fmu.system.create(table_of(fmu), ""), derivatives=True)
    with zipfile.ZipFile(path, "w") as archive:
        archive.writestr("modelDescription.xml", tostring(root))
    return path

"""The compiled kernel of an FMU: it came with the package, is in the cache, or is compiled."""

from __future__ import annotations

import importlib
import shutil
import sys
import tempfile
from collections.abc import Iterator
from pathlib import Path
from types import ModuleType
from typing import NamedTuple

from .. import cache
from ..compiling.extension import FLAGS, SUFFIXES, compile_c, cython_version, headers, write_c
from ..compiling.modules import Unit
from ..compiling.toolchain import HERE, PLATFORMS, compiler_for, compiler_parts
from ..compiling.translate import translate
from ..errors import CurveboundError
from ..places import compiled_directory, fmus_directory
from .folder import systems_in
from .runtime import (
    REPEATED,
    VISIBLE,
    WRITTEN_OUT,
    Runtime,
    SystemSources,
    runtime,
    system_sources,
)

__all__ = ["Compiled", "compile_kernel", "extension", "load_compiled", "why_not", "write_shipped"]


_CORES: dict[str, Unit] = {}


class Compiled(NamedTuple):
    """The extension modules of an FMU."""

    #: path below the FMU's resources -> content
    files: dict[str, bytes]
    #: the platforms that have all of them
    platforms: tuple[str, ...]


def why_not(system: SystemSources | None = None, *, target: str = HERE) -> str:
    """Why there is no compiled core, or system, for `target`, one of PLATFORMS, or ''."""
    if not target:
        return f"this is none of {', '.join(PLATFORMS)}"
    names = [unit.extension for unit in (runtime(), system) if unit is not None]
    if all((compiled_directory() / f"{name}{SUFFIXES[target]}").is_file() for name in names):
        return ""
    if compiler_for(target) is None:
        return "no C compiler found" if target == HERE else f"no C compiler for {target}"
    if not cython_version():
        return "no Cython, which curvebound[compiler] brings"
    if headers() is None:
        return "no Python.h"
    return ""


def compile_kernel(core: Runtime, system: SystemSources) -> Compiled:
    """Compile what an FMU runs, for all platforms for which that can be done here.

    Raises CurveboundError where a compiler fails, or there is none for this machine.
    """
    files: dict[str, bytes] = {}
    platforms = []
    for target in PLATFORMS:
        if why_not(system, target=target):
            continue
        for name, unit in ((core.extension, None), (system.extension, system)):
            files[f"{name}{SUFFIXES[target]}"] = extension(target, core, unit)
        platforms.append(target)
    if HERE not in platforms:
        raise CurveboundError(
            f"the kernel cannot be compiled: {why_not(system)}; install a C compiler and "
            "Cython (pip install curvebound[compiler] brings both), or build with --no-compile"
        )
    return Compiled(files, tuple(platforms))


def extension(target: str, core: Runtime, system: SystemSources | None) -> bytes:
    """The extension module of the core, or of a system, for a platform."""
    name = system.extension if system else core.extension
    # the core, which is large, takes half the time to compile so as with -O2 and runs as fast; what
    # its steps keep in registers around calls of the system's equations saves a twentieth of theirs
    optimization = ("-O2",) if system else ("-O1", "-fcaller-saves")
    file = f"{name}{SUFFIXES[target]}"
    ready = compiled_directory() / file
    if ready.is_file():
        return ready.read_bytes()

    def make(folder: Path) -> None:
        for source in _c_sources(core, system).iterdir():
            shutil.copy(source, folder)
        made = compile_c(folder / f"{name}.c", target, optimization)
        for path in folder.iterdir():
            if path != made:
                path.unlink()

    tools = [cython_version(), *optimization, *FLAGS, *compiler_parts(compiler_for(target))]
    parts = [name, target, sys.version, *tools]
    return (cache.entry("kernels", parts, make) / file).read_bytes()


def _core_unit(core: Runtime) -> Unit:
    """The core, translated once in a process: every system needs its declarations."""
    if core.extension not in _CORES:
        _CORES[core.extension] = translate(
            core.extension, core.kernel, None, VISIBLE, REPEATED, WRITTEN_OUT
        )
    return _CORES[core.extension]


def _c_sources(core: Runtime, system: SystemSources | None) -> Path:
    """The folder with the C source of the core or of a system."""

    def make(folder: Path) -> None:
        unit = core_unit = _core_unit(core)
        if system is not None:
            unit = translate(system.extension, system.kernel, core_unit)
        made = write_c(unit, folder, core_unit)
        for path in folder.iterdir():
            if path != made:
                path.unlink()

    name = system.extension if system else core.extension
    return cache.entry("kernel-sources", [name, cython_version()], make)


def write_shipped(folder: Path) -> Iterator[str]:
    """Compile what comes with the package into `folder`; yields what it has to do without, and why.

    Needs Cython, and of other packages only what reading the systems' folders imports.
    """
    core = runtime()
    systems = [system_sources(system, core) for system in systems_in(fmus_directory())]
    for target in PLATFORMS:
        missing = why_not(target=target)
        if missing:
            yield f"the kernels for {target}: {missing}"
            continue
        for unit in (None, *systems):
            name = f"{unit.extension if unit else core.extension}{SUFFIXES[target]}"
            try:
                (folder / name).write_bytes(extension(target, core, unit))
            except CurveboundError as error:  # an installation works without, interpreted
                yield f"the kernels for {target}: {error}"
                break


def load_compiled(system: SystemSources) -> tuple[ModuleType, ModuleType]:
    """The compiled core and system, importable beside the interpreted ones (benchmarks, tests)."""
    core = runtime()
    names = (core.extension, system.extension)
    if not all(name in sys.modules for name in names):
        with tempfile.TemporaryDirectory(prefix="curvebound-") as folder:
            for name, unit in zip(names, (None, system), strict=True):
                (Path(folder) / f"{name}{SUFFIXES[HERE]}").write_bytes(extension(HERE, core, unit))
            sys.path.insert(0, folder)
            try:
                importlib.invalidate_caches()
                for name in names:
                    importlib.import_module(name)
            finally:
                sys.path.remove(folder)
    return sys.modules[names[0]], sys.modules[names[1]]

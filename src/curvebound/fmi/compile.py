"""Compiling the kernel with mypyc; what was compiled is kept in the cache."""

from __future__ import annotations

import importlib
import os
import shutil
import subprocess
import sys
import sysconfig
import tempfile
from importlib.metadata import version
from pathlib import Path
from types import ModuleType

from .. import cache
from ..errors import CurveboundError
from .runtime import Runtime, runtime

__all__ = ["compile_kernel", "compiled_kernel", "compiler", "compiler_parts", "why_not"]

# -ffp-contract=off: a fused multiply-add would give other bits than the interpreter
_FLAGS = "-O2 -g0 -ffp-contract=off -fno-semantic-interposition -w"

#: variables that C compilers, and setuptools for them, heed
_HEEDED = (
    *("CC", "CPPFLAGS", "LDFLAGS", "LDSHARED", "ARCHFLAGS", "MACOSX_DEPLOYMENT_TARGET"),
    *("CPATH", "C_INCLUDE_PATH", "LIBRARY_PATH", "GCC_EXEC_PREFIX", "COMPILER_PATH"),
)

_SCRIPT = """
import sys
from mypyc.build import mypycify
from setuptools import setup
name, *files = sys.argv[1:]
setup(
    name=name,
    ext_modules=mypycify(files, opt_level="2", debug_level="0", group_name=name),
    script_args=["build_ext", "--inplace"],
)
"""


def compiler() -> str | None:
    """Path of the C compiler, or None."""
    command = os.environ.get("CC") or sysconfig.get_config_var("CC") or "cc"
    for candidate in (command.split()[0], "cc", "gcc", "clang"):
        found = shutil.which(candidate)
        if found:
            return found
    return None


def why_not() -> str:
    """Why the kernel cannot be compiled here, or ''."""
    if compiler() is None:
        return "no C compiler found"
    header = Path(sysconfig.get_path("include")) / "Python.h"
    if not header.is_file():
        return f"no {header}"
    return ""


def compiler_parts() -> list[str]:
    """What the files that the C compiler makes depend on besides their sources and its flags."""
    found = compiler()
    parts = [sys.version, sysconfig.get_platform(), str(found)]
    if found is not None:
        status = os.stat(found)
        parts.append(f"{os.path.realpath(found)} {status.st_size} {status.st_mtime_ns}")
    return parts + [f"{name}={os.environ.get(name)}" for name in _HEEDED]


def compile_kernel(sources: Runtime) -> dict[str, bytes]:
    """The extension modules, path relative to the FMU's resources -> content.

    Raises CurveboundError where there is no compiler or it fails.
    """
    missing = why_not()
    if missing:
        raise CurveboundError(
            f"the kernel cannot be compiled: {missing}; install a C compiler and Python's headers, "
            "or build with --no-compile"
        )
    parts = [
        sources.package(compiled=True),
        cache.sources(Path(__file__)),
        *(version(name) for name in ("mypy", "setuptools")),
        *compiler_parts(),
    ]
    folder = cache.entry("kernels", parts, lambda to: _compile_into(to, sources))
    return {
        path.relative_to(folder).as_posix(): path.read_bytes()
        for path in sorted(folder.rglob("*"))
        if path.suffix in (".so", ".pyd")
    }


def _compile_into(folder: Path, sources: Runtime) -> None:
    """Compile, and leave the extension modules in `folder`."""
    name = sources.package(compiled=True)
    with tempfile.TemporaryDirectory(prefix="curvebound-compile-") as place:
        scratch = Path(place)
        sources.write(scratch, name)
        # The package's own __init__ imports the slave, which is neither compiled nor checked here.
        (scratch / name / "__init__.py").write_bytes(b"")
        environment = {**os.environ, "CFLAGS": _FLAGS, "SOURCE_DATE_EPOCH": "0"}
        environment.pop("PYTHONPATH", None)
        done = subprocess.run(
            [sys.executable, "-c", _SCRIPT, name, *(f"{name}/{file}" for file in sources.compiled)],
            cwd=scratch,
            env=environment,
            capture_output=True,
            text=True,
        )
        if done.returncode:
            tail = "\n".join((done.stdout + done.stderr).splitlines()[-15:])
            raise CurveboundError(
                f"compiling the kernel failed (exit status {done.returncode}); "
                f"build with --no-compile, or mend the compiler:\n{tail}"
            )
        for path in scratch.rglob("*"):
            relative = path.relative_to(scratch)
            if path.suffix in (".so", ".pyd") and relative.parts[0] != "build":
                target = folder / relative
                target.parent.mkdir(parents=True, exist_ok=True)
                shutil.move(path, target)


def compiled_kernel() -> ModuleType:
    """The compiled package itself, importable beside the interpreted one (benchmarks, tests)."""
    sources = runtime()
    name = sources.package(compiled=True)
    if name not in sys.modules:
        folder = Path(tempfile.mkdtemp(prefix="curvebound-"))
        sources.write(folder, name)
        for file, content in compile_kernel(sources).items():
            path = folder / file
            path.parent.mkdir(parents=True, exist_ok=True)
            path.write_bytes(content)
        sys.path.insert(0, str(folder))
        try:
            importlib.invalidate_caches()
            importlib.import_module(name)
        finally:
            sys.path.remove(str(folder))
            shutil.rmtree(folder, ignore_errors=True)
    return sys.modules[name]

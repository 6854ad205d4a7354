"""Compiling the kernel with mypyc, cached by content hash, interpreter and platform."""

from __future__ import annotations

import contextlib
import hashlib
import importlib
import os
import shutil
import subprocess
import sys
import sysconfig
import tempfile
from collections.abc import Iterator
from importlib.metadata import version
from pathlib import Path
from types import ModuleType

try:
    import fcntl
except ImportError:  # Windows
    fcntl = None  # type: ignore[assignment]

from ..errors import CurveboundError
from ..places import cache_directory
from .runtime import Runtime, runtime

__all__ = ["compile_kernel", "compiled_kernel", "compiler", "why_not"]

# -ffp-contract=off: a fused multiply-add would give other bits than the interpreter
_FLAGS = "-O2 -g0 -ffp-contract=off -fno-semantic-interposition -w"

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


def _cache(sources: Runtime) -> Path:
    key = hashlib.sha256(
        "\0".join(
            (
                sources.package(compiled=True),
                sys.implementation.cache_tag or sys.version,
                sysconfig.get_platform(),
                version("mypy"),
                _FLAGS,
                str(compiler()),
            )
        ).encode()
    ).hexdigest()[:16]
    return cache_directory() / "kernels" / key


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
    cache = _cache(sources)
    if not cache.is_dir():
        cache.parent.mkdir(parents=True, exist_ok=True)
        with _alone(cache.with_suffix(".lock")):
            if not cache.is_dir():
                _compile_into(cache, sources)
    return {
        path.relative_to(cache).as_posix(): path.read_bytes()
        for path in sorted(cache.rglob("*"))
        if path.suffix in (".so", ".pyd")
    }


@contextlib.contextmanager
def _alone(path: Path) -> Iterator[None]:
    """Let other processes that want the same kernel wait for this one instead of compiling it too.

    Without file locks (Windows) they compile side by side, which costs time only.
    """
    if fcntl is None:
        yield
        return
    with path.open("w") as lock:
        fcntl.flock(lock, fcntl.LOCK_EX)
        yield


def _compile_into(cache: Path, sources: Runtime) -> None:
    """Compile in a scratch folder and move the result to `cache` in one rename."""
    name = sources.package(compiled=True)
    scratch = Path(tempfile.mkdtemp(prefix="compile-", dir=cache.parent))
    try:
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
        finished = scratch / "finished"
        for path in list(scratch.rglob("*")):
            relative = path.relative_to(scratch)
            if path.suffix in (".so", ".pyd") and relative.parts[0] not in ("build", "finished"):
                target = finished / relative
                target.parent.mkdir(parents=True, exist_ok=True)
                path.rename(target)
        try:
            finished.rename(cache)
        except OSError:
            if not cache.is_dir():  # else another process was faster, with the same result
                raise
    finally:
        shutil.rmtree(scratch, ignore_errors=True)


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

"""From Cython text to extension modules for CPython's stable ABI, one for each platform."""

from __future__ import annotations

import gc
import re
import subprocess
import sysconfig
import tempfile
from collections.abc import Sequence
from importlib.metadata import PackageNotFoundError, version
from pathlib import Path

from ..errors import CurveboundError
from .modules import Unit
from .repeated import inlined
from .toolchain import LINUX, WINDOWS, compiler_for, options_for
from .windows_imports import headers_for_windows, import_libraries

__all__ = ["FLAGS", "SUFFIXES", "compile_c", "cython_version", "write_c"]

#: how Python names the file of an extension module for the stable ABI
SUFFIXES = {LINUX: ".abi3.so", WINDOWS: ".pyd"}

# -ffp-contract=off: a fused multiply-add would give other bits than the interpreter
FLAGS = (
    *("-g0", "-s", "-w", "-shared", "-ffp-contract=off", "-fno-ident"),
    *("-DPy_LIMITED_API=0x030A0000", "-DCYTHON_LIMITED_API=1", "-DNDEBUG"),
)
_NAME = r"__pyx_mstate_global->__pyx_n_u_(\w+)"
_BY_NAME = re.compile(rf"(?:[GS]etAttrStr\([^;]*?, |CallMethod\w*\(\(PyObject ?\*\)){_NAME}")
_HERE = Path(__file__).resolve().parent
_FLAGS_FOR = {
    LINUX: (
        *("-fPIC", "-fno-semantic-interposition", "-include", str(_HERE / "old_glibc.h")),
        *("-Wl,--build-id=none", "-Wl,-z,noseparate-code", "-lm"),
    ),
    WINDOWS: ("-static-libgcc", "-Wl,--no-insert-timestamp", "-Wl,--disable-auto-image-base"),
}


def cython_version() -> str:
    """The version of the Cython that is installed, or ''."""
    try:
        return version("cython")  # to import it takes ten times as long
    except PackageNotFoundError:
        return ""


def headers() -> Path | None:
    """The folder of Python.h, or None."""
    folder = Path(sysconfig.get_path("include"))
    return folder if (folder / "Python.h").is_file() else None


def write_c(unit: Unit, folder: Path, core: Unit) -> Path:
    """Let Cython write the C source of a unit, the core or a system's, into `folder`.

    Raises CurveboundError for what Cython does not accept.
    """
    from Cython.Compiler import Errors, Main, Options

    (folder / f"{core.name}.pxd").write_text(core.pxd, encoding="utf-8")
    source = folder / f"{unit.name}.pyx"
    source.write_text(unit.pyx, encoding="utf-8")
    Options.docstrings = False
    Options.emit_code_comments = False
    options = Main.CompilationOptions(
        language_level=3, include_path=[str(folder)], output_file=str(source.with_suffix(".c"))
    )
    collects = gc.isenabled()
    gc.disable()  # a quarter of Cython's time, for nothing: it holds what it makes until the end
    try:
        result = Main.compile_single(str(source), options, full_module_name=unit.name)
    except Errors.CompileError as error:
        raise CurveboundError(f"Cython failed on {unit.name}: {error}") from error
    finally:
        if collects:
            gc.enable()
    if result.num_errors:
        raise CurveboundError(f"Cython refused {unit.name}, see above")
    made = source.with_suffix(".c")
    text = inlined(made.read_text(encoding="utf-8"), unit.inline)
    made.write_text(text, encoding="utf-8")
    # of an object whose type it does not know, compiled code asks by name
    asked = set(_BY_NAME.findall(text))
    unseen = sorted(asked & (unit.hidden() | core.hidden()))
    if unseen:
        raise CurveboundError(
            f"{unit.name}: annotate the variables of which {', '.join(unseen)} is used: they are "
            "objects of kernel classes, and compiled code has to know that"
        )
    return made


def compile_c(source: Path, target: str, optimization: Sequence[str] = ("-O2",)) -> Path:
    """Compile a C source into the extension module for `target`, beside it.

    optimization: options of the compiler beside FLAGS.

    Raises CurveboundError where the compiler fails, or there is none.
    """
    command = compiler_for(target)
    include = headers()
    if command is None or include is None:
        raise CurveboundError(f"nothing here compiles for {target}")
    result = source.with_suffix(SUFFIXES[target])
    with tempfile.TemporaryDirectory(prefix="curvebound-compile-") as place:
        libraries: list[str] = []
        if target == WINDOWS:
            include = headers_for_windows(include, Path(place) / "include")
            libraries = [str(path) for path in import_libraries(include, Path(place))]
        done = subprocess.run(
            [
                *(*command, *optimization, *FLAGS, f"-I{include}", source.name, "-o", result.name),
                *(*libraries, *options_for(command, _FLAGS_FOR[target])),
            ],
            cwd=source.parent,
            capture_output=True,
            text=True,
        )
    if done.returncode:
        tail = "\n".join((done.stdout + done.stderr).splitlines()[-15:])
        raise CurveboundError(
            f"compiling {source.name} failed (exit status {done.returncode}); build with "
            f"--no-compile, or mend the compiler ({' '.join(command)}):\n{tail}"
        )
    return result

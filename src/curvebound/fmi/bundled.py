"""The Python that an FMU may bring along: this interpreter's library, and modules that it needs.

Linux only. The FMU then runs on machines without any Python, if their C library is not older than
that for which this Python was made.
"""

from __future__ import annotations

import io
import json
import py_compile
import shutil
import subprocess
import sys
import sysconfig
import tempfile
import zipfile
from pathlib import Path

from ..errors import CurveboundError

__all__ = ["bundled_python", "why_not"]

_ROOT = "resources/python"

#: what a slave is put through, to see which modules it needs
_TRIAL = """
import importlib, json, sys
sys.dont_write_bytecode = True
resources, main, name = sys.argv[1:]
sys.path.insert(0, resources)
slave = getattr(importlib.import_module(main), name)(instance_name="trial", resources=resources)
slave.setup_experiment(0.0)
slave.enter_initialization_mode()
slave.exit_initialization_mode()
slave.do_step(0.0, 1e-3)
slave._set_fmu_state(slave._fmu_state_from_bytes(slave._fmu_state_to_bytes(slave._get_fmu_state())))
print(json.dumps({name: module.__spec__.origin for name, module in sys.modules.items()
                  if getattr(module, "__spec__", None) and module.__spec__.has_location}))
"""

#: what a failure, a warning or another locale needs besides
_MORE = ("traceback", "warnings", "encodings.ascii", "encodings.latin_1", "encodings.cp437")

#: frozen into newer interpreters, and so without a file there
_FROZEN = (
    *("_collections_abc", "_sitebuiltins", "abc", "codecs", "genericpath", "io", "os"),
    *("posixpath", "site", "stat"),
)

#: the C library's, which are never brought along
_SYSTEM = (
    "linux-vdso",
    "ld-linux",
    "libc.",
    "libm.",
    "libdl.",
    "libpthread.",
    "librt.",
    "libutil.",
)


def why_not() -> str:
    """Why this Python cannot be brought along, or ''."""
    if sys.platform != "linux":
        return f"Python is brought along on Linux only, this is {sys.platform}"
    if not _library().is_file():
        return (
            f"this Python has no shared library {_library()}: build with one that has (Debian: "
            "libpython3; others: configured with --enable-shared)"
        )
    if _licence() is None:
        return "the licence of this Python is not found"
    return ""


def bundled_python(files: dict[str, bytes], main: str, name: str) -> dict[str, bytes]:
    """What has to be added to an FMU of these `files`, whose module `main` holds the class `name`.

    Raises CurveboundError where this Python cannot be brought along.
    """
    reason = why_not()
    if reason:
        raise CurveboundError(f"the FMU cannot bring its Python: {reason}")
    modules = _needed(files, main, name)
    version = f"python{sys.version_info.major}.{sys.version_info.minor}"
    library = _library()
    binaries = {f"{_ROOT}/lib/{library.name}": library}
    sources = {}
    for module, origin in sorted(modules.items()):
        if origin.suffix == ".so":
            binaries[f"{_ROOT}/lib/{version}/lib-dynload/{origin.name}"] = origin
        else:
            sources[module] = origin
    others = _other_libraries(list(binaries.values()))
    result = {f"{_ROOT}/lib/{path.name}": _stripped(path) for path in others}
    result.update({path: _stripped(origin) for path, origin in binaries.items()})
    result[f"{_ROOT}/lib/first.txt"] = "".join(f"{path.name}\n" for path in others).encode()
    result[f"{_ROOT}/lib/{version.replace('.', '')}.zip"] = _archive(sources)
    licence = _licence()
    assert licence is not None
    result["documentation/licenses/python.txt"] = licence.read_bytes()
    return result


def _library() -> Path:
    names = sysconfig.get_config_vars("LIBDIR", "MULTIARCH", "INSTSONAME")
    folder, multiarch, name = (str(x or "") for x in names)
    found = Path(folder, multiarch, name)
    return found if found.is_file() else Path(folder, name)


def _licence() -> Path | None:
    version = f"{sys.version_info.major}.{sys.version_info.minor}"
    for path in (
        Path(sysconfig.get_path("stdlib"), "LICENSE.txt"),
        Path(f"/usr/share/doc/libpython{version}-stdlib/copyright"),
        Path(f"/usr/share/doc/python{version}/copyright"),
    ):
        if path.is_file():
            return path
    return None


def _needed(files: dict[str, bytes], main: str, name: str) -> dict[str, Path]:
    """The modules of the standard library, with their files, that a trial of the slave imports."""
    with tempfile.TemporaryDirectory(prefix="curvebound-trial-") as scratch:
        for file, content in files.items():
            if file.startswith("resources/"):
                target = Path(scratch, file)
                target.parent.mkdir(parents=True, exist_ok=True)
                target.write_bytes(content)
        program = Path(
            sysconfig.get_config_var("BINDIR"), f"python{sysconfig.get_python_version()}"
        )
        more = "import " + ", ".join(_MORE)
        done = subprocess.run(
            [program, "-I", "-c", more + _TRIAL, f"{scratch}/resources", main, name],
            capture_output=True,
            text=True,
        )
        if done.returncode:
            raise CurveboundError(
                f"the FMU cannot bring its Python: a trial run in {program} failed:\n{done.stderr}"
            )
    library = Path(sysconfig.get_path("stdlib"))
    roots = {library.resolve(), Path(sysconfig.get_path("platstdlib")).resolve()}
    found: dict[str, Path] = {}
    for module, origin in json.loads(done.stdout).items():
        path = Path(origin)
        inside = any(path.resolve().is_relative_to(root) for root in roots)
        if inside and "site-packages" not in path.parts and "dist-packages" not in path.parts:
            found[module] = path
    for module in _FROZEN:
        found.setdefault(module, library / f"{module}.py")
    found.pop("__main__", None)
    return found


def _archive(sources: dict[str, Path]) -> bytes:
    """The modules as Python's own kind of archive, compiled; the FMU around it is compressed."""
    content = io.BytesIO()
    with (
        zipfile.ZipFile(content, "w") as archive,
        tempfile.TemporaryDirectory(prefix="curvebound-archive-") as scratch,
    ):
        compiled = Path(scratch, "module.pyc")
        for module, path in sorted(sources.items()):
            package = "/__init__" if path.name == "__init__.py" else ""
            name = f"{module.replace('.', '/')}{package}"
            py_compile.compile(
                str(path),
                cfile=str(compiled),
                dfile=f"{name}.py",
                doraise=True,
                optimize=2,
                invalidation_mode=py_compile.PycInvalidationMode.UNCHECKED_HASH,
            )
            info = zipfile.ZipInfo(f"{name}.pyc", (1980, 1, 1, 0, 0, 0))
            archive.writestr(info, compiled.read_bytes())
    return content.getvalue()


def _other_libraries(binaries: list[Path]) -> list[Path]:
    """The libraries that binaries need besides the C library's, those that need none first."""
    found: dict[str, Path] = {}
    for binary in binaries:
        done = subprocess.run(["ldd", str(binary)], capture_output=True, text=True, check=True)
        for line in reversed(done.stdout.splitlines()):
            name, _, rest = line.strip().partition(" => ")
            path = Path(rest.split(" (")[0])
            if rest and not name.startswith((*_SYSTEM, "libpython")) and path.is_file():
                found.setdefault(name, path)
    return list(found.values())


def _stripped(path: Path) -> bytes:
    """A binary without its symbols for debuggers, where `strip` is there."""
    program = shutil.which("strip")
    if program is None:
        return path.read_bytes()
    with tempfile.TemporaryDirectory(prefix="curvebound-strip-") as scratch:
        target = Path(scratch, path.name)
        subprocess.run([program, "--strip-unneeded", "-o", target, path], check=True)
        return target.read_bytes()

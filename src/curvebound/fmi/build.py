"""Building an FMU: PythonFMU packs it, then its parts are isolated, its bytes made repeatable."""

from __future__ import annotations

import contextlib
import hashlib
import importlib
import platform
import sys
import tempfile
import time
import zipfile
from collections.abc import Collection, Iterator
from pathlib import Path
from types import ModuleType
from typing import NamedTuple

from pythonfmu.builder import FmuBuilder

from ..files import write_whole
from . import binaries
from . import compile as kernel
from .bundled import bundled_python
from .description import timestamp
from .documentation import documentation_files
from .drawing import carried
from .folder import Folder, find
from .runtime import Runtime, SystemSources, runtime, system_sources

__all__ = ["BuiltFmu", "build"]

_MAIN = """\
from {package}.fmi import slave

from {system}.declaration import FMU


class {name}(slave.Slave):
    fmu = FMU
    guid_text = "{guid}"
"""

#: where PythonFMU's wrapper is the binary on some system: it executes the main module anew for each
#: instance, with locals of its own, and takes the class found in them; so there is one, made once
_MAIN_WRAPPED = """\
import sys

from {package}.fmi import slave, wrapped

from {system}.declaration import FMU

if sys.platform not in {own!r}:
    wrapped.hold(globals())

if "{name}" in globals():
    {name} = globals()["{name}"]
else:

    class {name}(slave.Slave if sys.platform in {own!r} else wrapped.Wrapped):
        fmu = FMU
        guid_text = "{guid}"
        derivatives = False
"""

_HERE = Path(__file__).resolve().parent

#: the parts of PythonFMU that the slave's base class needs
_PYTHONFMU = ("fmi2slave", "variables", "enums", "logmsg", "default_experiment", "_version")


class BuiltFmu(NamedTuple):
    """A built FMU: its name, its path, one line that says what was done, and what was left open."""

    name: str
    path: Path
    message: str
    notes: tuple[str, ...] = ()


def build(
    which: str | Path | Folder, out: Path, *, compiled: bool = True, with_python: bool = False
) -> BuiltFmu:
    """Build the FMU of a system. Building twice gives the same bytes.

    Parameters
    ----------
    which : str or Path or Folder
        Name of a system that comes with the package or lies in a folder ``systems`` here, or the
        path of its folder.
    out : Path
        Folder into which NAME.fmu is written.
    compiled : bool
        Compile the kernel where that is possible; otherwise the FMU runs interpreted.
    with_python : bool
        Put this Python into the FMU (Linux), for machines without any.

    Returns
    -------
    BuiltFmu
        ``name``, ``path``, ``message``: one line that says what was done, and ``notes``: what the
        declaration leaves open.

    Raises
    ------
    CurveboundError
        The system is unknown or has a mistake, a compiler fails, or the Python cannot be brought
        along.
    """
    began = time.perf_counter()
    folder = which if isinstance(which, Folder) else find(which)
    name = folder.name
    picture = folder.drawing()  # first: it says what is wrong in the folder
    drawing = carried(picture)
    stated = folder.statement()
    sources = runtime()
    own = system_sources(folder, sources)
    extensions, how = _extensions(sources, own) if compiled else ({}, "interpreted (--no-compile)")
    natives = {p: binary for p in binaries.PLATFORMS if (binary := binaries.compile_binary(p))}
    wrapped = len(natives) < len(binaries.PLATFORMS)
    package = sources.package(compiled=bool(extensions))
    digest = _digest(sources, own, drawing, stated)
    guid = f"{{{digest[:8]}-{digest[8:12]}-{digest[12:16]}-{digest[16:20]}-{digest[20:32]}}}"
    suffix = digest[:12] + ("c" if extensions else "") + "".join(f"_{p}" for p in natives)
    system = f"{name}_system_{suffix}"
    texts = {
        f"{name}_{suffix}.py": (_MAIN_WRAPPED if wrapped else _MAIN)
        .format(
            package=package,
            system=system,
            name=name,
            guid=guid,
            own=tuple(binaries.PLATFORMS[place].system for place in natives),
        )
        .encode(),
        **sources.text(compiled=bool(extensions)),
        **own.text(package, system, compiled=bool(extensions)),
        **extensions,
    }
    files = _pack(name, f"{name}_{suffix}", texts)
    _isolate(files, package)
    files["resources/drawing.json"] = drawing
    files.update({f"resources/{path}": text for path, text in stated.items()})
    files.update(documentation_files(folder, picture))
    for place, target in binaries.PLATFORMS.items():
        if place in natives:
            files[f"binaries/{place}/{name}{target.suffix}"] = natives[place].read_bytes()
            files[f"binaries/{place}/guid.txt"] = guid.encode()
            how += f", binary for {place}"
        else:
            how += f", PythonFMU's binary for {place} ({binaries.why_not(place)})"
    if with_python:
        files.update(bundled_python(files, f"{name}_{suffix}", name))
        how += f", with Python {platform.python_version()}"
    path = out / f"{name}.fmu"
    _write(path, files)
    seconds = time.perf_counter() - began
    done = f"{path}: {how}, {path.stat().st_size // 1024} kB, {seconds:.1f} s"
    return BuiltFmu(name, path, done, _notes(folder))


def _notes(folder: Folder) -> tuple[str, ...]:
    """What the system's declaration leaves open, a line each."""
    names = folder.left_open()
    if not names:
        return ()
    return (
        f"{', '.join(names)}: mechanics.py uses what {folder.path / 'fmu.py'} does not declare; it "
        "has unit 1 (and a parameter the start value 1) until parameter(...) or input_(...) there "
        "says otherwise",
    )


def _extensions(sources: Runtime, own: SystemSources) -> tuple[dict[str, bytes], str]:
    """The compiled kernel, path below the FMU's resources -> content, and what to say of it."""
    missing = kernel.why_not(own)
    if missing:
        return {}, f"interpreted ({missing})"
    extensions, platforms = kernel.compile_kernel(sources, own)
    return extensions, f"kernel compiled for CPython 3.10 and later on {' and '.join(platforms)}"


def _digest(sources: Runtime, own: SystemSources, drawing: bytes, stated: dict[str, bytes]) -> str:
    """Hash of all that makes the FMU what it is: it names the FMU and its modules."""
    parts = (_HERE / "description.py", _HERE.parent / "units.py", *binaries.SOURCES)
    described = b"".join(part.read_bytes() for part in parts)
    system_text = "\0".join(own.files.values()).encode()
    content = [sources.digest.encode(), described, drawing, system_text]
    content += [path.encode() + text for path, text in stated.items()]
    return hashlib.sha256(b"\0".join(content)).hexdigest()


def _pack(name: str, main: str, texts: dict[str, bytes]) -> dict[str, bytes]:
    """Let PythonFMU pack the FMU; returns its files."""
    # on Windows, what was imported from there cannot be removed
    with tempfile.TemporaryDirectory(
        prefix="curvebound-build-", ignore_cleanup_errors=True
    ) as scratch:
        stage = Path(scratch) / "stage"
        stage.mkdir()
        for file, content in texts.items():
            (stage / file).parent.mkdir(parents=True, exist_ok=True)
            (stage / file).write_bytes(content)
        others = [path for path in stage.iterdir() if path.name != f"{main}.py"]
        # not the extension modules, which can be loaded once only
        own = {Path(file).parts[0].removesuffix(".py") for file in texts if file.endswith(".py")}
        with _own_modules(*own):
            target = FmuBuilder.build_FMU(
                stage / f"{main}.py", dest=Path(scratch) / f"{name}.fmu", project_files=others
            )
        with zipfile.ZipFile(target) as archive:
            return {i.filename: archive.read(i) for i in archive.infolist() if not i.is_dir()}


@contextlib.contextmanager
def _own_modules(*names: str) -> Iterator[None]:
    """Leave neither sys.path nor sys.modules changed: PythonFMU's builder imports what it packs.

    Modules of these names that an FMU which ran here has left are set aside meanwhile.
    """
    path = sys.path[:]
    left = _taken(names)
    writes = sys.dont_write_bytecode
    sys.dont_write_bytecode = True
    importlib.invalidate_caches()
    try:
        yield
    finally:
        sys.path[:] = path
        sys.dont_write_bytecode = writes
        _taken(names)
        sys.modules.update(left)
        importlib.invalidate_caches()


def _taken(names: Collection[str]) -> dict[str, ModuleType]:
    """The modules and packages of these names, out of sys.modules."""
    found = [module for module in sys.modules if module.split(".")[0] in names]
    return {module: sys.modules.pop(module) for module in found}


def _isolate(files: dict[str, bytes], package: str) -> None:
    """Move PythonFMU's modules into the FMU's own package, so that no other FMU's are met."""
    prefix = "resources/pythonfmu/"
    for path in [p for p in files if p.startswith(prefix)]:
        content = files.pop(path)
        if path[len(prefix) : -3] in _PYTHONFMU:
            files[f"resources/{package}/pythonfmu/{path[len(prefix) :]}"] = content
    files[f"resources/{package}/pythonfmu/__init__.py"] = b""
    slave = f"resources/{package}/fmi/slave.py"
    files[slave] = files[slave].replace(b"\nfrom pythonfmu.", b"\nfrom ..pythonfmu.")


def _write(path: Path, files: dict[str, bytes]) -> None:
    """Write the archive with sorted names and one date, whole or not at all."""
    date = max(timestamp().timetuple()[:6], (1980, 1, 1, 0, 0, 0))

    def write(scratch: Path) -> None:
        with zipfile.ZipFile(scratch, "w") as archive:
            for name in sorted(files, key=lambda n: (n != "modelDescription.xml", n)):
                info = zipfile.ZipInfo(name, date_time=date)
                info.compress_type = zipfile.ZIP_DEFLATED
                info.external_attr = (0o755 if name.endswith((".so", ".dll")) else 0o644) << 16
                info.create_system = 3
                archive.writestr(info, files[name])

    write_whole(path, write)

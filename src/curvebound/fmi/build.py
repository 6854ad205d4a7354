"""Building an FMU: PythonFMU packs it, then its parts are isolated, its bytes made repeatable."""

from __future__ import annotations

import contextlib
import hashlib
import importlib
import re
import sys
import tempfile
import time
import zipfile
from collections.abc import Iterator
from pathlib import Path
from typing import NamedTuple

from pythonfmu.builder import FmuBuilder

from ..files import write_whole
from . import compile as kernel
from . import forwarding
from .description import timestamp
from .documentation import documentation_files
from .drawing import carried
from .folder import Folder, find
from .runtime import Runtime, runtime

__all__ = ["BuiltFmu", "build"]

#: PythonFMU's wrapper executes the main module anew for each instance, with locals of its own, and
#: takes the class it finds in them: so there is one, and it is made once
_MAIN = """\
from {package}.fmi import slave

from {system}.fmu import FMU

slave.hold(globals())

if "{name}" in globals():
    {name} = globals()["{name}"]
else:

    class {name}(slave.Slave):
        fmu = FMU
        guid_text = "{guid}"
        forwarded = {forwarded!r}
"""

_HERE = Path(__file__).resolve().parent

#: the parts of PythonFMU that the slave's base class needs
_PYTHONFMU = ("fmi2slave", "variables", "enums", "logmsg", "default_experiment", "_version")


class BuiltFmu(NamedTuple):
    """A built FMU: its name, its path and one line that says what was done."""

    name: str
    path: Path
    message: str


def build(which: str | Path | Folder, out: Path, *, compiled: bool = True) -> BuiltFmu:
    """Build the FMU of a system into the folder `out` as NAME.fmu.

    which: the system's name, the path of its folder (see find), or the Folder.

    With `compiled` the kernel is compiled where that is possible. Building twice gives the same
    bytes. Raises CurveboundError for an unknown system, a mistake in it or a failing compiler.
    """
    began = time.perf_counter()
    folder = which if isinstance(which, Folder) else find(which)
    name = folder.name
    drawing = carried(folder.drawing())  # first: it says what is wrong in the folder
    own = folder.sources()
    sources = runtime()
    extensions: dict[str, bytes] = {}
    how = "interpreted (--no-compile)"
    if compiled:
        missing = kernel.why_not()
        how = f"interpreted ({missing})"
        if not missing:
            extensions = kernel.compile_kernel(sources)
            how = f"kernel compiled for {sys.implementation.cache_tag}"
    forwarder = forwarding.compile_forwarder()
    package = sources.package(compiled=bool(extensions))
    parts = ("description.py", "units.py", forwarding.SOURCE.name)
    described = b"".join((_HERE / part).read_bytes() for part in parts)
    content = [sources.digest.encode(), described, drawing, *(p.encode() + own[p] for p in own)]
    digest = hashlib.sha256(b"\0".join(content)).hexdigest()
    guid = f"{{{digest[:8]}-{digest[8:12]}-{digest[12:16]}-{digest[16:20]}-{digest[20:32]}}}"
    suffix = digest[:12] + ("c" if extensions else "")
    system = f"{name}_system_{suffix}"
    texts = {
        f"{name}_{suffix}.py": _MAIN.format(
            package=package,
            system=system,
            name=name,
            guid=guid,
            forwarded=("linux",) if forwarder else (),
        ).encode(),
        f"{system}/__init__.py": b"",
    }
    for file, source in own.items():
        texts[f"{system}/{file}"] = re.sub(
            rb"(?m)^from curvebound\.", f"from {package}.".encode(), source
        )
    files = _pack(name, f"{name}_{suffix}", texts, sources, package)
    files.update({f"resources/{path}": content for path, content in extensions.items()})
    _isolate(files, package)
    files["resources/drawing.json"] = drawing
    files.update(documentation_files(folder))
    if forwarder:
        binary = f"binaries/linux64/{name}.so"
        files["binaries/linux64/pythonfmu-export.so"] = files[binary]
        files[binary] = forwarder.read_bytes()
        files["binaries/linux64/guid.txt"] = guid.encode()
        how += ", forwarding library for linux64"
    else:
        how += f", PythonFMU's binary ({forwarding.why_not()})"
    path = out / f"{name}.fmu"
    _write(path, files)
    seconds = time.perf_counter() - began
    return BuiltFmu(name, path, f"{path}: {how}, {path.stat().st_size // 1024} kB, {seconds:.1f} s")


def _pack(
    name: str, main: str, texts: dict[str, bytes], sources: Runtime, package: str
) -> dict[str, bytes]:
    """Let PythonFMU pack the FMU; returns its files."""
    with tempfile.TemporaryDirectory(prefix="curvebound-build-") as scratch:
        stage = Path(scratch) / "stage"
        stage.mkdir()
        for file, content in texts.items():
            (stage / file).parent.mkdir(exist_ok=True)
            (stage / file).write_bytes(content)
        sources.write(stage, package)
        others = [path for path in stage.iterdir() if path.name != f"{main}.py"]
        with _own_modules(package, *(Path(file).parts[0].removesuffix(".py") for file in texts)):
            target = FmuBuilder.build_FMU(
                stage / f"{main}.py", dest=Path(scratch) / f"{name}.fmu", project_files=others
            )
        with zipfile.ZipFile(target) as archive:
            return {i.filename: archive.read(i) for i in archive.infolist() if not i.is_dir()}


@contextlib.contextmanager
def _own_modules(*names: str) -> Iterator[None]:
    """Leave neither sys.path nor sys.modules changed: PythonFMU's builder imports what it packs."""
    path = sys.path[:]
    writes = sys.dont_write_bytecode
    sys.dont_write_bytecode = True
    _forget(names)
    importlib.invalidate_caches()
    try:
        yield
    finally:
        sys.path[:] = path
        sys.dont_write_bytecode = writes
        _forget(names)
        importlib.invalidate_caches()


def _forget(names: tuple[str, ...]) -> None:
    for module in list(sys.modules):
        if module.split(".")[0] in names:
            del sys.modules[module]


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

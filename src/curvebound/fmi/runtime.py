"""The part of the package that travels inside an FMU, and its content hash.

Inside an FMU the package bears a name that carries the hash, because Python modules are shared by
the whole process: equal names must mean equal code.
"""

from __future__ import annotations

import hashlib
from importlib.metadata import version
from pathlib import Path
from typing import NamedTuple

__all__ = ["Runtime", "runtime"]

_PACKAGE = Path(__file__).resolve().parents[1]

#: what runs interpreted in any case: touched once per instance
_INTERPRETED = (
    "models/__init__.py",
    "integrators/__init__.py",
    "fmi/__init__.py",
    "fmi/common.py",
    "fmi/declaration.py",
    "fmi/ranges.py",
    "fmi/slave.py",
    "fmi/wrapped.py",
)


class Runtime(NamedTuple):
    """One reading of the sources: path inside the package -> content."""

    files: dict[str, bytes]
    #: what mypyc compiles
    compiled: tuple[str, ...]
    #: twelve hexadecimal digits that change with any line an FMU carries
    digest: str

    def package(self, *, compiled: bool) -> str:
        """Name of the package inside an FMU; compiled and interpreted ones do not share modules."""
        return f"curvebound_{self.digest}{'c' if compiled else ''}"

    def write(self, folder: Path, package: str) -> None:
        """Write the sources to `folder` as the package called `package`."""
        for file, content in self.files.items():
            path = folder / package / file
            path.parent.mkdir(parents=True, exist_ok=True)
            path.write_bytes(content)


def runtime() -> Runtime:
    """Read the sources that travel inside an FMU."""
    kernel = [
        path.relative_to(_PACKAGE).as_posix()
        for folder in ("models", "integrators")
        for path in (_PACKAGE / folder).glob("*.py")
        if path.name != "__init__.py"
    ]
    faces = ("controller", "engine", "plant", "table", "watch")
    compiled = (*sorted(kernel), *(f"fmi/{face}.py" for face in faces))
    files = {name: (_PACKAGE / name).read_bytes() for name in (*compiled, *_INTERPRETED)}
    files["__init__.py"] = _init(compiled).encode()
    digest = hashlib.sha256(version("pythonfmu").encode())
    for name, content in sorted(files.items()):
        digest.update(name.encode() + b"\0" + content + b"\0")
    return Runtime(files, compiled, digest.hexdigest()[:12])


def _init(compiled: tuple[str, ...]) -> str:
    """The package's __init__ inside an FMU.

    It imports everything at once: a second FMU of the same sources uses the first one's modules,
    and must not need a file of it after its folder has been deleted.
    """
    modules = [name[:-3].replace("/", ".") for name in compiled]
    lines = [f"from .{module} import __name__ as _" for module in modules]
    return "\n".join([*lines, "from .fmi import common, declaration, slave, wrapped", ""])

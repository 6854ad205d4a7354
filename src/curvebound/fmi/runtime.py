"""The part of the package that travels inside an FMU, and its content hash.

Inside an FMU the package bears a name that carries the hash, because Python modules are shared by
the whole process: equal names must mean equal code.
"""

from __future__ import annotations

import hashlib
from importlib.metadata import version
from pathlib import Path

__all__ = ["COMPILED", "kernel_hash", "package_name", "runtime_files"]

_PACKAGE = Path(__file__).resolve().parents[1]

#: what runs interpreted in any case: touched once per instance, or by PythonFMU's wrapper
_INTERPRETED = (
    "models/__init__.py",
    "integrators/__init__.py",
    "fmi/__init__.py",
    "fmi/common.py",
    "fmi/declaration.py",
    "fmi/slave.py",
)


def _kernel() -> list[str]:
    files = [
        path.relative_to(_PACKAGE).as_posix()
        for folder in ("models", "integrators")
        for path in (_PACKAGE / folder).glob("*.py")
        if path.name != "__init__.py"
    ]
    return [*sorted(files), "fmi/engine.py"]


#: what mypyc compiles, relative to the package
COMPILED: tuple[str, ...] = tuple(_kernel())


def _init() -> str:
    """The package's __init__ inside an FMU.

    It imports everything at once: a second FMU of the same sources uses the first one's modules, and
    must not need a file of it after its folder has been deleted.
    """
    modules = [name[:-3].replace("/", ".") for name in COMPILED]
    lines = [f"from . import {m}" if "." not in m else f"from .{m} import __name__ as _" for m in modules]
    return "\n".join([*lines, "from .fmi import common, declaration, slave", ""])


def runtime_files() -> dict[str, bytes]:
    """Path inside the package -> content, for everything that an FMU carries."""
    files = {name: (_PACKAGE / name).read_bytes() for name in (*COMPILED, *_INTERPRETED)}
    files["__init__.py"] = _init().encode()
    return files


def kernel_hash() -> str:
    """Twelve hexadecimal digits that change with any line an FMU carries."""
    digest = hashlib.sha256(version("pythonfmu").encode())
    for name, content in sorted(runtime_files().items()):
        digest.update(name.encode() + b"\0" + content + b"\0")
    return digest.hexdigest()[:12]


def package_name(*, compiled: bool) -> str:
    """Name of the package inside an FMU; compiled and interpreted builds do not share modules."""
    return f"curvebound_{kernel_hash()}{'c' if compiled else ''}"

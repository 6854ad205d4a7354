"""Where the project's own files live, in a checkout and in an installed wheel alike."""

from __future__ import annotations

import os
import sys
from pathlib import Path

__all__ = ["cache_directory", "fmus_directory", "license_text", "scenarios_directory"]

_PACKAGE = Path(__file__).resolve().parent


def _data(name: str) -> Path:
    """The top-level folder `name`: packed into the wheel, or that of the checkout."""
    packed = _PACKAGE / f"_{name}"
    return packed if packed.is_dir() else _PACKAGE.parents[1] / name


def fmus_directory() -> Path:
    """Folder of the systems that come with the package, one folder each."""
    return _data("fmus")


def scenarios_directory() -> Path:
    """Folder of the scenes that come with the package, one Python script each."""
    return _data("scenarios")


def license_text() -> str:
    """The licence of this package."""
    packed = _PACKAGE / "_LICENSE"
    path = packed if packed.is_file() else _PACKAGE.parents[1] / "LICENSE"
    return path.read_text(encoding="utf-8")


def cache_directory() -> Path:
    """Folder for what can be made again (compiled kernels); CURVEBOUND_CACHE overrides it."""
    chosen = os.environ.get("CURVEBOUND_CACHE")
    if chosen:
        return Path(chosen)
    if sys.platform == "win32":
        base = Path(os.environ.get("LOCALAPPDATA", Path.home() / "AppData" / "Local"))
    elif sys.platform == "darwin":
        base = Path.home() / "Library" / "Caches"
    else:
        base = Path(os.environ.get("XDG_CACHE_HOME") or Path.home() / ".cache")
    return base / "curvebound"

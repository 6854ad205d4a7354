"""Where the project's own files live, in a checkout and in an installed wheel alike."""

from __future__ import annotations

from pathlib import Path

__all__ = ["compiled_directory", "fmus_directory", "license_text", "scenarios_directory"]

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


def compiled_directory() -> Path:
    """Folder of what comes compiled with an installed package; empty or absent else."""
    return _PACKAGE / "_compiled"


def license_text() -> str:
    """The licence of this package."""
    packed = _PACKAGE / "_LICENSE"
    path = packed if packed.is_file() else _PACKAGE.parents[1] / "LICENSE"
    return path.read_text(encoding="utf-8")

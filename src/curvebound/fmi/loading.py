"""Inside an FMU: a compiled module in the place of the sources it was compiled from."""

from __future__ import annotations

import importlib
import sys

__all__ = ["adopt"]


def adopt(extension: str, modules: tuple[str, ...], *, required: bool = False) -> str:
    """Let the extension module stand for `modules`; returns '' or why it cannot be loaded here.

    Where it is `required` ImportError says that.
    """
    try:
        loaded = importlib.import_module(extension)
    except ImportError as error:
        if required:
            raise
        return str(error)
    for name in modules:
        sys.modules[name] = loaded
    return ""

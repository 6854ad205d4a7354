"""Writing files whole or not at all."""

from __future__ import annotations

import os
import tempfile
from collections.abc import Callable
from contextlib import suppress
from pathlib import Path

from .errors import CurveboundError

__all__ = ["require_writable", "write_whole"]


def require_writable(out: Path, *, folder: bool = False) -> None:
    """See, before long work, that the file `out` (or files in the folder `out`) can be written.

    Missing folders are made. Raises CurveboundError where it cannot.
    """
    inside = out if folder else out.parent
    try:
        if not folder and out.is_dir():
            raise IsADirectoryError(0, "it is a folder")
        inside.mkdir(parents=True, exist_ok=True)
        with tempfile.TemporaryFile(dir=inside):
            pass
    except OSError as error:
        raise _unwritable(out, error) from error


def _unwritable(out: Path, error: OSError) -> CurveboundError:
    return CurveboundError(
        f"{out} cannot be written: {error.strerror or error}. Choose another place."
    )


def write_whole(out: Path, write: Callable[[Path], object]) -> Path:
    """Have `write` write a temporary file beside `out`, then put it in its place; returns `out`.

    Missing folders are made. Raises CurveboundError where the file cannot be written.
    """
    temporary = out.with_name(f".{out.stem}.{os.getpid()}{out.suffix}")
    try:
        out.parent.mkdir(parents=True, exist_ok=True)
        write(temporary)
        os.replace(temporary, out)
    except OSError as error:
        raise _unwritable(out, error) from error
    finally:
        with suppress(OSError):
            temporary.unlink()
    return out

"""Writing files whole or not at all."""

from __future__ import annotations

import os
from collections.abc import Callable
from contextlib import suppress
from pathlib import Path

from .errors import CurveboundError

__all__ = ["write_whole"]


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
        raise CurveboundError(
            f"{out} cannot be written: {error.strerror or error}. Choose another place."
        ) from error
    finally:
        with suppress(OSError):
            temporary.unlink()
    return out

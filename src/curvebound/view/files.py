"""Writing files whole or not at all, and reading those that the pages are made of."""

from __future__ import annotations

import os
from collections.abc import Callable
from contextlib import suppress
from importlib.resources import files
from pathlib import Path

from ..errors import CurveboundError

__all__ = ["asset", "write_text", "write_whole"]


def asset(name: str) -> str:
    """The text of a file in view/assets."""
    return (files(__package__) / "assets" / name).read_text(encoding="utf-8")


def write_whole(out: Path, write: Callable[[Path], None]) -> Path:
    """Have `write` write a temporary file beside `out`, then put it in its place.

    Raises CurveboundError where the folder cannot be written.
    """
    temporary = out.with_name(f".{out.stem}.{os.getpid()}{out.suffix}")
    try:
        out.parent.mkdir(parents=True, exist_ok=True)
        write(temporary)
        os.replace(temporary, out)
    except OSError as error:
        raise CurveboundError(
            f"{out} cannot be written: {error.strerror or error}. Choose another place with --out."
        ) from error
    finally:
        with suppress(OSError):
            temporary.unlink()
    return out


def write_text(out: Path, text: str) -> Path:
    """Write `text` to `out`, whole or not at all."""
    return write_whole(out, lambda path: _write(path, text))


def _write(path: Path, text: str) -> None:
    path.write_text(text, encoding="utf-8", newline="\n")

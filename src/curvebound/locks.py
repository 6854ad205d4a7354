"""One process at a time: locks that the system takes back when the process that holds them ends."""

from __future__ import annotations

import os
import sys
import time
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from pathlib import Path

if sys.platform == "win32":
    import msvcrt
else:
    import fcntl

__all__ = ["locked"]

_FAR = 1 << 30  # Windows: the byte that is locked lies behind those that others read


@contextmanager
def locked(path: Path, *, wait: bool) -> Iterator[None]:
    """Hold the lock file `path`, which is made for it and removed afterwards.

    wait: for the process that holds it; otherwise BlockingIOError, whose text is that one's id.
    Raises OSError where there can be no lock: no such folder, no permission, no support for it.
    """
    while True:
        handle = os.open(path, os.O_RDWR | os.O_CREAT | getattr(os, "O_NOFOLLOW", 0), 0o644)
        try:
            _take(handle, wait)
            # whoever held it has removed the file: what counts is the one that is there now
            if os.path.samestat(os.fstat(handle), os.stat(path)):
                break
        except FileNotFoundError:
            pass
        except BaseException:
            os.close(handle)
            raise
        os.close(handle)
    try:
        os.truncate(handle, 0)
        os.write(handle, str(os.getpid()).encode())
        yield
    finally:
        with suppress(OSError):
            path.unlink()  # before it is given back: see above
        os.close(handle)


if sys.platform == "win32":

    def _take(handle: int, wait: bool) -> None:
        while True:
            os.lseek(handle, _FAR, os.SEEK_SET)
            try:
                msvcrt.locking(handle, msvcrt.LK_NBLCK, 1)
            except PermissionError:
                if not wait:
                    raise _held(handle) from None
                time.sleep(0.1)
            else:
                os.lseek(handle, 0, os.SEEK_SET)
                return

else:

    def _take(handle: int, wait: bool) -> None:
        try:
            fcntl.flock(handle, fcntl.LOCK_EX if wait else fcntl.LOCK_EX | fcntl.LOCK_NB)
        except BlockingIOError:
            raise _held(handle) from None


def _held(handle: int) -> BlockingIOError:
    os.lseek(handle, 0, os.SEEK_SET)
    return BlockingIOError(os.read(handle, 20).decode(errors="replace") or "?")

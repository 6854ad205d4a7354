"""Writing files: whole or not at all, by one process at a time, and compared at the end."""

from __future__ import annotations

import errno
import hashlib
import os
import re
import tempfile
from collections.abc import Callable, Iterator
from contextlib import ExitStack, contextmanager, suppress
from pathlib import Path

from .errors import CurveboundError, OutsideError, remedy_of
from .locks import locked

__all__ = [
    "append",
    "inside",
    "remove",
    "require_as_left",
    "require_writable",
    "sole_writer",
    "write_whole",
]

#: what file systems without locks answer; the comparison at the end is then all there is
_NO_LOCKS = (errno.ENOLCK, errno.ENOSYS, errno.EOPNOTSUPP, errno.EINVAL)

#: files as this process left them: inode, size, time of the last change
_left: dict[Path, tuple[int, int, int]] = {}


#: names that stand for themselves as names of files, on every system
_PLAIN = re.compile(r"\w(?:[\w .+-]*\w)?")
_DEVICES = re.compile(r"(?i)(CON|PRN|AUX|NUL|COM\d|LPT\d)(\..*)?")


def inside(folder: Path, name: str, ending: str = "") -> Path:
    """The path in `folder` of what is called `name`, by whomever: it never leads out of it.

    A plain name stands for itself. In any other what no file's name should have is replaced, and a
    hash is added, so that different names have different files.
    """
    if not _PLAIN.fullmatch(name) or _DEVICES.fullmatch(name) or len(name.encode()) > 100:
        word = re.sub(r"[^\w.+-]+", "_", name).strip("_.+-")[:25]
        name = f"{word or 'unnamed'}_{hashlib.sha256(name.encode()).hexdigest()[:8]}"
    return folder / f"{name}{ending}"


def require_writable(out: Path, *, folder: bool = False) -> None:
    """See, before long work, that the file `out` (or files in the folder `out`) can be written.

    Missing folders are made. Raises CurveboundError where it cannot.
    """
    path = _real(out)
    inside = path if folder else path.parent
    try:
        if not folder:
            _require_file(path)
        inside.mkdir(parents=True, exist_ok=True)
        with tempfile.TemporaryFile(dir=inside):
            pass
    except OSError as error:
        raise _unwritable(out, error) from error


@contextmanager
def sole_writer(*outs: Path, folder: bool = False, wait: bool = False) -> Iterator[None]:
    """Let no other process write the files `outs` (with `folder`: into these folders) meanwhile.

    wait: until another one has finished; otherwise that is a CurveboundError, as is a place that
    cannot be written. At the end every file that was written must be as this process left it.
    """
    with ExitStack() as stack:
        for out in outs:
            require_writable(out, folder=folder)
            path = _real(out)
            try:
                stack.enter_context(locked(path.with_name(f".{path.name}.lock"), wait=wait))
            except BlockingIOError as process:
                raise CurveboundError(
                    f"{out} is being written by process {process}: wait for it, or choose another "
                    "place."
                ) from None
            except OSError as error:
                if error.errno not in _NO_LOCKS:
                    raise _unwritable(out, error) from error
        yield
        for out in outs:
            real = _real(out)
            for path in list(_left):
                if path == real or real in path.parents:
                    require_as_left(path)


def write_whole(out: Path, write: Callable[[Path], object]) -> Path:
    """Have `write` write a temporary file beside `out`, then put it in its place; returns `out`.

    Missing folders are made. Raises CurveboundError where the file cannot be written.
    """
    path = _real(out)
    temporary = path.with_name(f".{path.stem}.{os.getpid()}{path.suffix}")
    try:
        _require_file(path)
        path.parent.mkdir(parents=True, exist_ok=True)
        write(temporary)
        os.replace(temporary, path)
        _left[path] = _state(path)
    except OSError as error:
        raise _unwritable(out, error) from error
    finally:
        with suppress(OSError):
            temporary.unlink()
    return out


def append(out: Path, text: str) -> None:
    """Append to a file, all or nothing; it reaches the system before this returns.

    Raises CurveboundError where that is impossible, or somebody else has changed the file since
    this process wrote it.
    """
    path = _real(out)
    if path in _left:
        require_as_left(path)
    data = memoryview(text.encode())
    try:
        with path.open("ab", buffering=0) as file:
            size = file.tell()
            try:
                while data:
                    data = data[file.write(data) :]
            except OSError:
                file.truncate(size)  # no half row on a full disk
                raise
            finally:
                _left[path] = _state(path)
    except OSError as error:
        raise _unwritable(out, error) from error


def remove(out: Path) -> None:
    """Remove a file that this process wrote."""
    path = _real(out)
    _left.pop(path, None)
    path.unlink(missing_ok=True)


def require_as_left(out: Path) -> None:
    """Raise CurveboundError where a file is not as this process left it."""
    path = _real(out)
    try:
        same = _state(path) == _left[path]
    except OSError:
        same = False
    if not same:
        raise CurveboundError(
            f"{path} was changed by something else while this was writing it: what it holds is not "
            "the whole result. Do it again, into a place of its own."
        )


def _real(out: Path) -> Path:
    return Path(os.path.realpath(out))


def _state(path: Path) -> tuple[int, int, int]:
    status = path.stat()
    return status.st_ino, status.st_size, status.st_mtime_ns


def _require_file(path: Path) -> None:
    if path.exists() and not path.is_file():
        raise OSError(0, "it is a folder" if path.is_dir() else "it is no regular file")


def _unwritable(out: Path, error: OSError) -> OutsideError:
    reason = error.strerror or error
    remedy = remedy_of(error) or "Choose another place."
    return OutsideError(f"{out} cannot be written: {reason}. {remedy}")

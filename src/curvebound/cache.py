"""What was made once need not be made again: a store of files, addressed by all they depend on.

An entry is a folder, named by a hash of its parts: everything that the files in it depend on, the
sources of the code that makes them included. So nothing in it ever grows old, and checkouts,
versions, branches and processes share one store without meeting each other's files.

The store is not trusted. It counts only while it belongs to the user and nobody else may write to
it, and an entry only while each file has the hash written down when it was made; what is damaged is
made again. Where there can be no store (no home, no permission, no space left), a temporary one of
this process stands in for it: that costs time, and nothing else.
"""

from __future__ import annotations

import atexit
import hashlib
import json
import logging
import os
import shutil
import stat
import sys
import tempfile
import time
from collections.abc import Callable, Iterable, Iterator
from contextlib import ExitStack, contextmanager, suppress
from pathlib import Path
from tempfile import TemporaryDirectory

from .errors import CurveboundError
from .locks import locked

__all__ = ["cache_directory", "entry", "sources"]

_LOG = logging.getLogger("curvebound")
_LIST = "contents.json"  # of an entry: file -> SHA-256
_FORMAT = "1"  # of entries
_MOST = 1_500_000_000  # bytes of all entries of one kind
_OLD = 86_400.0  # s after which what a stopped process left behind is removed


def cache_directory() -> Path:
    """Folder of the store: CURVEBOUND_CACHE, or the system's place for such things.

    Raises RuntimeError for a user without a home.
    """
    chosen = os.environ.get("CURVEBOUND_CACHE")
    if chosen:
        return Path(chosen)
    if sys.platform == "win32":
        local = os.environ.get("LOCALAPPDATA")
        base = Path(local) if local else Path.home() / "AppData" / "Local"
    elif sys.platform == "darwin":
        base = Path.home() / "Library" / "Caches"
    else:
        base = Path(os.environ.get("XDG_CACHE_HOME") or Path.home() / ".cache")
    return base / "curvebound"


def sources(*paths: Path) -> str:
    """A hash of files, and of all files below folders, by name and content: a part of an entry."""
    digest = hashlib.sha256()
    for path in paths:
        files = [path] if path.is_file() else _files(path)
        for file in files:
            name = file.relative_to(path.parent).as_posix()
            digest.update(f"{name}\0{_hash(file)}\0".encode())
    return digest.hexdigest()


def _files(folder: Path) -> list[Path]:
    """All files below, in a fixed order, but what Python compiled."""
    found = []
    for top, folders, names in os.walk(folder):
        folders[:] = [name for name in folders if name != "__pycache__"]
        found += [Path(top, name) for name in names]
    return sorted(found)


def entry(kind: str, parts: Iterable[str | bytes], make: Callable[[Path], object]) -> Path:
    """The folder with what `make` makes of `parts`: kept from an earlier time, or made now.

    kind: folder of such entries in the store.
    parts: all that the files depend on, in a fixed order.
    make: writes files into the empty folder that it is given, which is not in the store. What it
        raises is raised here, so that a failure of the store is never taken for one of a compiler.

    Whoever uses the folder reads from it only. It may be gone when another process starts.
    """
    key = _key(kind, parts)
    try:
        return _kept(kind, key, make)
    except _NoStore as error:
        _use_own_store(error)
    try:
        return _kept(kind, key, make)
    except _NoStore as error:
        raise _no_place(error) from error


class _NoStore(Exception):
    """The store cannot be read or written, or is not to be trusted."""


@contextmanager
def _of_store() -> Iterator[None]:
    """What fails in here is the store."""
    try:
        yield
    except OSError as error:
        where = error.filename or cache_directory()
        raise _NoStore(f"{where}: {error.strerror or error}") from error
    except RuntimeError as error:  # there is no home
        raise _NoStore(str(error)) from error


def _kept(kind: str, key: str, make: Callable[[Path], object]) -> Path:
    with _of_store():
        folder = _store() / kind
    found = folder / key
    if _is_whole(found, kind):
        with suppress(OSError):  # a store that can only be read serves as well
            os.utime(found)
        return found
    with ExitStack() as stack:
        with _of_store():
            folder.mkdir(exist_ok=True, mode=0o700)
            _require_private(folder)
            stack.enter_context(locked(folder / f".{key}.lock", wait=True))
        if _is_whole(found, kind):  # another process made it meanwhile
            return found
        with _of_store():
            scratch = Path(stack.enter_context(TemporaryDirectory(prefix="curvebound-make-")))
        make(scratch)
        with _of_store():
            _put(scratch, found, kind)
        _prune(folder, found)
    return found


def _key(kind: str, parts: Iterable[str | bytes]) -> str:
    digest = hashlib.sha256(f"{_FORMAT}\0{kind}\0".encode())
    for part in parts:
        data = part if isinstance(part, bytes) else part.encode()
        digest.update(b"%d\0" % len(data) + data)
    return digest.hexdigest()[:32]


def _store() -> Path:
    """The store, made if need be; OSError or RuntimeError where there is none to be trusted."""
    store = cache_directory().absolute()
    store.mkdir(parents=True, exist_ok=True, mode=0o700)
    _require_private(store)
    return store


def _require_private(path: Path) -> None:
    """PermissionError unless `path` is the user's own and nobody else may write to it."""
    if sys.platform == "win32":  # its folders inherit the rights of the user's profile
        return
    status = path.stat()
    if status.st_uid != os.geteuid():
        raise PermissionError(0, f"it belongs to user {status.st_uid}", str(path))
    if stat.S_IMODE(status.st_mode) & 0o022:
        raise PermissionError(0, "others may write to it; chmod go-w", str(path))


def _is_whole(found: Path, kind: str) -> bool:
    """Whether an entry is there, private, and holds just the files that were put into it."""
    try:
        for path in (found.parent, found, found / _LIST):
            _require_private(path)
        listed = json.loads((found / _LIST).read_text(encoding="utf-8"))
        if listed["entry"] != [kind, found.name]:
            return False
        there = {path.relative_to(found).as_posix(): path for path in _files(found)}
        there.pop(_LIST)
        if there.keys() != listed["files"].keys():
            return False
        for name, path in there.items():
            _require_private(path)
            if path.is_symlink() or _hash(path) != listed["files"][name]:
                return False
    except (OSError, ValueError, KeyError, TypeError, AttributeError):
        return False
    return True


def _hash(path: Path) -> str:
    return hashlib.sha256(path.read_bytes()).hexdigest()


def _put(scratch: Path, found: Path, kind: str) -> None:
    """Copy what was made into the store, and put it in its place, or a damaged one's, at once."""
    half = Path(tempfile.mkdtemp(prefix=".put-", dir=found.parent))
    try:
        files = {}
        for path in _files(scratch):
            copy = half / path.relative_to(scratch)
            copy.parent.mkdir(parents=True, exist_ok=True)
            copy.write_bytes(path.read_bytes())
            copy.chmod(0o755 if os.access(path, os.X_OK) else 0o644)
            files[copy.relative_to(half).as_posix()] = _hash(path)
        text = json.dumps({"entry": [kind, found.name], "files": files}, indent=1)
        (half / _LIST).write_text(text, encoding="utf-8")
        for path in (half / _LIST, *(p for p in half.rglob("*") if p.is_dir())):
            path.chmod(0o755 if path.is_dir() else 0o644)
        if os.path.lexists(found):
            os.replace(found, half.with_suffix(".damaged"))
        os.replace(half, found)
    finally:
        for left in (half, half.with_suffix(".damaged")):
            _remove(left)


def _remove(path: Path) -> None:
    if path.is_dir() and not path.is_symlink():
        shutil.rmtree(path, ignore_errors=True)
    else:
        path.unlink(missing_ok=True)


def _prune(folder: Path, newest: Path) -> None:
    """Remove what was not used for longest until the rest is small enough, and what was left."""
    with suppress(OSError):
        entries = []
        for path in folder.iterdir():
            used = path.stat().st_mtime
            if path.name.startswith("."):
                if not path.name.endswith(".lock") and time.time() - used > _OLD:
                    _remove(path)
            elif path != newest:
                size = sum(p.stat().st_size for p in path.rglob("*"))
                entries.append((used, size, path))
        total = sum(size for _, size, _ in entries)
        for _, size, path in sorted(entries):
            if total <= _MOST:
                break
            _remove(path)
            total -= size


def _use_own_store(error: _NoStore) -> None:
    """Let this process, and those that it starts, use a store that is removed when it ends."""
    try:
        own = tempfile.mkdtemp(prefix="curvebound-cache-")
    except OSError as failed:
        raise _no_place(failed) from failed
    _LOG.warning(
        "There is no cache (%s): what is compiled, built and computed is not kept for other runs. "
        "Set CURVEBOUND_CACHE to a folder of your own.",
        error,
    )
    os.environ["CURVEBOUND_CACHE"] = own
    atexit.register(_remove_own, Path(own), os.getpid())


def _no_place(error: Exception) -> CurveboundError:
    return CurveboundError(
        f"There is no place for temporary files ({error}): set TMPDIR to a folder with free space."
    )


def _remove_own(store: Path, process: int) -> None:
    if os.getpid() == process:
        _remove(store)

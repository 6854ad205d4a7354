"""What goes wrong, in words for users: each message names the thing, its value and the remedy."""

from __future__ import annotations

import difflib
import errno
from collections.abc import Iterable, Iterator
from contextlib import contextmanager

__all__ = ["CurveboundError", "OutsideError", "at", "nearest", "reading", "remedy_of", "said"]


class CurveboundError(Exception):
    """Something the user can mend: the message names the thing, its value and the remedy."""

    #: of a command that ends with it
    status = 1


class OutsideError(CurveboundError):
    """Data from outside, or the system, is not as it must be: which file, where, what helps."""

    status = 2


_REMEDIES = {
    errno.ENOSPC: "Make room there.",
    errno.EDQUOT: "Make room there.",
    errno.EFBIG: "Files may not be that large here: raise the limit, or write less.",
    errno.EMFILE: "Too many files are open: raise the limit (ulimit -n).",
    errno.ENFILE: "Too many files are open: close other programs.",
    errno.EACCES: "Change its rights, or choose another place.",
    errno.EPERM: "Change its rights, or choose another place.",
    errno.EROFS: "Choose another place.",
    errno.ENOENT: "Check the name.",
    errno.ENOMEM: "Close other programs, or do less at once.",
}


def said(error: BaseException) -> str:
    """An exception in one line, without a full stop: a fault of the system with its file."""
    if isinstance(error, OSError) and error.strerror:
        where = f"{error.filename}: " if error.filename else ""
        return f"{where}{error.strerror}"
    text = " ".join(str(error).split()).rstrip(".")
    if isinstance(error, KeyError):
        return f"{text} is missing"
    if isinstance(error, MemoryError):
        return "there is not enough memory"
    if isinstance(error, ValueError | CurveboundError) and text:
        return text
    return f"{type(error).__name__}: {text}" if text else type(error).__name__


@contextmanager
def at(place: str) -> Iterator[None]:
    """Say with everything that goes wrong in here where in the file that is."""
    try:
        yield
    except Exception as error:
        raise ValueError(f"{place}: {said(error)}") from error


@contextmanager
def reading(what: object, remedy: str = "") -> Iterator[None]:
    """Turn everything that data from outside, or the system, can do in here into an OutsideError.

    what: the file, or what else is read or used; remedy: a sentence, unless the system's own fault
    has one.
    """
    try:
        yield
    except CurveboundError:
        raise
    except Exception as error:  # libraries raise what they like: zlib.error, ParseError
        raise OutsideError(
            f"{what}: {said(error)}. {remedy_of(error) or remedy}".strip()
        ) from error


def remedy_of(error: BaseException) -> str:
    """What helps against a fault of the system, as a sentence; empty for any other."""
    return _REMEDIES.get(error.errno or 0, "") if isinstance(error, OSError) else ""


def nearest(name: str, known: Iterable[str]) -> str:
    """A clause that suggests the known names nearest to `name`, or says what there is."""
    known = list(known)
    close = difflib.get_close_matches(name, known, n=3, cutoff=0.5)
    if close:
        return f"did you mean {' or '.join(close)}?"
    if not known:
        return "there is none"
    shown = ", ".join(known[:12]) + (", ..." if len(known) > 12 else "")
    return f"there is {shown}"

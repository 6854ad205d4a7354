"""From a mechanics.py to all that follows: derived once, kept, and then read without sympy."""

from __future__ import annotations

import json
from dataclasses import asdict
from functools import lru_cache
from pathlib import Path
from typing import Any

from ..cache import entry, sources
from ..errors import CurveboundError
from .derived import Derived, Implied

__all__ = ["derive", "derive_text"]


def derive(path: Path, title: str = "") -> Derived:
    """What follows from the statement MECHANICS in the file `path`, see derive_text()."""
    return derive_text(path.read_text(encoding="utf-8"), title or path.parent.name, str(path))


def derive_text(text: str, title: str, where: str) -> Derived:
    """What follows from the statement MECHANICS in the text of a mechanics.py.

    title: name of the system. where: of the text, for messages. Kept in the cache by content; sympy
    is needed only where it is not there. Raises CurveboundError for what cannot be derived.
    """
    parts = [title, text, sources(Path(__file__).parent)]
    folder = entry("mechanics", parts, lambda scratch: _write(text, title, where, scratch))
    return _read(folder, (folder / "derived.json").stat().st_mtime_ns)


@lru_cache(maxsize=64)
def _read(folder: Path, _: int) -> Derived:
    found = json.loads((folder / "derived.json").read_text(encoding="utf-8"))
    found["variables"] = tuple(Implied(**v) for v in found["variables"])
    whole: dict[str, Any] = {k: tuple(v) if isinstance(v, list) else v for k, v in found.items()}
    return Derived(**whole)


def _write(text: str, title: str, where: str, folder: Path) -> None:
    try:
        from .deriving import derived_from
    except ImportError as error:
        raise CurveboundError(
            f"{where} states a system that has to be derived, which needs sympy ({error}): install "
            "curvebound with its extra `systems`."
        ) from error
    found = asdict(derived_from(text, title, where))
    found["variables"] = [v._asdict() for v in found["variables"]]
    (folder / "derived.json").write_text(json.dumps(found), encoding="utf-8")

"""References kept on disk: what was computed once need not be computed again.

A reference is kept under a hash of all that it depends on: the scene's parameters, links and
signals, the starts, and the source code that computes it. FMUs are no part of it: a reference does
not use them, and holds for every build of them. Files that were not used for longest give way.
"""

from __future__ import annotations

import hashlib
import json
import os
from collections.abc import Mapping, Sequence
from contextlib import suppress
from functools import lru_cache
from pathlib import Path
from typing import TYPE_CHECKING, Any
from zipfile import BadZipFile

import numpy as np

from ..cache import cache_directory
from ..errors import CurveboundError
from ..files import write_whole
from .equations import Array
from .monolith import Monolith, Value

if TYPE_CHECKING:
    from ..cosim.system import System

__all__ = ["keep", "key_of", "load"]

_MOST = 1_500_000_000  # bytes of all that is kept
_SAMPLES = 4001  # times at which signals are compared
_SOURCES = ("collocation.py", "extrapolation.py", "kept.py", "monolith.py", "reference.py")


@lru_cache(maxsize=1)
def _code() -> str:
    """Hash of the sources that a reference is computed by."""
    folder = Path(__file__).parent
    files = [folder / name for name in _SOURCES]
    files += sorted((folder / "equations").glob("*.py"))
    digest = hashlib.sha256()
    for file in files:
        digest.update(file.name.encode() + b"\0" + file.read_bytes())
    return digest.hexdigest()


def key_of(
    system: System,
    paths: Sequence[str],
    stop: float,
    changes: Mapping[str, Value] | None,
    continuous: bool,
) -> str:
    """The name under which a reference is kept; arguments as of `refer`."""
    scene = system.scene
    times = np.linspace(scene.start_time, stop, _SAMPLES)
    described = {
        "code": _code(),
        "precision": str(np.finfo(np.longdouble)),
        "components": {
            name: [node.fmu.model_name, _parameters(node)] for name, node in system.nodes.items()
        },
        "links": sorted(str(link) for link in system.links),
        "signals": {
            ".".join(port): [repr(float(function(float(t)))) for t in times]
            for port, function in system.signals.items()
        },
        "time": [scene.start_time, stop, scene.step],
        "changes": {
            path: value if isinstance(value, str) else [repr(float(x)) for x in np.ravel(value)]
            for path, value in (changes or {}).items()
        },
        "paths": list(paths),
        "continuous": continuous,
    }
    text = json.dumps(described, sort_keys=True, default=str)
    return hashlib.sha256(text.encode()).hexdigest()[:32]


def _parameters(node: Any) -> list[list[str]]:
    """Every value that the equations may use; not how an FMU solves them."""
    return [
        [name, str(node.start.get(name, variable.start))]
        for name, variable in sorted(node.fmu.variables.items())
        if not name.startswith("solver.")
    ]


def _file(key: str) -> Path:
    return cache_directory() / "references" / f"{key}.npz"


def load(key: str, monolith: Monolith) -> dict[str, Any] | None:
    """What `keep` was given, or None; what was held over each step is given to the monolith."""
    path = _file(key)
    try:
        with np.load(path, allow_pickle=False) as file:
            data = {name: file[name] for name in file.files}
        history = [
            (float(t), {_port(p): values[i] for i, p in enumerate(data["ports"])})
            for t, values in zip(data["held_at"], data["held"], strict=True)
        ]
    except (OSError, ValueError, KeyError, EOFError, BadZipFile):
        return None  # not there, or cut short: it is computed again
    monolith.history = history
    with suppress(OSError):  # a cache that can be read only serves as well
        os.utime(path)
    return data


def _port(text: Any) -> tuple[str, str]:
    name, _, variable = str(text).partition(" ")
    return name, variable


def keep(key: str, monolith: Monolith, data: Mapping[str, Array]) -> None:
    """Keep arrays under a key, with what the monolith held; a full disk is no error."""
    history = monolith.history
    ports = list(history[0][1]) if history else []
    shape = (monolith.members,)
    held = np.array(
        [[np.broadcast_to(values[port], shape) for port in ports] for _, values in history],
        dtype=np.longdouble,
    )
    path = _file(key)
    arrays: dict[str, Any] = {
        **data, "ports": np.array([" ".join(port) for port in ports], dtype=str),
        "held_at": np.array([t for t, _ in history]), "held": held,
    }  # fmt: skip
    with suppress(CurveboundError):
        write_whole(path, lambda temporary: np.savez(temporary, **arrays))
        _prune(path.parent)


def _prune(folder: Path) -> None:
    """Delete what was not used for longest until the rest is small enough."""
    with suppress(OSError):
        files = sorted((f.stat().st_mtime, f.stat().st_size, f) for f in folder.glob("*.npz"))
        total = sum(size for _, size, _ in files)
        for _, size, file in files[:-1]:
            if total <= _MOST:
                break
            file.unlink(missing_ok=True)
            total -= size

"""Copies of the package's sources to build from: changed, elsewhere, at another time."""

from __future__ import annotations

import json
import os
import shutil
import subprocess
import sys
from collections.abc import Callable
from pathlib import Path

from curvebound import places
from curvebound.fmi.declaration import Fmu
from curvebound.fmi.reference import ReferenceResult

_BUILD = """
import pathlib, sys
from curvebound.fmi.build import build
for name in sys.argv[3:]:
    build(name, pathlib.Path(sys.argv[1]), compiled=sys.argv[2] == "compiled")
"""

_EDITED = """
import json, pathlib, sys
from curvebound.fmi import documentation
from curvebound.fmi.build import build
from source_copies import replace_once, with_short_reference
documentation.reference_result = with_short_reference(documentation.reference_result)
for out, file, old, new in json.loads(sys.argv[1]):
    replace_once(pathlib.Path(file), old, new)
    for name in sys.argv[2:]:
        build(name, pathlib.Path(out), compiled=False)
"""


def copy_sources(root: Path) -> Path:
    """Copy package, declarations and licence as in a checkout; returns the package's folder."""
    ignored = shutil.ignore_patterns("__pycache__")
    package = root / "src" / "curvebound"
    shutil.copytree(Path(places.__file__).parent, package, ignore=ignored)
    if not (package / "_fmus").is_dir():
        shutil.copytree(places.fmus_directory(), root / "fmus", ignore=ignored)
        (root / "LICENSE").write_text(places.license_text(), encoding="utf-8")
    return package


def declarations(package: Path) -> Path:
    """The folder of the declarations that belong to a copied package."""
    packed = package / "_fmus"
    return packed if packed.is_dir() else package.parents[1] / "fmus"


def build_from(
    package: Path,
    out: Path,
    *names: str,
    compiled: bool = False,
    cwd: Path | None = None,
    environment: dict[str, str] | None = None,
) -> None:
    """Build FMUs from a copied package in a process of its own."""
    done = subprocess.run(
        [sys.executable, "-c", _BUILD, str(out), "compiled" if compiled else "-", *names],
        cwd=cwd,
        env={**os.environ, "PYTHONPATH": str(package.parent), **(environment or {})},
        capture_output=True,
        text=True,
    )
    assert done.returncode == 0, done.stderr


def build_edited(
    package: Path, out: Path, edits: dict[str, tuple[Path, str, str]], *names: str
) -> None:
    """Replace a text in a file, build FMUs into out/LABEL, and so on with the next edit.

    All in one process, which shall see each edit. The reference results are of one step.
    """
    todo = json.dumps(
        [[str(out / label), str(file), *texts] for label, (file, *texts) in edits.items()]
    )
    done = subprocess.run(
        [sys.executable, "-c", _EDITED, todo, *names],
        env={**os.environ, "PYTHONPATH": f"{package.parent}{os.pathsep}{Path(__file__).parent}"},
        capture_output=True,
        text=True,
    )
    assert done.returncode == 0, done.stderr


def with_short_reference(
    reference_result: Callable[[Fmu], ReferenceResult],
) -> Callable[[Fmu], ReferenceResult]:
    """The same of one step in place of the whole experiment: most of the time of a build."""
    return lambda fmu: reference_result(fmu._replace(stop_time=fmu.step_size))


def replace_once(file: Path, old: str, new: str) -> None:
    text = file.read_text()
    assert text.count(old) == 1, (file, old)
    file.write_text(text.replace(old, new))

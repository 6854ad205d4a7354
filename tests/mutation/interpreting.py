"""A pytest plugin of the campaign: FMUs run interpreted, the same bits with no compiler between.

The reference results in them, minutes when interpreted and watched, are those that were computed
by the compiled kernel before, in the file CAMPAIGN_REFERENCES.
"""

from __future__ import annotations

import os
import pickle
from pathlib import Path

from curvebound.fmi import compile as kernel
from curvebound.fmi import documentation
from curvebound.fmi.declaration import Fmu
from curvebound.fmi.folder import find, names
from curvebound.fmi.reference import ReferenceResult, reference_result

_known: dict[tuple[str, int], ReferenceResult] = {}


def keep_references(file: Path) -> None:
    """Compute those of all systems."""
    fmus = [find(name).fmu() for name in names()]
    file.write_bytes(pickle.dumps({_key(fmu): reference_result(fmu) for fmu in fmus}))


def _key(fmu: Fmu) -> tuple[str, int]:
    return fmu.name, len(fmu.variables)


def _remembered(fmu: Fmu) -> ReferenceResult:
    return _known.get(_key(fmu)) or reference_result(fmu)


def interpret() -> None:
    """From now on what this process builds runs interpreted."""
    kernel.why_not = lambda *_, **__: "a mutant runs interpreted"
    _known.update(pickle.loads(Path(os.environ["CAMPAIGN_REFERENCES"]).read_bytes()))
    documentation.reference_result = _remembered


def pytest_collection_finish() -> None:
    """Where tests of the translation itself know already that they can compile."""
    interpret()

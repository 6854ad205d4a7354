"""The systems once more, as textbooks write them: what the FMUs' results are judged against.

One module per FMU, named like its file in fmus/, each with its `SYSTEM`. Nothing here is shared
with curvebound.models: the same physics is written down twice more, in generalised coordinates with
the mass matrix and in Cartesian coordinates with multipliers, so that no error in one can hide.
"""

from __future__ import annotations

import importlib
import re
from pathlib import Path

from ...errors import CurveboundError
from .base import Array, Equations, Inputs, System, Witness

__all__ = ["Array", "Equations", "Inputs", "System", "Witness", "known_systems", "system_of"]


def known_systems() -> list[str]:
    """Names of the FMUs whose equations are here."""
    stems = sorted(p.stem for p in Path(__file__).parent.glob("*.py"))
    return [
        "".join(word.capitalize() for word in stem.split("_"))
        for stem in stems
        if stem not in ("__init__", "base")
    ]


def system_of(model_name: str) -> System:
    """The equations of an FMU by its model name; CurveboundError where there are none."""
    if model_name not in known_systems():
        raise CurveboundError(
            f"There is no reference for the FMU {model_name}: its equations are not in "
            f"curvebound/study/equations, which has {', '.join(known_systems())}. Add a module "
            "that defines SYSTEM, as those do."
        )
    stem = re.sub(r"(?<=[a-z0-9])(?=[A-Z])", "_", model_name).lower()
    system: System = importlib.import_module(f".{stem}", __name__).SYSTEM
    return system

"""The folder of a system: what is declared of it, found by name and loaded."""

from __future__ import annotations

import importlib.util
import re
from pathlib import Path
from types import ModuleType

from ..errors import CurveboundError
from ..places import fmus_directory
from .declaration import Fmu
from .drawing import Drawing, complete

__all__ = ["folder_of", "load_declaration", "load_drawing", "names", "shipped_drawings"]


def names() -> list[str]:
    """The FMUs that come with the package: one folder each in fmus/."""
    return sorted(
        "".join(word.capitalize() for word in path.parent.name.split("_"))
        for path in fmus_directory().glob("*/fmu.py")
    )


def folder_of(name: str) -> Path:
    """The folder of the system whose FMU is called `name`; CurveboundError where there is none."""
    if name not in names():
        raise CurveboundError(f"there is no FMU {name!r}: choose one of {', '.join(names())}")
    return fmus_directory() / re.sub(r"(?<=[a-z0-9])(?=[A-Z])", "_", name).lower()


def load_declaration(name: str) -> Fmu:
    """The declaration, FMU in fmu.py, of the system called `name`."""
    folder = folder_of(name)
    fmu: Fmu = _load(folder / "fmu.py").FMU
    if fmu.name != name:
        raise CurveboundError(
            f"{folder / 'fmu.py'} declares an FMU {fmu.name!r}: call it {name!r}, or rename the"
            " folder"
        )
    return fmu


def load_drawing(name: str) -> Drawing:
    """The drawing, DRAWING in drawing.py, of the system called `name`; its plots without one."""
    source = folder_of(name) / "drawing.py"
    drawing: Drawing = _load(source).DRAWING if source.is_file() else Drawing()
    return complete(drawing, load_declaration(name))


def shipped_drawings() -> list[Drawing]:
    """The drawings of the systems that come with the package."""
    return [load_drawing(name) for name in names()]


def _load(source: Path) -> ModuleType:
    """Execute a module of a system's folder."""
    spec = importlib.util.spec_from_file_location(
        f"curvebound_{source.parent.name}_{source.stem}", source
    )
    assert spec is not None
    assert spec.loader is not None
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module

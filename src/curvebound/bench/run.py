"""The benchmark as a whole: which sections there are, and running them one after the other."""

from __future__ import annotations

import tempfile
from collections.abc import Callable, Iterable
from pathlib import Path

from ..errors import CurveboundError
from .results import Section, Settings

__all__ = ["SECTIONS", "run_sections"]

SECTIONS = ("kernel", "fmu", "accuracy", "size", "startup")


def _run(name: str, settings: Settings, advance: Callable[[], object], folder: Path) -> Section:
    if name == "kernel":
        from .kernel_section import kernel_section

        return kernel_section(settings, advance)
    if name == "fmu":
        from .fmu_section import fmu_section

        return fmu_section(settings, advance, folder)
    if name == "accuracy":
        from .accuracy_section import accuracy_section

        return accuracy_section(settings, advance, folder)
    if name == "size":
        from .size_section import size_section

        return size_section(settings, advance, folder)
    from .startup_section import startup_section

    return startup_section(settings, advance, folder)


def run_sections(
    names: Iterable[str], settings: Settings, progress: Callable[[str, int], object]
) -> list[Section]:
    """Run the sections `names`; calls progress(section, measurements made in it) as it goes.

    A section that cannot run here (no C compiler) is left with a note that says why.
    """
    sections: list[Section] = []
    for name in names:
        made = [0]

        def advance(name: str = name, made: list[int] = made) -> None:
            made[0] += 1
            progress(name, made[0])

        progress(name, 0)
        with tempfile.TemporaryDirectory(
            prefix="curvebound-bench-", ignore_cleanup_errors=True
        ) as f:
            try:
                sections.append(_run(name, settings, advance, Path(f)))
            except CurveboundError as error:
                sections.append(Section(name, f"{name}: left out", notes=[str(error)]))
    return sections

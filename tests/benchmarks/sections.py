"""The cost benchmark as a whole: its sections, run one after the other and reported."""

from __future__ import annotations

import subprocess
import tempfile
from collections.abc import Callable, Iterable
from pathlib import Path

from curvebound.errors import CurveboundError
from curvebound.machine import machine

from .accuracy_section import accuracy_section
from .fmu_section import fmu_section
from .kernel_section import kernel_section
from .native import FLAGS, compiler
from .results import Section, Settings
from .size_section import size_section
from .startup_section import startup_section

__all__ = ["SECTIONS", "described_machine", "run_sections"]

Advance = Callable[[], object]

SECTIONS: dict[str, Callable[[Settings, Advance, Path], Section]] = {
    "kernel": lambda settings, advance, _: kernel_section(settings, advance),
    "fmu": fmu_section,
    "accuracy": accuracy_section,
    "size": size_section,
    "startup": startup_section,
}


def _compiler() -> str:
    try:
        command = compiler()
    except CurveboundError:
        return "none"
    done = subprocess.run([command, "--version"], capture_output=True, text=True, check=False)
    first = (done.stdout or command).splitlines()[0]
    return f"{first} {' '.join(flag for flag in FLAGS if flag.startswith('-O'))}"


def described_machine() -> dict[str, str]:
    """The machine, with compiler and general tools."""
    return {**machine("heyoka", "mujoco"), "compiler": _compiler()}


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
                sections.append(SECTIONS[name](settings, advance, Path(f)))
            except CurveboundError as error:
                sections.append(Section(name, f"{name}: left out", notes=[str(error)]))
    return sections

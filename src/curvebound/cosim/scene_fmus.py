"""FMUs for one scene: each component with the scene's start values, and what the scene needs."""

from __future__ import annotations

import re
from pathlib import Path

from ..errors import CurveboundError
from ..fmi.folder import find
from ..fmi.specialised import Specialised
from .resolution import resolve
from .scene_data import SceneData

__all__ = ["specialised"]


def specialised(scene: SceneData) -> list[Specialised]:
    """The systems of a scene's components, one each, to be built for it.

    An FMU is named after scene and component: InvertedBalancePlant. Its description has the
    variables that the scene sets, drives, connects, records or bounds. Components that are FMU
    files are left out; CurveboundError where nothing remains.
    """
    system = resolve(scene)
    used = {name: set(component.start) for name, component in scene.components.items()}
    ports = [*system.signals, *system.recorded]
    ports += [port for link in system.links for port in (link.source, link.target)]
    ports += [(name, variable) for name, _, variable in map(_parted, scene.needs.errors)]
    ports += [(name, variable) for name, _, variable in map(_parted, scene.inputs)]
    for name, variable in ports:
        used[name].add(variable)
    found = []
    for name, component in scene.components.items():
        if Path(component.source).suffix.lower() == ".fmu":
            continue
        node = system.nodes[name]
        start = {variable: float(node.start[variable]) for variable in component.start}
        if scene.tolerance is not None and "solver.tolerance" in node.fmu.variables:
            start["solver.tolerance"] = scene.tolerance
        found.append(
            Specialised(
                find(component.source, scene.folder).path,
                fmu_name=_word(scene.name) + _word(name),
                start=tuple(sorted(start.items())),
                shown=tuple(sorted(used[name] | start.keys())),
                stop_time=scene.stop_time,
                step_size=scene.step,
            )
        )
    if not found:
        raise CurveboundError(
            f"The scene {scene.name} has FMU files only: what they are cannot be changed."
        )
    return found


def _parted(path: str) -> tuple[str, str, str]:
    return path.partition(".")


def _word(name: str) -> str:
    """A part of the name of an FMU."""
    word = "".join(part.capitalize() for part in re.findall(r"[A-Za-z0-9]+", name))
    return word if word[:1].isalpha() else f"Scene{word}"

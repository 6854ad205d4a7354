"""What the FMUs of a scene can do, beside what it asks of them; and where they are."""

from __future__ import annotations

from collections.abc import Mapping
from contextlib import suppress
from pathlib import Path

from ..errors import CurveboundError
from ..fmi.folder import Folder, find
from ..places import fmus_directory
from ..progress import Progress
from .scene_data import SceneData
from .signals import Signal, jumps_of
from .system import Node, Port, path_of

__all__ = ["described", "has_unbuilt", "lacking", "located", "stops"]


def lacking(scene: SceneData, nodes: Mapping[str, Node]) -> list[str]:
    """What the scene asks and an FMU cannot do, one line each."""
    problems = []
    once = [node for node in nodes.values() if node.fmu.only_once_per_process]
    names = [node.fmu.identifier for node in once]
    for node in once:
        if names.count(node.fmu.identifier) > 1:
            problems.append(
                f"component {node.name}: {node.fmu.model_name} can be instantiated only once "
                "in a process (canBeInstantiatedOnlyOncePerProcess); use it once"
            )
    for node in nodes.values() if scene.rolls_back else ():
        if not node.fmu.can_roll_back:
            needs = "adaptive macro steps need" if scene.adaptive else f"{scene.algorithm} needs"
            problems.append(
                f"component {node.name}: {node.fmu.model_name} cannot be rolled back "
                f"(canGetAndSetFMUstate is false), which {needs}; run it with a fixed step and "
                "another algorithm"
            )
    for node in nodes.values():
        if node.fmu.can_vary_step:
            continue
        if scene.adaptive is not None:
            problems.append(
                f"component {node.name}: {node.fmu.model_name} takes one step size only "
                "(canHandleVariableCommunicationStepSize is false); run it with a fixed step"
            )
        elif not _is_multiple(scene, scene.stop_time):
            problems.append(
                f"component {node.name}: {node.fmu.model_name} takes one step size only; "
                f"make stop_time, {scene.stop_time} s, a multiple of step, {scene.step} s"
            )
    return problems


def _is_multiple(scene: SceneData, time: float) -> bool:
    count = (time - scene.start_time) / scene.step
    return abs(count - round(count)) <= 1e-9 * max(1.0, count)


def stops(
    scene: SceneData, nodes: Mapping[str, Node], signals: Mapping[Port, Signal]
) -> tuple[list[float], list[str]]:
    """The jumps of the inputs, s, at which macro steps end where every component allows that.

    And a note for each jump that acts late since one does not.
    """
    jumps = {
        time: path_of(port)
        for port, function in signals.items()
        for time in jumps_of(function)
        if scene.start_time < time < scene.stop_time
    }
    rigid = [node.name for node in nodes.values() if not node.fmu.can_vary_step]
    if not rigid:
        return sorted(jumps), []
    return [], [
        f"The jump of {path} at {time:.9g} s acts at the communication point after it, "
        f"as {rigid[0]} takes one step size only; a step that divides it is exact."
        for time, path in sorted(jumps.items())
        if not _is_multiple(scene, time)
    ]


#: the FMUs of systems that were built, or found built, in this process: their sources do not change
#: under it
_BUILT: dict[Folder, Path] = {}


def has_unbuilt(scene: SceneData) -> bool:
    """Whether a component is a system of one's own that may have to be compiled, for a minute.

    Those that come with the package have compiled kernels.
    """
    for component in scene.components.values():
        if Path(component.source).suffix.lower() != ".fmu":
            with suppress(CurveboundError):  # what cannot be found is told where it is located
                system = find(component.source, scene.folder)
                if system not in _BUILT and system.path.parent != fmus_directory().resolve():
                    return True
    return False


def described(source: str | Path, folder: Path | None, place: Path) -> Path:
    """As `located`; of a system a file in the folder `place` that only describes its FMU."""
    if Path(source).suffix.lower() == ".fmu":
        return located(source, folder)
    from ..fmi.cached import write_described

    system = find(source, folder)
    return write_described(system, place / f"{system.name}.fmu")


def located(source: str | Path, folder: Path | None) -> Path:
    """The FMU file that a component names; one of ours is built if need be."""
    path = Path(source)
    if path.suffix.lower() != ".fmu":
        system = find(source, folder)
        if system not in _BUILT or not _BUILT[system].is_file():  # the cache may have been emptied
            _BUILT[system] = _build(system)
        return _BUILT[system]
    if folder is not None and not path.is_absolute():
        path = folder / path
    return path


def _build(system: Folder) -> Path:
    """The FMU of a system."""
    from ..fmi.cached import cached_fmu

    with Progress(f"building {system.name}"):
        return cached_fmu(system)

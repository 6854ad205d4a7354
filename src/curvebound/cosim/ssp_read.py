"""Scenes from SSP 1.0 packages of FMI 2.0 co-simulation FMUs, ours or anybody's.

Read are nested systems (flattened, their names joined by _), connections through the connectors of
systems, transformations and unit conversions, parameter values and mappings, inline and in files,
units, and the default experiment. Values that no variable has the name of are ignored, as the
standard says, with a note. Not read, and refused where they matter: what one component calculates
as a parameter of another, references to other packages, signal dictionaries.

FMUs none of whose outputs declares dependencies count as having no direct feedthrough: taken to
the letter of FMI every coupling of two of them would be an algebraic loop.
"""

from __future__ import annotations

import atexit
import shutil
import tempfile
import zipfile
from pathlib import Path
from typing import Any
from xml.etree import ElementTree

from ..errors import CurveboundError, at, reading
from ..units import conversion
from .scene import Scene
from .ssp import ANNOTATION, NAMESPACES
from .ssp_parameters import Parameters
from .ssp_settings import read_settings
from .ssp_structure import Structure, require_new
from .ssp_values import Transformation, number
from .system import Port
from .tables import read_csv

__all__ = ["read_ssp"]

Element = ElementTree.Element


def read_ssp(path: Path | str) -> Scene:
    """The scene of an SSP package (its SystemStructure.ssd).

    Raises CurveboundError, which names what cannot be read and why.
    """
    path = Path(path)
    if not path.is_file():
        raise CurveboundError(f"There is no SSP package at {path}.")
    with reading(f"{path} cannot be read as an SSP package", "Get it anew, or mend that."):
        folder = _unpack(path)
        ssd = folder / "SystemStructure.ssd"
        if not ssd.is_file():
            raise ValueError("it holds no SystemStructure.ssd")
        with at("SystemStructure.ssd is no XML"):
            root = ElementTree.parse(ssd).getroot()
        system = root.find("ssd:System", NAMESPACES)
        if system is None:
            raise ValueError("SystemStructure.ssd describes no system")
        return _Reader(path, root, Structure(folder, root, system)).scene()


_unpacked: dict[tuple[str, int, int], Path] = {}


def _unpack(path: Path) -> Path:
    status = path.stat()
    identity = (str(path.resolve()), status.st_mtime_ns, status.st_size)
    folder = _unpacked.get(identity)
    if folder is None or not folder.is_dir():
        folder = Path(tempfile.mkdtemp(prefix="curvebound_ssp_"))
        atexit.register(shutil.rmtree, folder, ignore_errors=True)
        with zipfile.ZipFile(path) as archive:
            archive.extractall(folder)
        _unpacked[identity] = folder
    return folder


class _Reader:
    def __init__(self, path: Path, root: Element, structure: Structure) -> None:
        self.path = path
        self.root = root
        self.structure = structure
        self.system_inputs: dict[Port, list[Port]] = {}

    def scene(self) -> Scene:
        settings = self._settings()
        start, stop = self._times()
        scene = Scene(
            self.root.get("name", self.path.stem),
            self.root.get("description", ""),
            start_time=start,
            stop_time=stop,
            step=float(settings.get("step") or self._step(start, stop)),
            algorithm=settings.get("algorithm", "gauss_seidel"),
            hold=settings.get("hold", "zero"),
            order=settings.get("order"),
            groups=settings.get("groups"),
            loop_tolerance=settings.get("loop_tolerance"),
            tolerance=settings.get("tolerance"),
            record_every=settings.get("record_every", 1),
            adaptive=settings.get("adaptive"),
            needs=settings.get("needs"),
        )
        for name, values in settings.get("variants", {}).items():
            scene.variant(name, values)
        scene.folder = self.structure.folder
        parameters = Parameters(self.structure)
        feedthrough = settings.get("feedthrough", {})
        for name, fmu in self.structure.fmus.items():
            taken = feedthrough.get(name)
            if taken is None and fmu.outputs and fmu.undeclared.issuperset(fmu.outputs):
                taken = False
            scene.add(name, fmu.path, parameters.start[name], feedthrough=taken)
        self._connect(scene)
        self._inputs(scene)
        scene.notes = parameters.notes
        for (owner, name), kind in self.structure.kinds.items():
            if owner in self.structure.fmus and kind == "output":
                scene.record(f"{owner}.{name}")
        return scene

    def _connect(self, scene: Scene) -> None:
        """Follow each component's input through systems to the output that drives it."""
        into = {join.target: join for join in self.structure.links}
        for target in [t for t in into if t[0] in self.structure.fmus]:
            source, factor, offset, suppress = target, 1.0, 0.0, False
            tables: list[Transformation] = []
            seen = {source}
            while source in into:
                join = into[source]
                source, change = join.source, join.change
                require_new(source, seen)
                factor, offset = change.factor * factor, change.offset * factor + offset
                suppress = suppress or join.suppress
                tables += [change] if change.entries else []
            if source[0] not in self.structure.fmus:
                self.system_inputs.setdefault(source, []).append(target)
                continue
            if self.structure.kinds[target] == "parameter":
                raise ValueError(
                    f"{'.'.join(source)} sets the parameter {'.'.join(target)}; "
                    "what one component calculates cannot be a parameter of another here, "
                    "give the value instead"
                )
            self._join(scene, source, target, factor, offset, suppress, tables)

    def _join(
        self,
        scene: Scene,
        source: Port,
        target: Port,
        factor: float,
        offset: float,
        suppress: bool,
        tables: list[Transformation],
    ) -> None:
        """Connect an output with an input; units are converted before a transformation."""
        a = self.structure.fmus[source[0]].variables.get(source[1])
        b = self.structure.fmus[target[0]].variables.get(target[1])
        given: float | None = factor
        mapping = None
        if a is not None and b is not None:
            if len(tables) > 1:
                raise ValueError(
                    f"the connection from {'.'.join(source)} to {'.'.join(target)} "
                    "is mapped more than once on its way, which cannot be read"
                )
            mapping = tables[0].numbers(a, b) if tables else None
            if a.dimension and b.dimension and not suppress:
                units = conversion(a.dimension, b.dimension)
                if units is not None:
                    factor, offset = factor * units[0], offset + factor * units[1]
                    given = factor
                elif (factor, offset) == (1.0, 0.0):
                    given = None  # let the scene's check complain
        scene.connect(".".join(source), ".".join(target), given, offset, mapping)

    def _inputs(self, scene: Scene) -> None:
        table = self.structure.folder / "resources" / "inputs.csv"
        if not table.is_file():
            return
        data = read_csv(table)
        for (_, name), targets in self.system_inputs.items():
            if name in (data.dtype.names or ()):
                for target in targets:
                    scene.input(".".join(target), (data["time"], data[name]))

    # experiment

    def _settings(self) -> dict[str, Any]:
        for annotation in self.root.iter(f"{{{NAMESPACES['ssc']}}}Annotation"):
            if annotation.get("type") == ANNOTATION:
                with at("the annotation Scene"):
                    return read_settings(annotation.findtext("cvb:Scene", "{}", NAMESPACES))
        return {}

    def _times(self) -> tuple[float, float]:
        experiment = self.root.find("ssd:DefaultExperiment", NAMESPACES)
        start = stop = None
        if experiment is not None:
            start, stop = experiment.get("startTime"), experiment.get("stopTime")
        begin = number(start, "startTime of the DefaultExperiment") if start is not None else 0.0
        if stop is not None:
            return begin, number(stop, "stopTime of the DefaultExperiment")
        ends = [fmu.stop_time for fmu in self.structure.fmus.values() if fmu.stop_time is not None]
        return begin, max(ends, default=begin + 1.0)

    def _step(self, start: float, stop: float) -> float:
        fixed = self.root.find(".//osp:FixedStepAlgorithm", NAMESPACES)
        if fixed is not None and fixed.get("baseStepSize"):
            return number(fixed.get("baseStepSize"), "baseStepSize of the FixedStepAlgorithm")
        steps = [fmu.step for fmu in self.structure.fmus.values() if fmu.step]
        return min(steps, default=(stop - start) / 1000.0)

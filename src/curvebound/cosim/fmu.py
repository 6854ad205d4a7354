"""What a master must know of an FMI 2.0 co-simulation FMU, read once from its description."""

from __future__ import annotations

import atexit
import math
import shutil
import tempfile
import zipfile
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from ..errors import CurveboundError, OutsideError, at, reading, said
from ..fmi.drawing import Drawing, read
from ..units import BASE_UNITS, number
from .fmu_check import check_description, check_structure, default_initial

__all__ = [
    "Fmu",
    "Value",
    "Variable",
    "extracted",
    "loading",
    "read_fmu",
]

Value = float | int | bool | str


@dataclass(frozen=True)
class Variable:
    """A scalar variable: `kind` is the FMI type it is read and written as."""

    name: str
    reference: int
    kind: str  # Real, Integer (enumerations too), Boolean or String
    causality: str
    variability: str
    initial: str
    unit: str | None
    dimension: tuple[float, ...] | None  # exponents of BASE_UNITS, factor, offset
    start: str | None
    nominal: float | None
    minimum: str | None
    maximum: str | None
    items: dict[str, int] | None  # of an enumeration: item name to number
    description: str

    def value(self, given: Value) -> float | int | bool | str:
        """`given` as this variable's type; an enumeration also takes its item's name.

        Raises ValueError, whose text says what would be accepted.
        """
        if self.kind == "String":
            return str(given)
        text = given.strip() if isinstance(given, str) else None
        if self.items is not None:
            return self._item(given, text)
        if self.kind == "Boolean":
            if text is not None:
                if text.lower() not in ("true", "false", "1", "0"):
                    raise ValueError(f"{given!r} is not true or false")
                return text.lower() in ("true", "1")
            return bool(given)
        try:
            value = float(given) if text is None else number(text, self.unit)
        except TypeError:
            raise ValueError(f"{given!r} is not a number") from None
        if self.kind == "Integer":
            if not (abs(value) < 2.0**31 and value.is_integer()):
                raise ValueError(f"{given!r} is not an integer of 32 bits")
            return int(value)
        return value

    def _item(self, given: Value, text: str | None) -> int:
        assert self.items is not None
        if text is not None and text in self.items:
            return self.items[text]
        try:
            item = float(given)
        except (TypeError, ValueError):
            item = math.nan
        if item not in self.items.values():
            listed = ", ".join(f"{n} {name}" for name, n in self.items.items())
            raise ValueError(f"{given!r} is not one of: {listed}")
        return int(item)

    @property
    def is_settable_start(self) -> bool:
        """Whether a scene may give it a start value."""
        if self.causality == "input":
            return True
        return self.variability != "constant" and self.initial in ("exact", "approx")

    @property
    def is_drivable(self) -> bool:
        """Whether it may be set while the simulation runs: inputs and tunable parameters."""
        return self.causality == "input" or (
            self.causality == "parameter" and self.variability == "tunable"
        )


@dataclass(frozen=True)
class Fmu:
    """One FMU file and its description.

    `dependencies` maps each output to the inputs that it depends on directly (an output without
    the attribute depends on all of them, FMI 2.0.3, section 2.2.8); `undeclared` are the outputs
    without it. `initial_dependencies` is the same in initialization mode.
    takes_slopes, gives_rates, gives_changes: whether inputs may be linear in time over a step
    (with fmi2SetRealInputDerivatives), and outputs tell their derivatives, in time and by inputs.
    keeps_inputs: whether inputs stay where slopes have led them, which FMI leaves open.
    start_time, stop_time, step (s) and tolerance are those of its DefaultExperiment; `drawing` is
    that which an FMU of curvebound carries.
    """

    path: Path
    model_name: str
    description: str
    identifier: str
    guid: str
    variables: dict[str, Variable]
    dependencies: dict[str, tuple[str, ...]]
    undeclared: frozenset[str]
    initial_dependencies: dict[str, tuple[str, ...]]
    can_roll_back: bool
    can_serialize: bool
    can_vary_step: bool
    takes_slopes: bool
    keeps_inputs: bool
    gives_rates: bool
    gives_changes: bool
    only_once_per_process: bool
    start_time: float | None
    stop_time: float | None
    step: float | None
    tolerance: float | None
    drawing: Drawing | None

    @property
    def inputs(self) -> list[str]:
        """Names of the inputs, in the order of the description."""
        return [v.name for v in self.variables.values() if v.causality == "input"]

    @property
    def outputs(self) -> list[str]:
        """Names of the outputs, in the order of the description."""
        return [v.name for v in self.variables.values() if v.causality == "output"]


_read: dict[tuple[str, int, int], Fmu] = {}
_unpacked: dict[tuple[str, int, int], Path] = {}


def _identity(path: Path) -> tuple[str, int, int]:
    status = path.stat()
    return str(path.resolve()), status.st_mtime_ns, status.st_size


def read_fmu(path: Path) -> Fmu:
    """The FMU at `path`; read once in a process as long as the file stays the same.

    Raises CurveboundError when there is no such file or it is no FMI 2.0 co-simulation FMU.
    """
    if not path.is_file():
        raise CurveboundError(f"There is no FMU at {path}.")
    identity = _identity(path)
    known = _read.get(identity)
    if known is None:
        known = _read[identity] = _load(path)
    return known


def extracted(fmu: Fmu) -> Path:
    """Folder with the FMU's contents; unpacked once in a process, removed when it ends.

    One folder per file and process keeps what an FMU's wrapper leaves behind per folder (an entry
    in sys.path, say) from growing with the number of runs.
    """
    import fmpy

    with reading(f"{fmu.path} cannot be unpacked", "Get it anew."):
        identity = _identity(fmu.path)
        folder = _unpacked.get(identity)
        if folder is None or not folder.is_dir():
            folder = Path(tempfile.mkdtemp(prefix="curvebound_fmu_"))
            atexit.register(shutil.rmtree, folder, ignore_errors=True)
            fmpy.extract(str(fmu.path), str(folder))
            _unpacked[identity] = folder
        return folder


@contextmanager
def loading(fmu: Fmu) -> Iterator[None]:
    """Say of what fails in here, loading and instantiating its binary, what helps."""
    try:
        yield
    except CurveboundError:
        raise
    except Exception as error:
        cause = said(error).removeprefix("Exception: ")
        raise OutsideError(f"{fmu.path} cannot be loaded here: {cause}. {_help(cause)}") from error


def _help(cause: str) -> str:
    if "Cannot find shared library" in cause:
        return "It has no binary for this system: get one that has."
    if "failed to map segment" in cause or "Operation not permitted" in cause:
        return (
            f"What lies in {tempfile.gettempdir()} may not be run, it seems (noexec): set TMPDIR "
            "to a folder where it may."
        )
    if "instantiate" in cause or "guid" in cause.lower():
        return "Its binary is not that of its description (another GUID), it seems: get it anew."
    return "It is damaged, or needs libraries that are not here: ldd shows them."


def _load(path: Path) -> Fmu:
    with reading(f"{path} cannot be read as an FMU", "Get it anew, or ask those who made it."):
        return _described(path)


def _described(path: Path) -> Fmu:
    import fmpy

    check_structure(path)
    md = fmpy.read_model_description(str(path), validate=False)
    if md.fmiVersion != "2.0" or md.coSimulation is None:
        kinds = " and ".join(
            name
            for name, present in (
                ("co-simulation", md.coSimulation),
                ("model exchange", md.modelExchange),
            )
            if present is not None
        )
        raise CurveboundError(
            f"{path} is an FMU of FMI {md.fmiVersion} for {kinds or 'nothing'}; "
            "a scene takes FMI 2.0 co-simulation FMUs."
        )
    check_description(md)
    units = {unit.name: unit.baseUnit for unit in md.unitDefinitions}
    variables = {v.name: _variable(v, units) for v in md.modelVariables}
    inputs = tuple(v.name for v in variables.values() if v.causality == "input")

    def table(unknowns: Any) -> dict[str, tuple[str, ...] | None]:
        return {
            u.variable.name: None
            if u.dependencies is None
            else tuple(d.name for d in u.dependencies if d.causality == "input")
            for u in unknowns
        }

    declared, at_start = table(md.outputs), table(md.initialUnknowns)
    outputs = [v.name for v in variables.values() if v.causality == "output"]
    undeclared = frozenset(name for name in outputs if declared.get(name) is None)
    dependencies = {name: inputs if (of := declared.get(name)) is None else of for name in outputs}
    initial = {
        name: of if (known := at_start.get(name)) is None else known
        for name, of in dependencies.items()
    }
    experiment = md.defaultExperiment
    kind = md.coSimulation
    return Fmu(
        path=path,
        model_name=md.modelName,
        description=md.description or "",
        identifier=kind.modelIdentifier,
        guid=md.guid,
        variables=variables,
        dependencies=dependencies,
        undeclared=undeclared,
        initial_dependencies=initial,
        can_roll_back=bool(kind.canGetAndSetFMUstate),
        can_serialize=bool(kind.canSerializeFMUstate),
        can_vary_step=bool(kind.canHandleVariableCommunicationStepSize),
        takes_slopes=bool(kind.canInterpolateInputs),
        keeps_inputs=(md.generationTool or "").startswith("curvebound "),
        gives_rates=int(kind.maxOutputDerivativeOrder or 0) > 0,
        gives_changes=bool(kind.providesDirectionalDerivative),
        only_once_per_process=bool(kind.canBeInstantiatedOnlyOncePerProcess),
        start_time=_number(experiment and experiment.startTime, "startTime"),
        stop_time=_number(experiment and experiment.stopTime, "stopTime"),
        step=_number(experiment and experiment.stepSize, "stepSize"),
        tolerance=_number(experiment and experiment.tolerance, "tolerance"),
        drawing=_drawing(path),
    )


def _drawing(path: Path) -> Drawing | None:
    """The drawing in the FMU, which other tools' FMUs lack."""
    with zipfile.ZipFile(path) as archive:
        try:
            return read(archive.read("resources/drawing.json"))
        except (KeyError, CurveboundError):
            return None


def _number(text: Any, what: str) -> float | None:
    if text is None:
        return None
    with at(what):
        return float(text)


def _variable(v: Any, units: dict[str, Any]) -> Variable:
    with at(f"variable {v.name}"):
        variable = _typed(v, units)
        if variable.start is not None and variable.items is None:
            with at("its start"):
                variable.value(variable.start)
    return variable


def _typed(v: Any, units: dict[str, Any]) -> Variable:
    declared = v.declaredType
    unit = v.unit or (declared.unit if declared is not None else None)
    base = units.get(unit or "")
    dimension = None
    if base is not None:
        names = (*BASE_UNITS, "factor", "offset")
        dimension = tuple(float(getattr(base, name)) for name in names)
    items = None
    if v.type == "Enumeration" and declared is not None:
        items = {item.name: int(item.value) for item in declared.items}
    nominal = _number(v.nominal, "nominal") or _number(
        declared.nominal if declared is not None else None, "nominal"
    )
    causality = v.causality or "local"
    variability = v.variability or ("continuous" if v.type == "Real" else "discrete")
    initial = v.initial or default_initial(causality, variability)
    return Variable(
        name=v.name,
        reference=int(v.valueReference),
        kind="Integer" if v.type == "Enumeration" else str(v.type),
        causality=causality,
        variability=variability,
        initial=initial,
        unit=unit,
        dimension=dimension,
        start=v.start,
        nominal=abs(nominal) if nominal else None,
        minimum=v.min or (declared.min if declared is not None else None),
        maximum=v.max or (declared.max if declared is not None else None),
        items=items,
        description=v.description or "",
    )

"""The project's own side of the comparisons: its kernel, compiled and interpreted, and its FMUs."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from .contenders import Run, State4
from .references import DURATION, on_wire

__all__ = [
    "STATES",
    "Kernel",
    "Loaded",
    "compiled_kernel",
    "defaults",
    "interpreted_kernel",
    "leap_of_kernel",
    "method_items",
]

STATES = {
    "BeadOnWire": ("bead.x", "bead.y", "bead.vx", "bead.vy"),
    "ParabolaPendulum": (
        "slider.u",
        "pendulum.angle",
        "slider.u_rate",
        "pendulum.angular_velocity",
    ),
}


def method_items() -> dict[str, int]:
    """Names of the integration methods and their item numbers."""
    from curvebound.kernel.methods import METHODS

    return {name: item for item, name in enumerate(METHODS, start=1)}


def defaults(name: str) -> tuple[dict[str, float], dict[str, int]]:
    """Start values of the Real parameters and of the choices of an FMU."""
    from curvebound.fmi.declaration import CHOICE, COUNT_PARAMETER, PARAMETER
    from curvebound.fmi.folder import find

    variables = find(name).fmu().variables
    return (
        {v.name: float(v.start) for v in variables if v.kind == PARAMETER},
        {v.name: int(v.start) for v in variables if v.kind in (CHOICE, COUNT_PARAMETER)},
    )


@dataclass
class Kernel:
    """The kernel in one of its forms: its methods, and by FMU what picks a model by the choices."""

    create: Callable[[int], Any]
    factories: dict[str, Callable[[dict[str, int]], Any]]

    def system(self, name: str, values: Mapping[str, float]) -> Any:
        """A model of the FMU `name` at its default parameters but for `values`, started."""
        reals, choices = defaults(name)
        reals.update({key: value for key, value in values.items() if key in reals})
        choices.update({key: int(value) for key, value in values.items() if key in choices})
        model = self.factories[name](choices)
        model.start(reals, choices)
        return model

    def method(self, item: int) -> Any:
        """A new method of integration."""
        return self.create(item)


def interpreted_kernel() -> Kernel:
    """The kernel as Python runs it."""
    from curvebound.fmi.folder import find
    from curvebound.kernel.methods import create

    return Kernel(create, {name: find(name).module("kernel").model for name in STATES})


def compiled_kernel() -> Kernel:
    """The kernel as it is compiled for the FMUs; CurveboundError where it cannot."""
    from curvebound.fmi.compile import load_compiled
    from curvebound.fmi.folder import find
    from curvebound.fmi.runtime import runtime, system_sources

    factories = {}
    for name in STATES:
        core, system = load_compiled(system_sources(find(name), runtime()))
        factories[name] = system.model
    return Kernel(core.create, factories)


def _ignore(*message: object) -> None:
    """A logger that drops what it is given."""


@dataclass
class Loaded:
    """An FMU that is extracted and described, from which slaves are made."""

    name: str
    folder: Path
    description: Any = field(init=False)
    references: dict[str, int] = field(init=False)
    types: dict[str, str] = field(init=False)

    def __post_init__(self) -> None:
        from fmpy import read_model_description

        self.description = read_model_description(str(self.folder), validate=False)
        variables = self.description.modelVariables
        self.references = {v.name: v.valueReference for v in variables}
        self.types = {v.name: v.type for v in variables}

    @staticmethod
    def extract(name: str, path: Path, folder: Path) -> Loaded:
        """Extract the .fmu at `path` into the new folder `folder`."""
        from fmpy import extract

        extract(str(path), unzipdir=str(folder))
        return Loaded(name, folder)

    def slave(self, values: Mapping[str, float] | None = None) -> Any:
        """An instance as fmpy makes it, initialized with parameters `values`."""
        from fmpy.fmi1 import calloc, free
        from fmpy.fmi2 import (
            FMU2Slave,
            fmi2CallbackAllocateMemoryTYPE,
            fmi2CallbackFreeMemoryTYPE,
            fmi2CallbackFunctions,
            fmi2CallbackLoggerTYPE,
        )

        # fmpy's own logger prints, which is neither to be timed nor to be seen between tables
        callbacks = fmi2CallbackFunctions()
        callbacks.logger = fmi2CallbackLoggerTYPE(_ignore)
        callbacks.allocateMemory = fmi2CallbackAllocateMemoryTYPE(calloc)
        callbacks.freeMemory = fmi2CallbackFreeMemoryTYPE(free)
        slave = FMU2Slave(
            guid=self.description.guid,
            unzipDirectory=str(self.folder),
            modelIdentifier=self.description.coSimulation.modelIdentifier,
            instanceName=self.name,
        )
        slave.instantiate(callbacks=callbacks)
        self.begin(slave, values or {})
        return slave

    def begin(self, slave: Any, values: Mapping[str, float]) -> None:
        """Set parameters and go through initialization."""
        for key, value in values.items():
            if self.types[key] == "Real":
                slave.setReal([self.references[key]], [value])
            else:
                slave.setInteger([self.references[key]], [int(value)])
        slave.setupExperiment(startTime=0.0)
        slave.enterInitializationMode()
        slave.exitInitializationMode()

    def leap(self, slave: Any) -> Run:
        """The whole integration in one doStep."""
        wanted = [self.references[name] for name in STATES[self.name]]
        # not fmi2Reset: initialization would leave the caches to the Python interpreter
        start = slave.getFMUstate()

        def reset() -> None:
            slave.setFMUstate(start)

        def state() -> State4:
            q0, q1, v0, v1 = slave.getReal(wanted)
            return (q0, q1, v0, v1)

        return Run(reset, lambda: slave.doStep(0.0, DURATION), state)


def leap_of_kernel(kernel: Kernel, name: str, values: Mapping[str, float]) -> Run:
    """The whole integration in one advance() of the method."""
    item = int(values["solver.method"])
    step = float(values.get("solver.step", 1e-3))
    tolerance = float(values.get("solver.tolerance", 1e-6))
    count = max(1, round(DURATION / step))
    model = kernel.system(name, values)
    method = kernel.method(item)
    start = model.get_state()
    is_angle = int(values.get("model.formulation", 1)) == 2

    def reset() -> None:
        model.set_state(start)
        method.reset()

    def state() -> State4:
        if is_angle:
            return on_wire(model.q0, model.v0)
        return (model.q0, model.q1, model.v0, model.v1)

    return Run(reset, lambda: method.advance(model, DURATION, count, tolerance, 10**9), state)

"""One run of a scene with one method and step, and what became of it."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from types import TracebackType
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ...cosim.fmu import Value
from ...cosim.prepared import Prepared
from ...cosim.results import Result, RunFailed
from ...cosim.scene import Scene
from ...cosim.system import port_of
from ...errors import CurveboundError, nearest
from ..reference.equations import system_of
from ..reference.motion import Motion
from . import theory

__all__ = ["ACCURATE", "FAILED", "INACCURATE", "UNKNOWN", "UNSTABLE", "Probe", "Probed"]

ACCURATE, INACCURATE, UNSTABLE, FAILED, UNKNOWN = (
    "accurate", "inaccurate", "unstable", "failed", "unknown",
)  # fmt: skip
#: parts of a run at whose ends the exact motion is known
PARTS = 240
#: communication steps in parts: divisors, so that any internal step is met to about 1 %
_CUTS = [k for k in range(1, 41) if PARTS % k == 0]
_CLOSE = 0.004
#: internal steps in a communication step, at most
MOST_STEPS = 400_000
#: an energy wrong by this many times what is at stake, or an output this many times its largest
#: exact value, has grown where it must not; less is what symplectic methods show short of their end
GROWN = 10.0
#: residual of the exact run, over the energy at stake, beyond which it is not trusted
TRUSTED = 1e-6
_REFERENCE: dict[str, Value] = {"solver.method": "adaptive", "solver.tolerance": 1e-11}


@dataclass(frozen=True)
class Probed:
    """What became of a run.

    error: largest of the judged outputs relative to its largest exact value. energy: largest
    residual over the energy at stake in the exact run. message: of a failure.
    """

    kind: str
    error: float = math.nan
    energy: float = math.nan
    message: str = ""


class Probe:
    """A scene, loaded, whose plant is run again and again. A context manager.

    path: component.variable that varies. accuracy: largest relative error called accurate. A run
    is unstable when its energy is wrong by more than GROWN times what is at stake in the exact
    motion, or a judged output exceeds GROWN times its exact size. Raises CurveboundError for a
    scene without such a plant, or a path that is none of its Real start values.
    """

    def __init__(self, scene: Scene, path: str, *, accuracy: float) -> None:
        scene = scene.copy()
        name, self.variable = port_of(path)
        system = scene.check()
        plants = {k: n for k, n in system.nodes.items() if "solver.method" in n.fmu.variables}
        node = plants.get(name)
        if node is None:
            raise CurveboundError(
                f"--vary {path}: {name} is no plant of the scene {scene.name}; vary a parameter "
                f"of {' or '.join(plants) or 'one that has solver.method'}."
            )
        known = [
            v.name
            for v in node.fmu.variables.values()
            if v.is_settable_start and v.kind == "Real" and v.items is None
        ]
        own = ("solver.step", "solver.tolerance")
        if self.variable not in known or self.variable in own:
            raise CurveboundError(
                f"--vary {path}: {self.variable} is no start value of {name} that a map can vary; "
                + nearest(self.variable, [k for k in known if k not in own])
            )
        self.path, self.plant, self.accuracy = path, name, accuracy
        self.unit = node.fmu.variables[self.variable].unit or ""
        self.model = node.fmu.model_name
        self.start = scene.start_time
        self.duration = scene.stop_time - scene.start_time
        self.alone = len(scene.components) == 1
        try:
            carried = system_of(node.fmu)
        except CurveboundError:
            carried = None  # an FMU of another house: judged by what the scene needs
        main = carried.main if carried is not None else ()
        self.derived = carried.derived if carried is not None else None
        wanted = [v for of, v in map(port_of, scene.needs.errors) if of == name]
        self.judged = [f"{name}.{v}" for v in (main or wanted)]
        if not self.judged:
            raise CurveboundError(f"The scene {scene.name} does not say which outputs it needs.")
        scene.recorded = []
        scene.adaptive = None
        scene.record_every = 1
        self.energies = [f"{name}.energy.{v}" for v in ("kinetic", "potential", "residual")]
        motion = (self.derived.coordinates, self.derived.rates) if self.derived else ()
        self.states = [f"{name}.{v}" for part in motion for v in part]
        scene.record(*dict.fromkeys([*self.judged, *self.energies, *self.states]))
        self._macro = scene.step
        of = node.fmu.variables
        self._values: dict[str, Any] = {
            k: float(of[k].value(node.start.get(k, of[k].start or 0.0))) for k in known
        }
        fidelity = of.get("model.fidelity")
        if fidelity is not None and fidelity.items is not None:
            number = int(fidelity.value(node.start.get("model.fidelity", fidelity.start or 2)))
            self._values["model.fidelity"] = next(
                item for item, n in fidelity.items.items() if n == number
            )
        self._reference: tuple[Any, Result | None, str] | None = None
        self._prepared: Prepared = scene.prepare()

    def __enter__(self) -> Probe:
        return self

    def __exit__(
        self,
        kind: type[BaseException] | None,
        value: BaseException | None,
        traceback: TracebackType | None,
    ) -> None:
        self.close()

    def close(self) -> None:
        """Unload the FMUs."""
        self._prepared.close()

    def run(self, value: Value, method: str, size: float) -> Probed:
        """The verdict of a method at a value of the parameter.

        size: internal step in s; tolerance of adaptive. A plant alone communicates as often as the
        steps allow, at most PARTS times; in a coupled scene the macro step is the scene's own, or
        the multiple of it that first holds an internal step.
        """
        reference, why = self._exact(value)
        if reference is None:
            return Probed(UNKNOWN, message=why)
        settings: dict[str, Value] = {"solver.method": method}
        every = 1
        if method == "adaptive":
            settings["solver.tolerance"] = size
        else:
            every, count = self._cut(size)
            settings["solver.step"] = every * self._part / count
        try:
            result = self._try(value, every, settings)
        except RunFailed as failure:
            return Probed(FAILED, message=failure.cause)
        rows = slice(0, every * (len(result.time) - 1) + 1, every)
        error = growth = 0.0
        for name in self.judged:
            exact = reference[name][rows]
            largest = float(np.abs(exact).max())
            if largest > 0.0:
                error = max(error, float(np.abs(result[name] - exact).max()) / largest)
            # an angle may well make another turn
            largest = max(largest, 2.0 * math.pi) if name.endswith("angle") else largest
            grown = float(np.abs(result[name]).max())
            growth = max(growth, grown / largest if largest > 0.0 else 0.0)
        energy = self._imbalance(result, reference)
        if not (energy <= GROWN and growth <= GROWN):
            return Probed(UNSTABLE, error, energy)
        return Probed(ACCURATE if error <= self.accuracy else INACCURATE, error, energy)

    def linear_boundaries(
        self, value: Value, method: str, least: float, most: float
    ) -> tuple[float, float]:
        """Theoretical boundaries (s): at rest, and the smallest along the exact motion.

        NaN where there is none: an unknown model, or a method without a boundary.
        """
        values = {**self._values, self.variable: value}
        derived = self.derived
        if not self.alone or derived is None or method not in theory.LIMITED:
            return math.nan, math.nan
        inputs = {v.name: 0.0 for v in derived.variables if v.kind == "input"}
        try:
            motion = Motion(derived, {**inputs, **values})
        except (ArithmeticError, ValueError):
            return math.nan, math.nan  # outside the domain, as every run says
        reference, _ = self._exact(value)
        rest = theory.jacobians(motion, np.zeros((4, 1)))
        moving: Sequence[NDArray[Any]] = []
        if reference is not None:
            columns = [reference[name] for name in self.states]
            n = len(columns) // 2
            still = [np.zeros_like(columns[0])] * (2 - n)
            states = np.stack([*columns[:n], *still, *columns[n:], *still])
            moving = [a for a in theory.jacobians(motion, states) if theory.swings(a)]

        def smallest(matrices: Sequence[NDArray[Any]]) -> float:
            found = math.inf if matrices else math.nan
            for a in matrices:
                if found > 0.0:  # only what is below the smallest so far is searched
                    end = theory.boundary(method, a, self.duration, least, min(found, most))
                    found = min(found, end)
            return found

        return smallest(rest), smallest(moving)

    @property
    def _part(self) -> float:
        return self.duration / PARTS if self.alone else self._macro

    def _cut(self, step: float) -> tuple[int, int]:
        """Parts in a communication step, and internal steps in it."""
        part = self._part
        if not self.alone:
            if step <= part:
                return 1, max(1, math.ceil(part / step * (1.0 - 1e-9)))
            return math.ceil(step / part * (1.0 - 1e-9)), 1
        best, least = (1, 1), math.inf
        for k in _CUTS:
            n = max(1, round(k * part / step))
            off = abs(k * part / (n * step) - 1.0)
            if off < least - 1e-12:
                best, least = (k, n), off
            if off <= _CLOSE:
                break
        return best

    def _try(self, value: Value, every: int, settings: Mapping[str, Value]) -> Result:
        start = {f"{self.plant}.{name}": v for name, v in settings.items()}
        start[f"{self.plant}.solver.max_steps"] = MOST_STEPS
        start[self.path] = value
        macro = every * self._part
        count = math.floor(self.duration / macro * (1.0 + 1e-9))
        return self._prepared.run(start, stop_time=self.start + max(count, 1) * macro, step=macro)

    def _exact(self, value: Value) -> tuple[Result | None, str]:
        """The exact run, or why there is none; kept until value or duration change."""
        key = (float(value), self.duration)
        if self._reference is None or self._reference[0] != key:
            found: Result | None = None
            why = ""
            try:
                found = self._try(value, 1, _REFERENCE)
            except RunFailed as failure:
                why = f"the reference fails: {failure.cause}"
            else:
                if not self._imbalance(found, found) <= TRUSTED:
                    found, why = None, "the reference does not keep its energy balance"
            self._reference = (key, found, why)
        return self._reference[1:]

    def _imbalance(self, result: Result, reference: Result) -> float:
        """The largest residual of a run over the energy at stake in the exact one."""
        kinetic, potential = (reference[name] for name in self.energies[:2])
        at_stake = float(np.abs(kinetic).max() + np.ptp(potential))
        residual = float(np.abs(result[self.energies[2]]).max())
        return residual / at_stake if at_stake > 0.0 else residual

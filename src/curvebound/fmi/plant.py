"""The engine of a mechanical model: communication steps by a time-integration method."""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import Final

from ..kernel.base import MOST_INPUTS, Model, check_start
from ..kernel.directional import output_changes
from ..kernel.method import (
    DONE,
    NOT_CONVERGED,
    NOT_FINITE,
    STEP_TOO_SMALL,
    TOO_MANY_STEPS,
    Method,
)
from ..kernel.methods import METHODS, create
from ..kernel.ramp import Ramp
from ..kernel.rates import OutputRates
from .cutting import substeps
from .derivatives import DerivativeEngine
from .engine import Engine, System
from .table import LARGEST, RATE, WARNING, Table
from .watch import ENERGY_FRACTION, MAGNIFIED

__all__ = ["Plant", "PlantEngine"]

#: steps that may be advised, and how many more than seem needed
_MANY: Final = 1e9
_AMPLE: Final = 1.5
_EXACT: Final = METHODS.index("exact") + 1
#: of an error until the end of a run whose stop time the importer does not tell
_UNKNOWN_GROWTH: Final = 3.0


class PlantEngine(DerivativeEngine):
    """A mechanical model with a time-integration method."""

    def __init__(self, table: Table, guid: str, factory: Callable[[dict[str, int]], Model]) -> None:
        self.factory = factory
        self.model: Model = Model()
        self.method: Method = Method()
        self.ramp: Ramp = Ramp()
        self.motion: OutputRates = OutputRates(self.model)
        self.step: float = 0.0
        self.relative: float = 0.0
        self.max_steps: int = 0
        self.look_at_drift: bool = False
        self.look_at_linear: bool = False
        # what undo() restores
        self.kept_steps: int = 0
        self.kept_evaluations: int = 0
        super().__init__(table, guid)

    def start_system(self, reals: dict[str, float], choices: dict[str, int]) -> str:
        model: Model = self.factory(choices)
        if model.input_count > MOST_INPUTS:
            return f"there are {model.input_count} inputs: a system has at most {MOST_INPUTS}"
        item = choices["solver.method"]
        if item == _EXACT and not model.is_linear:
            return (
                f"solver.method = {item} (exact) needs a linear model, whose solution is known: "
                f"{model.remedy('linear')}choose another solver.method such as 4 (adaptive)"
            )
        try:
            model.start(reals, choices)
            check_start(model, reals)
        except ValueError as error:
            return str(error)
        self.model = model
        self.method = create(item)
        self.step = reals["solver.step"]
        self.relative = reals["solver.tolerance"]
        self.max_steps = choices["solver.max_steps"]
        self.motion = OutputRates(model)
        self.grouped(model.OUTPUTS, model.FEEDTHROUGH)
        self.look_at_drift = "constraint.drift" in model.OUTPUTS
        self.look_at_linear = model.is_linear
        return (
            "" if self.finite() else "the initial state is not finite: choose smaller start values"
        )

    def take_inputs(self) -> None:
        model = self.model
        for i in range(model.input_count):
            model.inputs[i] = self.reals[self.first_input + i]
        model.hold_inputs()

    def observe(self, group: int) -> None:
        self.model.observe(group, self.reals, self.table.first_output)

    def find_rates(self, group: int) -> None:
        if self.fresh < RATE:
            self.motion.begin()
        self.motion.find(group, self.slopes.each, self.rates, self.table.first_output)

    def has_changes(self) -> bool:
        return self.model.AFFINE

    def output_changes(self, seeds: list[float]) -> list[float]:
        try:
            return output_changes(self.model, seeds)
        except (ZeroDivisionError, OverflowError, ValueError):
            self.take_inputs()
            return [math.inf] * len(self.model.OUTPUTS)

    def count_of(self, vr: int) -> int:
        return self.method.steps if vr == self.table.first_count else self.method.evaluations

    def finite(self) -> bool:
        """Whether state and work are finite and small enough to be squared."""
        m = self.model
        return (
            -LARGEST < m.q0 < LARGEST
            and -LARGEST < m.q1 < LARGEST
            and -LARGEST < m.v0 < LARGEST
            and -LARGEST < m.v1 < LARGEST
            and -LARGEST < m.work < LARGEST
        )

    def advance(self, duration: float) -> str:
        model = self.model
        method = self.method
        count = 1.0
        if not method.CHOOSES_STEP:
            count = substeps(duration, self.step, self.time)
            if count > self.max_steps:
                return self.explain(TOO_MANY_STEPS, duration / count, duration)
        elif not model.is_constant and method.ORDER == 0:
            return self.varying(model)
        self.kept_steps = method.steps
        self.kept_evaluations = method.evaluations
        model.keep()
        method.keep()
        self.kept = True
        moving = model
        try:
            if self.slopes.given and method.MOVES:
                model.begin_rise(self.slopes.each)
            elif self.slopes.given:
                moving = self.ramp
                self.ramp.begin(model, self.slopes.each, duration)
                if method.ORDER == 0 and self.ramp.varies():
                    message = self.varying(self.ramp)
                    self.undo()
                    return message
            failure = method.advance(moving, duration, int(count), self.relative, self.max_steps)
            if failure == DONE:
                if model.rises and method.MOVES:
                    model.end_rise(duration)
                elif model.rises:
                    self.ramp.end()
                else:
                    model.advance_frame(duration)
                if self.finite():
                    return ""
                failure = NOT_FINITE
        except (ZeroDivisionError, OverflowError, ValueError):
            failure = NOT_FINITE
        by_method = method.CHOOSES_STEP or failure != NOT_FINITE
        message = self.explain(failure, method.reached if by_method else duration / count, duration)
        self.undo()
        return message

    def varying(self, model: Model) -> str:
        """The message for `exact` with coefficients that vary."""
        return (
            f"solver.method = {_EXACT} (exact) needs constant coefficients, but "
            f"{model.variation()} at time {self.time!r} s: choose another solver.method such "
            "as 4 (adaptive), or keep them constant"
        )

    def undo(self) -> None:
        if self.slopes.given:
            self.take_inputs()
        self.model.undo()
        self.method.steps = self.kept_steps
        self.method.evaluations = self.kept_evaluations
        self.method.undo()

    def output(self, name: str) -> float:
        """An output by name, brought up to date."""
        vr = self.table.by_name[name]
        group = self.layout.groups[vr]
        if not self.fresh >> group & 1:
            queued = len(self.queue)
            self.refresh(group)
            if len(self.queue) > queued:
                # one does not fit a float: that fails a reading, where it is said, but not a step
                del self.queue[queued:]
                self.fresh &= ~(1 << group)
        return self.reals[vr]

    def look(self, at_end: bool) -> None:
        watch = self.watch
        steps = self.method.steps
        if not watch.due(steps) and not (at_end and steps > watch.seen):
            return
        if not watch.said_energy:
            self.look_at_energy()
        said = ""
        if self.look_at_drift and not watch.said_drift:
            model = self.model
            drift = self.output("constraint.drift")
            said = watch.drift(drift, model.q0_scale, model.remedy("drift"), self.time)
            if said:
                self.say(WARNING, said)
        if self.look_at_linear and not watch.said_linear:
            error = self.output("model.acceleration_error")
            said = watch.linear(error, self.model.remedy("nonlinear"), self.time)
            if said:
                self.say(WARNING, said)
        if self.method.ORDER > 0 and self.method.CHOOSES_STEP:
            tolerance, setting, time = self.relative, self.tolerance_name(), self.time
            model = self.model
            doubt = max(self.method.doubt(), MAGNIFIED * model.magnification)
            said = watch.rounding(doubt, tolerance, setting, model.remedy("rounding"), time)
            if said:
                self.say(WARNING, said)
            said = watch.growth(self.method.loss(), tolerance, setting, time)
            if said:
                self.say(WARNING, said)

    def look_at_energy(self) -> None:
        """Warn of a balance of energy that does not hold."""
        watch = self.watch
        model = self.model
        kinetic = max(self.output("energy.kinetic"), model.initial_kinetic)
        change = self.output("energy.potential") - model.initial_potential
        watch.moved = max(watch.moved, abs(kinetic), abs(change))
        residual = self.output("energy.residual")
        if abs(residual) <= ENERGY_FRACTION * watch.moved:
            return
        # a communication point at a turning point shows little of what moves between them
        watch.moved = max(watch.moved, self.swing())
        model.balance(0.0)
        if not watch.exceeds(residual, model.balance_size):
            return
        by_step = not self.method.CHOOSES_STEP
        elapsed = self.time - self.begin
        run = self.end - self.begin
        said = watch.energy(
            residual,
            max(1.0, run / elapsed) if elapsed > 0.0 and run < LARGEST else _UNKNOWN_GROWTH,
            self.method.ORDER if by_step else 1,
            "solver.step" if by_step else self.tolerance_name(),
            self.step if by_step else self.relative,
            self.time,
        )
        if said:
            self.say(WARNING, said)

    def swing(self) -> float:
        """Kinetic energy (J) that the present forces would give, starting at rest.

        They act for as long as they take to change, as the accelerations' Jacobian and the natural
        magnitudes of the coordinates tell.
        """
        model = self.model
        q0, q1, v0, v1 = model.q0, model.q1, model.v0, model.v1
        try:
            model.acceleration(0.0, q0, q1, 0.0, 0.0)
            a0 = model.a0
            a1 = model.a1
            model.jacobian(0.0, q0, q1, v0, v1)
            squared = abs(model.a0_q0) + abs(model.a1_q1)
            squared += abs(a0) / model.q0_scale + abs(a1) / model.q1_scale
            rate = math.sqrt(squared) + abs(model.a0_v0) + abs(model.a1_v1)
            if rate == 0.0:
                return 0.0
            model.v0 = model.v1 = 0.0
            model.balance(0.0)
            at_rest = model.balance_energy
            model.v0 = a0 / rate
            model.v1 = a1 / rate
            model.balance(0.0)
            swing = model.balance_energy - at_rest
        except (ZeroDivisionError, OverflowError, ValueError, NotImplementedError):
            swing = 0.0
        model.v0 = v0
        model.v1 = v1
        return swing if swing < LARGEST else 0.0

    def tolerance_name(self) -> str:
        """What sets the tolerance."""
        return "tolerance (fmi2SetupExperiment)" if self.tolerance_defined else "solver.tolerance"

    def explain(self, failure: int, reached: float, duration: float) -> str:
        """The message of a failed step: what, where and what to do."""
        where = f" at time {self.time!r} s in a communication step of {duration!r} s"
        if failure == TOO_MANY_STEPS:
            size = self.tolerance_name() if self.method.CHOOSES_STEP else "solver.step"
            passed = self.method.passed if self.method.CHOOSES_STEP else reached * self.max_steps
            needed = self.max_steps * duration / passed if passed > 0.0 else math.inf
            more = f" (to {_AMPLE * needed:.0e})" if needed < _MANY else ""
            return (
                f"solver.max_steps = {self.max_steps} internal steps do not reach the end{where}, "
                f"but {passed:.3g} s of it; the step size reached is {reached!r} s: "
                f"raise solver.max_steps{more} or {size}, or shorten the communication step"
            )
        if failure == STEP_TOO_SMALL:
            return (
                f"{self.tolerance_name()} = {self.relative!r} asks for an internal step of "
                f"{reached!r} s, below the resolution of time{where}: raise it"
            )
        if failure == NOT_CONVERGED:
            return (
                f"solver.method = implicit: the Newton iteration does not converge{where}, or not "
                "to what keeps the balance of energy, even with an internal step of "
                f"{reached!r} s: reduce solver.step, or choose solver.method = adaptive"
            )
        m = self.model
        size = f" with internal steps of {reached!r} s" if reached > 0.0 else ""
        remedy = "use smaller parameters, start values or inputs"
        if not self.method.CHOOSES_STEP:
            remedy = "reduce solver.step, or choose solver.method = adaptive"
        return (
            f"the state left the finite numbers{where}{size} "
            f"(coordinates {m.q0!r}, {m.q1!r}, rates {m.v0!r}, {m.v1!r}): {remedy}"
        )

    def system_state(self) -> list[list[float]]:
        counters = [float(self.method.steps), float(self.method.evaluations)]
        return [self.model.get_state(), counters, self.method.get_state()]

    def restore_system(self, state: list[list[float]]) -> None:
        if not self.bad_value():
            self.take_inputs()
        self.model.set_state(state[0])
        self.method.steps = int(state[1][0])
        self.method.evaluations = int(state[1][1])
        self.method.set_state(state[2])


class Plant(System):
    """Engines of a mechanical model; `factory` picks the model from the choices."""

    def __init__(self, factory: Callable[[dict[str, int]], Model]) -> None:
        self.factory = factory

    def create(self, table: Table, guid: str) -> Engine:
        return PlantEngine(table, guid, self.factory)

"""What runs inside an FMU between the FMI calls: values, modes, time and the communication step.

Compiled together with the kernel. The FMU's binary calls most methods of an Engine directly; none
of them raises, but for what interrupts interpreted code from outside (KeyboardInterrupt). A failure
leaves one message in `queue` with status error; it and an interrupt leave the state as it was
before the call.
"""

from __future__ import annotations

import math
from typing import Final

from ..kernel.base import MOST_VARIABLES, Values
from .cutting import begins, refusal
from .input_slopes import NO_SLOPE, InputSlopes
from .table import (
    ERROR,
    INPUT,
    LARGEST,
    NOT_REAL,
    OUTPUT,
    OVERFLOW,
    PARAMETER,
    RATE,
    Layout,
    Message,
    Table,
)
from .watch import Watch

__all__ = ["Engine", "System"]

# modes
INSTANTIATED: Final = 0
INITIALIZATION: Final = 1
STEPPING: Final = 2
TERMINATED: Final = 3
_MODES: Final = ("instantiated", "initialization", "stepping", "terminated")


class Engine:
    """Values, modes and time of one instance; subclasses know what advances."""

    def __init__(self, table: Table, guid: str) -> None:
        self.table = table
        self.guid = guid
        self.queue: list[Message] = []
        self.reset()

    def reset(self) -> None:
        """Back to the state after instantiation."""
        table = self.table
        self.mode: int = INSTANTIATED
        self.time: float = 0.0
        #: s, the experiment's start and stop; infinity where the latter is not defined
        self.begin: float = 0.0
        self.end: float = math.inf
        self.reals: Values = [0.0] * MOST_VARIABLES
        for vr in range(table.size):
            self.reals[vr] = table.starts[vr]
        self.integers: list[int] = [int(x) for x in table.starts]
        self.first_input: int = table.first_input
        #: of the inputs, over the next step
        self.slopes: InputSlopes = InputSlopes(table)
        #: whether inputs or tunable parameters wait to be taken over by the system
        self.pending: bool = True
        #: whether parameters have changed since the system was started from them
        self.stale: bool = True
        #: whether there is a system, of these parameters
        self.started: bool = False
        #: the tolerance of fmi2SetupExperiment, or 0 when it is not defined
        self.tolerance: float = 0.0
        self.tolerance_defined: bool = False
        #: whether tunable parameters are among what waits
        self.retuned: bool = False
        #: the groups of the outputs
        self.layout: Layout = table.layouts[0]
        #: what is up to date, what depends on inputs; bits as in table.RATES
        self.fresh: int = 0
        self.feedthrough: int = 0
        self.watch: Watch = Watch()
        #: whether undo() can take back what advance() has done
        self.kept: bool = False

    # -- messages ----------------------------------------------------------------------------------
    def say(self, status: int, text: str) -> None:
        """Queue a log message."""
        category = "logStatusError" if status == ERROR else "logStatusWarning"
        self.queue.append(Message(status, category, text))

    def fail(self, text: str) -> bool:
        """Queue an error message; returns False."""
        self.say(ERROR, text)
        return False

    def value(self, vr: int) -> str:
        """A variable with value and unit, for messages."""
        return self.table.shown(vr, self.reals[vr], self.integers[vr])

    # -- what subclasses know ----------------------------------------------------------------------
    def start_system(self, reals: dict[str, float], choices: dict[str, int]) -> str:
        """Start the system from its parameters; returns a message where that is impossible."""
        raise NotImplementedError

    def take_inputs(self) -> None:
        """Hand the inputs, all finite, and the tunable parameters to the system."""
        raise NotImplementedError

    def observe(self, group: int) -> None:
        """Compute the outputs of a group into `reals`."""
        raise NotImplementedError

    def advance(self, duration: float) -> str:
        """Advance the system; after a failure undo it and return the message.

        Where `slopes` are given, inputs rise by them, and the system is left with those of the end.
        """
        raise NotImplementedError

    def undo(self) -> None:
        """Return to the state before advance(), which has been interrupted or taken back."""
        raise NotImplementedError

    def look(self, at_end: bool) -> None:
        """Warn of what the live error measures say, where a look is due or the run ends."""

    def has_changes(self) -> bool:
        """Whether there is an output_changes(); of a started system."""
        raise NotImplementedError

    def count_of(self, vr: int) -> int:
        """A count, by value reference."""
        return 0

    def system_state(self) -> list[list[float]]:
        """The changing part of the system's state."""
        raise NotImplementedError

    def restore_system(self, state: list[list[float]]) -> None:
        """Return to a system_state()."""
        raise NotImplementedError

    def dependencies(self) -> list[list[int]]:
        """For each variable, the inputs on which it depends within the same instant."""
        table = self.table
        self.start()
        inputs = list(range(table.first_input, table.first_output))
        found: list[list[int]] = []
        for vr in range(table.size):
            group: int = self.layout.groups[vr]
            found.append(inputs if group >= 0 and self.feedthrough >> group & 1 else [])
        return found

    # -- life cycle --------------------------------------------------------------------------------
    def setup_experiment(
        self, start_time: float, stop_time: float | None = None, tolerance: float | None = None
    ) -> bool:
        """Take start time, tolerance, and the stop time, which only advice depends on."""
        if self.mode != INSTANTIATED:
            return self.out_of_order("fmi2SetupExperiment", "before initialization")
        if not math.isfinite(start_time):
            return self.fail(
                f"startTime = {start_time!r} s is not finite: give a finite start time"
            )
        self.time = self.begin = start_time
        self.end = math.inf if stop_time is None else stop_time
        self.tolerance_defined = tolerance is not None
        self.tolerance = 0.0 if tolerance is None else tolerance
        return True

    def out_of_order(self, call: str, when: str) -> bool:
        """A call that the present mode does not allow."""
        return self.fail(
            f"{call} is not allowed in mode {_MODES[self.mode]}: call it {when}, or fmi2Reset first"
        )

    def enter_initialization(self) -> bool:
        """Check the parameters and start from them."""
        if self.mode != INSTANTIATED:
            return self.out_of_order("fmi2EnterInitializationMode", "after instantiation")
        message = self.start()
        if message:
            return self.fail(message)
        self.mode = INITIALIZATION
        return True

    def exit_initialization(self) -> bool:
        """Start from what was set in the meantime."""
        if self.mode != INITIALIZATION:
            return self.out_of_order(
                "fmi2ExitInitializationMode", "after fmi2EnterInitializationMode"
            )
        message = self.start() if self.stale else ""
        if not message:
            message = self.bad_value()
        if message:
            return self.fail(message)
        self.mode = STEPPING
        self.look(False)
        return True

    def terminate(self) -> bool:
        """End stepping; values stay readable."""
        if self.mode != STEPPING:
            return self.out_of_order("fmi2Terminate", "after initialization")
        self.look(True)
        self.mode = TERMINATED
        return True

    def start(self, restoring: bool = False) -> str:
        """Check every parameter and start the system; returns a message if something is wrong.

        `restoring` a state, tunable parameters are left to the check before the next step.
        """
        self.started = False
        for vr in range(self.table.first_input):
            message = "" if restoring and self.table.tunable[vr] else self.outside_domain(vr)
            if message:
                return message
        reals, choices = self.parameters()
        if self.tolerance_defined:
            if not (0.0 < self.tolerance < math.inf):
                return (
                    f"tolerance = {self.tolerance!r} of fmi2SetupExperiment is outside its domain: "
                    "give a finite tolerance above zero, or leave it undefined"
                )
            reals["solver.tolerance"] = self.tolerance
        try:
            message = self.start_system(reals, choices)
        except (ZeroDivisionError, OverflowError, ValueError) as error:
            message = (
                f"the parameters leave the range of floating-point numbers ({error}): "
                "use values that are neither so small nor so large"
            )
        if message:
            return message
        self.started = True
        self.stale = False
        self.pending = True
        self.fresh = 0
        return ""

    def parameters(self) -> tuple[dict[str, float], dict[str, int]]:
        """Real parameters, and enumeration and Integer ones, by name."""
        table = self.table
        reals: dict[str, float] = {}
        choices: dict[str, int] = {}
        for vr in range(table.first_input):
            if table.kinds[vr] == PARAMETER:
                reals[table.names[vr]] = self.reals[vr]
            else:
                choices[table.names[vr]] = self.integers[vr]
        return reals, choices

    def outside_domain(self, vr: int) -> str:
        """The message for a parameter outside its domain, or ''."""
        return self.table.outside_domain(vr, self.reals[vr], self.integers[vr])

    def bad_value(self) -> str:
        """The message for an input or tunable parameter that cannot be used, or ''."""
        table = self.table
        for vr in range(table.first_input, table.first_output):
            x: float = self.reals[vr]
            if not abs(x) <= LARGEST:
                return (
                    f"{self.value(vr)} cannot be used: set input {table.names[vr]} to a finite "
                    f"number, at most {LARGEST!r} in size"
                )
        if self.retuned:
            for vr in range(table.first_input):
                if table.tunable[vr]:
                    message = self.outside_domain(vr)
                    if message:
                        return message
        return ""

    # -- values ------------------------------------------------------------------------------------
    def get_real(self, vrs: list[int]) -> list[float]:
        """Values of Real variables."""
        values: list[float] = []
        vr: int
        for vr in vrs:
            values.append(self.real(vr))
        return values

    def real(self, vr: int) -> float:
        """The value of a Real variable; outputs are computed when first read after a change."""
        group: int = self.layout.groups[vr] if 0 <= vr < self.table.size else NOT_REAL
        if group >= 0:
            if not self.fresh >> group & 1:
                self.refresh(group)
        elif group == NOT_REAL:
            self.unknown(vr, "Real")
            return 0.0
        return self.reals[vr]

    def refresh(self, group: int) -> None:
        """Bring a group of outputs up to date; where that is impossible they keep their values."""
        if not self.ready():
            return
        members: list[int] = self.layout.members[group]
        vr: int
        try:
            if group == self.layout.counts:
                for vr in members:
                    self.reals[vr] = float(self.count_of(vr))
            else:
                self.observe(group)
        except (ZeroDivisionError, OverflowError, ValueError):
            vr = members[0]
            self.reals[vr] = math.inf
        for vr in members:
            x: float = self.reals[vr]
            if not -OVERFLOW <= x <= OVERFLOW:
                self.reals[vr] = -OVERFLOW if x < 0.0 else OVERFLOW
                self.fail(
                    f"{self.table.names[vr]} does not fit a floating-point number at time "
                    f"{self.time!r} s: rescale the parameters, or reduce solver.step"
                )
        self.fresh |= 1 << group

    def grouped(self, outputs: dict[str, int], feedthrough: tuple[int, ...]) -> None:
        """Take over the groups of the system's outputs."""
        self.layout = self.table.layout(outputs)
        self.fresh = 0
        self.feedthrough = RATE * (RATE - 1)
        for group in feedthrough:
            self.feedthrough |= 1 << group

    def set_real(self, vrs: list[int], values: list[float]) -> None:
        """Set parameters or inputs."""
        for i in range(len(vrs)):
            self.take_real(vrs[i], values[i])

    def take_real(self, vr: int, value: float) -> None:
        """Set a parameter or an input."""
        self.fresh &= ~self.feedthrough
        table = self.table
        if vr < 0 or vr >= table.size or not table.is_real(vr):
            self.unknown(vr, "Real")
        elif table.kinds[vr] == INPUT:
            self.pending = True
            self.reals[vr] = value
        elif self.may_set(vr):
            self.fresh = 0
            if self.mode == STEPPING:
                self.pending = True
                self.retuned = True
            else:
                self.stale = True
            self.reals[vr] = value

    def may_set(self, vr: int) -> bool:
        """Whether a parameter may be set now; says why not."""
        name = self.table.names[vr]
        if self.table.kinds[vr] >= OUTPUT:
            return self.fail(f"{name} is an output and cannot be set: set an input or a parameter")
        if self.mode < STEPPING or self.table.tunable[vr]:
            return True
        return self.fail(
            f"{name} is a fixed parameter and cannot be set in mode {_MODES[self.mode]}: "
            "set it before initialization ends"
        )

    def unknown(self, vr: int, type_: str) -> None:
        """A value reference that does not belong to a variable of the type."""
        self.fail(self.table.wrong_type(vr, type_))

    def ready(self) -> bool:
        """Bring the system up to date with parameters and inputs; whether that is possible."""
        if self.mode == INSTANTIATED:
            return False
        if self.mode == INITIALIZATION and self.stale and self.start():
            return False
        if self.pending and not self.bad_value():
            self.take_inputs()
            self.pending = False
        return True

    def get_integer(self, vrs: list[int]) -> list[int]:
        """Values of Integer and enumeration variables."""
        values: list[int] = []
        vr: int
        for vr in vrs:
            if vr < 0 or vr >= self.table.size or self.table.is_real(vr):
                self.unknown(vr, "Integer")
                values.append(0)
            else:
                values.append(self.integers[vr])
        return values

    def set_integer(self, vrs: list[int], values: list[int]) -> None:
        """Set Integer and enumeration parameters."""
        for i in range(len(vrs)):
            vr: int = vrs[i]
            if vr < 0 or vr >= self.table.size or self.table.is_real(vr):
                self.unknown(vr, "Integer")
            elif self.may_set(vr):
                self.fresh = 0
                self.stale = self.mode < STEPPING
                self.retuned = True
                self.pending = True
                self.integers[vr] = values[i]

    # -- stepping ----------------------------------------------------------------------------------
    def do_step(self, current_time: float, step_size: float) -> bool:
        """One communication step; False and one error message where it fails."""
        if self.mode != STEPPING:
            return self.out_of_order("fmi2DoStep", "between initialization and termination")
        now = self.time
        if not begins(current_time, step_size, now):
            return self.fail(refusal(current_time, step_size, now))
        if self.pending:
            message = self.bad_value()
            if message:
                return self.fail(message)
            self.take_inputs()
            self.pending = False
        sloped = self.slopes.given
        if sloped:
            vr = self.slopes.begin(self.reals, step_size)
            if vr != NO_SLOPE:
                return self.fail(
                    f"{self.value(vr)} cannot be used with its derivative "
                    f"{self.slopes.each[vr - self.first_input]!r} per s over a communication "
                    f"step of {step_size!r} s: set finite numbers with which the input stays at "
                    f"most {LARGEST!r} in size"
                )
        self.kept = False
        try:
            message = self.advance(step_size)
            if message:
                return self.fail(message)
            self.time = current_time + step_size
            self.fresh = 0
            if sloped:
                self.slopes.end(self.reals, step_size)
            self.look(False)
        except BaseException:  # an interrupt: there has been no step
            if sloped:
                self.slopes.restore(self.reals)
            if self.kept:
                self.undo()
            self.time = now
            self.fresh = 0
            raise
        return True

    # -- saved states ------------------------------------------------------------------------------
    def get_state(self) -> list[list[float]]:
        """All that changes, as lists of floats; the first holds mode, time and tolerance."""
        table = self.table
        head = [
            float(self.mode),
            self.time,
            1.0 if self.tolerance_defined else 0.0,
            self.tolerance,
            1.0 if self.stale else 0.0,
        ]
        state = [head, [self.reals[vr] for vr in range(table.first_output)]]
        state.append([float(i) for i in self.integers[: table.first_input]])
        state.append(self.slopes.get_state())
        if self.mode != INSTANTIATED and self.started:
            state.extend(self.system_state())
        return state

    def set_state(self, state: list[list[float]]) -> None:
        """Return to a get_state() of an instance of the same FMU."""
        table = self.table
        head = state[0]
        parameters = state[1][: table.first_input]
        integers = [int(x) for x in state[2]]
        mode = int(head[0])
        same = (
            self.mode != INSTANTIATED
            and not self.stale
            and [self.reals[vr] for vr in range(table.first_input)] == parameters
            and self.integers[: table.first_input] == integers
            and self.tolerance == head[3]
        )
        self.mode = mode
        self.time = head[1]
        self.tolerance_defined = head[2] != 0.0
        self.tolerance = head[3]
        for vr in range(table.first_output):
            self.reals[vr] = state[1][vr]
        self.integers[: table.first_input] = integers
        self.slopes.set_state(state[3])
        # Parameters set during initialization may have made a start impossible: then there is no
        # system to restore either, and the end of initialization will say so.
        if mode != INSTANTIATED and (same or not self.start(restoring=True)) and len(state) > 4:
            self.restore_system(state[4:])
        self.stale = head[4] != 0.0
        self.pending = True
        self.retuned = True
        self.fresh = 0


class System:
    """Makes the engines of an FMU's instances."""

    def create(self, table: Table, guid: str) -> Engine:
        """A new engine for the variables of `table`."""
        raise NotImplementedError

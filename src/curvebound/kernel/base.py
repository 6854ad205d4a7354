"""What every mechanical system of the kernel offers to the integrators and to the FMI face.

A model has one or two generalised coordinates q0, q1 with rates v0, v1 and obeys

    q'' = acceleration(t, q, v),        work' = power(t, q, v, q'')

State components are separate floats, not lists: mypyc keeps floats and tuples of floats unboxed, so
that an internal step allocates nothing. A model of one degree of freedom leaves q1 = v1 = 0.
"""

from __future__ import annotations

import math
from typing import Annotated, ClassVar, Final

__all__ = [
    *("ALIKE", "MOST_INPUTS", "MOST_VARIABLES", "Inputs", "Model", "Values"),
    *("acceleration_of", "check_start", "jacobian_of"),
]

#: of one model
MOST_INPUTS: Final = 32
#: of a communication step, by which times differ that are meant to be the same
ALIKE: Final = 4e-16
Inputs = Annotated[list[float], MOST_INPUTS]
#: of one FMU
MOST_VARIABLES: Final = 512
Values = Annotated[list[float], MOST_VARIABLES]


class Model:
    """A system q'' = f(t, q, v) with at most two degrees of freedom.

    Time in every method is counted from the start of the present communication step; inputs are
    constant over it (ramp.Ramp makes them linear in time). Subclasses declare the names of their
    variables, in the order in which values are passed, exactly as the FMU shows them:

    PARAMETERS  names of the Real parameters, CHOICES names of the enumeration parameters
    INPUTS      names of the Real inputs
    OUTPUTS     names of the Real outputs, mapped to their group: those of a group are computed
                together, and only when one of them is read
    FEEDTHROUGH the groups whose values depend on the inputs of the same instant
    AFFINE      whether they, model.acceleration_error apart, and the accelerations are affine in
                the inputs
    """

    PARAMETERS: ClassVar[tuple[str, ...]] = ()
    CHOICES: ClassVar[tuple[str, ...]] = ()
    INPUTS: ClassVar[tuple[str, ...]] = ()
    OUTPUTS: ClassVar[dict[str, int]] = {}
    FEEDTHROUGH: ClassVar[tuple[int, ...]] = ()
    AFFINE: ClassVar[bool] = True

    def __init__(self) -> None:
        self.q0: float = 0.0
        self.q1: float = 0.0
        self.v0: float = 0.0
        self.v1: float = 0.0
        self.input_count: int = len(self.INPUTS)
        #: inputs at the communication point, in the order of INPUTS, and slopes: for take_inputs()
        self.inputs: Inputs = [0.0] * MOST_INPUTS
        self.slopes: Inputs = [0.0] * MOST_INPUTS
        #: whether inputs rise, and the time (s) since then to which move() has brought the model
        self.rises: bool = False
        self.moved: float = 0.0
        #: the inputs, while find_terms() puts others there
        self.present: Inputs = [0.0] * MOST_INPUTS
        #: J, net work since the start: by drive and inputs, less what damping dissipated
        self.work: float = 0.0
        #: J, energies at the start: by them it is known how much has moved since
        self.initial_kinetic: float = 0.0
        self.initial_potential: float = 0.0
        #: result of acceleration()
        self.a0: float = 0.0
        self.a1: float = 0.0
        #: result of jacobian(): a0_q1 is d(a0)/d(q1)
        self.a0_q0: float = 0.0
        self.a0_q1: float = 0.0
        self.a1_q0: float = 0.0
        self.a1_q1: float = 0.0
        self.a0_v0: float = 0.0
        self.a0_v1: float = 0.0
        self.a1_v0: float = 0.0
        self.a1_v1: float = 0.0
        #: result of compare()
        self.linear0: float = 0.0
        self.linear1: float = 0.0
        self.full0: float = 0.0
        self.full1: float = 0.0
        #: J, result of balance(): energy less `work`, and the size of its parts
        self.balance_energy: float = 0.0
        self.balance_size: float = 1.0
        #: natural magnitudes of q0 and q1, for warnings
        self.q0_scale: float = 1.0
        self.q1_scale: float = 1.0
        #: by how much the motion can magnify errors before anything of it shows, where that is
        #: known: so much closer the steps of `adaptive` and the balance of `implicit` are held
        self.magnification: float = 1.0
        #: whether power() can differ from zero with the present parameters, inputs and frame motion
        self.works: bool = False
        #: whether acceleration() reads v0 and v1, with the present parameters and inputs
        self.uses_rates: bool = True
        #: whether settle() has anything to do after an internal step
        self.settles: bool = False
        #: whether the equations are linear, as `exact` needs
        self.is_linear: bool = False
        #: whether their coefficients are constant over the present communication step
        self.is_constant: bool = True

    # -- set-up ------------------------------------------------------------------------------------
    def start(self, parameters: dict[str, float], choices: dict[str, int]) -> None:
        """Take parameters (SI units) and choices (item numbers) and return to the initial state.

        Domains of single parameters have been checked; raises ValueError, with a message that names
        variable, value and remedy, for a combination that makes no sense.
        """
        raise NotImplementedError

    def set_inputs(self, values: list[float], first: int) -> None:
        """Take the inputs values[first:first + len(INPUTS)], all finite, in the order of INPUTS."""
        for i in range(self.input_count):
            self.inputs[i] = values[first + i]
        self.hold_inputs()

    def hold_inputs(self) -> None:
        """Take over `inputs`, without slopes."""
        if self.rises:
            self.drop_slopes()
        self.take_inputs(0.0)
        self.refresh()

    def drop_slopes(self) -> None:
        """Let no input rise any more."""
        self.rises = False
        for i in range(self.input_count):
            self.slopes[i] = 0.0

    def begin_rise(self, slopes: Inputs) -> None:
        """From the communication point on, keep() called, inputs rise by `slopes` (1/s).

        Equations and energies are then asked for time 0, after move() to their time.
        """
        from_zero = False
        for i in range(self.input_count):
            slope = slopes[i]
            self.slopes[i] = slope
            if slope != 0.0 and self.inputs[i] == 0.0:
                from_zero = True
        self.rises = True
        self.moved = 0.0
        if from_zero:
            self.find_terms()

    def find_terms(self) -> None:
        """Let terms count that are off at the communication point alone, where inputs are zero."""
        for i in range(self.input_count):
            self.present[i] = self.inputs[i]
            if self.present[i] == 0.0:
                self.inputs[i] = self.slopes[i]
        self.take_inputs(0.0)
        self.refresh()
        for i in range(self.input_count):
            self.inputs[i] = self.present[i]
        self.move(0.0)

    def move(self, t: float) -> None:
        """Bring what inputs and frame act by to t s after the communication point."""
        self.moved = t
        self.take_inputs(t)
        self.move_frame(t)
        self.refresh_values()

    def end_rise(self, duration: float) -> None:
        """At the end of a communication step, with the inputs of that time."""
        self.take_inputs(duration)
        self.advance_frame(duration)
        for i in range(self.input_count):
            self.inputs[i] += duration * self.slopes[i]
        self.hold_inputs()

    def take_inputs(self, t: float) -> None:
        """Take over `inputs` as `slopes` have led them in t s: inputs[i] + t * slopes[i].

        And of `slopes` those of the accelerations that move the frame.
        """

    def refresh(self) -> None:
        """Bring what is derived from state, frame and inputs up to date."""

    def refresh_values(self) -> None:
        """The same after a move(): which terms are off is what it was in begin_rise().

        Then an input that rises was not zero. A model that has less to do than refresh() says so.
        """
        self.refresh()

    # -- equations ---------------------------------------------------------------------------------
    def acceleration(self, t: float, q0: float, q1: float, v0: float, v1: float) -> None:
        """Set a0, a1 to q'' at time t (s) since the communication point."""
        raise NotImplementedError

    def power(
        self, t: float, q0: float, q1: float, v0: float, v1: float, a0: float, a1: float
    ) -> float:
        """W, rate of `work` for a motion with acceleration (a0, a1)."""
        raise NotImplementedError

    def jacobian(self, t: float, q0: float, q1: float, v0: float, v1: float) -> None:
        """What acceleration() sets, and a0_q0 ... a1_v1: its derivatives in closed form."""
        raise NotImplementedError

    def balance(self, t: float) -> None:
        """Set balance_energy and balance_size, t s after the communication point.

        balance_energy is constant for the exact motion. A model without one is never held to it.
        """

    def linear_system(self) -> list[list[float]]:
        """A, shape (5, 5), with z' = A z for z = (q0, q1, v0, v1, 1); only if is_linear.

        Constant over a communication step (inputs included). Ramp's z has the time in it, too.
        """
        raise NotImplementedError

    def separation(self) -> tuple[list[list[float]], list[list[float]], list[list[float]]]:
        """(A, T, T^-1), (5, 5) each: linear_system() for coordinates y = T z; empty: for z itself.

        Such that modes of very different rates do not cancel in A, whose rounding the slow ones
        would feel.
        """
        return [], [], []

    def power_form(self) -> list[list[float]]:
        """C, symmetric, (5, 5): power = z C z with z of linear_system(); only if is_linear."""
        raise NotImplementedError

    def remedy(self, trouble: str) -> str:
        """What to change, in the words of this model's variables, against `trouble`.

        "linear" (exact was chosen for a nonlinear model; ends in ", or " unless empty),
        "nonlinear" (a linear model beyond its range), "drift" (of the constraint), "rounding" (that
        the motion magnifies; ends in ", or " unless empty).
        """
        return ""

    def variation(self) -> str:
        """Which variables, with their values, make the coefficients vary; for not is_constant."""
        return ""

    # -- hooks of the time stepping ----------------------------------------------------------------
    def settle(self, h: float) -> None:
        """After an accepted internal step of h seconds, when `settles`: projection, turns."""

    def advance_frame(self, duration: float) -> None:
        """At the end of a communication step: move_frame(), refresh(), and whole turns."""

    def move_frame(self, t: float) -> None:
        """Bring the frame to where it is t s after keep(), exactly: a polynomial of time.

        The inputs are those of that time.
        """

    # -- rollback and saved state ------------------------------------------------------------------
    def get_state(self) -> list[float]:
        """Everything that changes while running (state, frame, work, counters), finite floats."""
        raise NotImplementedError

    def set_state(self, state: list[float]) -> None:
        """Return to what get_state() gave, on an instance started with the same parameters."""
        raise NotImplementedError

    def keep(self) -> None:
        """Remember the present state, cheaply, for one undo()."""
        raise NotImplementedError

    def undo(self) -> None:
        """Return to the state that keep() remembered."""
        raise NotImplementedError

    # -- observation -------------------------------------------------------------------------------
    def observe(self, group: int, values: Values, first: int) -> None:
        """Write the outputs of one group to values[first + position in OUTPUTS]."""
        raise NotImplementedError

    def compare(self) -> None:
        """Set linear0, linear1, full0, full1: the accelerations of the present state.

        By the linear and by the whole equations, both as those of masses (m/s2), in a linear model;
        in others there is nothing to compare.
        """

    def acceleration_error(self) -> float:
        """Relative difference between linear and nonlinear accelerations of the present state."""
        self.compare()
        # the larger of the two as the measure: finite wherever one of them is not at rest
        size = max(
            math.hypot(self.linear0, self.linear1),
            math.hypot(self.full0, self.full1),
        )
        if size == 0.0:
            return 0.0
        return math.hypot(self.linear0 - self.full0, self.linear1 - self.full1) / size


def acceleration_of(
    model: Model, t: float, q0: float, q1: float, v0: float, v1: float
) -> tuple[float, float]:
    """(a0, a1) of a model, for those who have no need of speed."""
    model.acceleration(t, q0, q1, v0, v1)
    return model.a0, model.a1


def check_start(model: Model, parameters: dict[str, float]) -> None:
    """Raise ValueError where a model that has started has no acceleration there."""
    try:
        model.acceleration(0.0, model.q0, model.q1, model.v0, model.v1)
    except ZeroDivisionError:
        model.take_inputs(0.0)
        model.refresh()  # of a kernel that leaves it to the first inputs
        try:
            model.acceleration(0.0, model.q0, model.q1, model.v0, model.v1)
        except ZeroDivisionError as error:
            starts = [f"{n} = {x!r}" for n, x in parameters.items() if n.endswith("_start")]
            raise ValueError(
                f"there is no acceleration at the start, {', '.join(starts)} (division by zero): "
                "there a coordinate moves no mass, or a position or force is infinite; choose "
                "another start value, and in fmu.py ranges without this one"
            ) from error


def jacobian_of(
    model: Model, t: float, q0: float, q1: float, v0: float, v1: float
) -> tuple[float, float, float, float, float, float, float, float]:
    """d(a0)/d(q0, q1), d(a1)/d(q0, q1), then both by (v0, v1), likewise."""
    model.jacobian(t, q0, q1, v0, v1)
    # fmt: off
    return (
        model.a0_q0, model.a0_q1, model.a1_q0, model.a1_q1,
        model.a0_v0, model.a0_v1, model.a1_v0, model.a1_v1,
    )
    # fmt: on

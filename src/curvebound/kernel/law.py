"""What every control law offers to the FMI face."""

from __future__ import annotations

from typing import ClassVar

from .base import Inputs, Values

__all__ = ["Law"]


class Law:
    """A control law: outputs from inputs and time, without equations of motion.

    Names are declared as in Model. Time is absolute here (s).
    """

    PARAMETERS: ClassVar[tuple[str, ...]] = ()
    CHOICES: ClassVar[tuple[str, ...]] = ()
    INPUTS: ClassVar[tuple[str, ...]] = ()
    OUTPUTS: ClassVar[dict[str, int]] = {}
    FEEDTHROUGH: ClassVar[tuple[int, ...]] = ()
    #: whether there is an output_changes()
    HAS_CHANGES: ClassVar[bool] = False

    def start(self, parameters: dict[str, float], choices: dict[str, int], time: float) -> None:
        """Take parameters and choices and start at `time`."""
        raise NotImplementedError

    def set_parameters(self, parameters: dict[str, float], choices: dict[str, int]) -> None:
        """Take changed tunable parameters: from the next communication point or sample on."""
        raise NotImplementedError

    def set_inputs(self, values: Values, first: int) -> None:
        """Take the inputs values[first:first + len(INPUTS)], all finite, in the order of INPUTS."""
        raise NotImplementedError

    def advance(self, time: float, duration: float, slopes: Inputs) -> None:
        """Make the communication step from `time`, over which inputs rise by `slopes` (1/s).

        Inputs are set anew before anything else is asked.
        """
        raise NotImplementedError

    def late(self, time: float, duration: float) -> str:
        """What acts late since it lies within the communication step from `time`, or ''.

        Names the variable, the time it was meant for, and the communication step that would do.
        """
        return ""

    def observe(self, group: int, values: Values, first: int) -> None:
        """Write the outputs of one group to values[first + position in OUTPUTS]."""
        raise NotImplementedError

    def output_changes(self, seeds: list[float]) -> list[float]:
        """Derivatives of all outputs along `seeds` of the inputs, within the same instant."""
        raise NotImplementedError

    def find_rates(self, group: int, slopes: Inputs, rates: Values, first: int) -> None:
        """Write the time derivatives of the outputs of one group, as observe() does their values.

        From the present time on, inputs rising by `slopes`.
        """
        raise NotImplementedError

    def get_state(self) -> list[float]:
        """Everything that changes while running, finite floats."""
        raise NotImplementedError

    def set_state(self, state: list[float]) -> None:
        """Return to what get_state() gave."""
        raise NotImplementedError

    def keep(self) -> None:
        """Remember the present state, cheaply, for one undo()."""
        raise NotImplementedError

    def undo(self) -> None:
        """Return to the state that keep() remembered."""
        raise NotImplementedError

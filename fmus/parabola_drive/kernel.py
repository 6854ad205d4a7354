"""The control law that drives the parabola: waveform plus state feedback, limited and sampled.

    parabola.ax = clip(-K (measurement - reference) + waveform, limit)

Outputs are held between samples where a sample period is given.
"""

from __future__ import annotations

import math
from typing import ClassVar, Final

from curvebound.kernel.base import Inputs, Values
from curvebound.kernel.law import Law

from .waveform import WHOLE, chirp_cycles, chirp_frequency, wave, wave_rate

__all__ = ["ParabolaDrive", "law"]

NO_WAVEFORM: Final = 1
SINE: Final = 2
CHIRP: Final = 3
STEP: Final = 4

X: Final = 1
Y: Final = 2
COEFFICIENT: Final = 3

#: A communication point this near to a multiple of the period, relative to it or to time itself, is
#: that multiple: masters that add up their steps arrive a little early or late.
PERIOD_SLACK: Final = 1e-6
TIME_SLACK: Final = 1e-14
#: as much may be missing from waveform.start_time, relative to it
START_SLACK: Final = 1e-12
#: part of a waveform's period that is short enough to hold its value
FINE: Final = 0.02
#: 2^-600: a gain and a measurement with this factor each have a product that fits a float
SMALL: Final = 2.409919865102884e-181


class ParabolaDrive(Law):
    """Waveform plus state feedback, with the variables of the FMU ParabolaDrive.

    Without a sample period the outputs follow inputs and time directly. With a period T they are
    computed at the communication points k T and, from the inputs held there, at each k T inside a
    communication step; in between they keep their value. The start counts as a sample.

    Inputs and parameters are no part of the saved state.
    """

    PARAMETERS: ClassVar[tuple[str, ...]] = (
        "feedback.slider_u",
        "feedback.slider_u_rate",
        "feedback.pendulum_angle",
        "feedback.pendulum_angular_velocity",
        "feedback.parabola_x",
        "feedback.parabola_vx",
        "reference.pendulum_angle",
        "reference.parabola_x",
        "waveform.amplitude",
        "waveform.frequency",
        "waveform.phase",
        "waveform.start_time",
        "waveform.end_frequency",
        "waveform.duration",
        "limit.acceleration",
        "sample.period",
    )
    CHOICES: ClassVar[tuple[str, ...]] = ("waveform.kind", "waveform.axis")
    INPUTS: ClassVar[tuple[str, ...]] = (
        "slider.u",
        "slider.u_rate",
        "pendulum.angle",
        "pendulum.angular_velocity",
        "parabola.x",
        "parabola.vx",
    )
    OUTPUTS: ClassVar[dict[str, int]] = {
        "parabola.ax": 0,
        "parabola.ay": 1,
        "parabola.coefficient_acceleration": 1,
    }
    FEEDTHROUGH: ClassVar[tuple[int, ...]] = (0,)
    HAS_CHANGES: ClassVar[bool] = True

    def __init__(self) -> None:
        # gains, m/s2 per unit of the measurement
        self.k_u: float = 0.0
        self.k_u_rate: float = 0.0
        self.k_angle: float = 0.0
        self.k_rate: float = 0.0
        self.k_x: float = 0.0
        self.k_vx: float = 0.0
        self.angle_reference: float = 0.0
        self.x_reference: float = 0.0
        self.kind: int = NO_WAVEFORM
        self.axis: int = X
        self.amplitude: float = 0.0
        self.frequency: float = 0.0
        self.phase: float = 0.0
        self.start_time: float = 0.0
        self.end_frequency: float = 0.0
        self.duration: float = 1.0
        self.limit: float = 0.0
        self.period: float = 0.0
        # measurements
        self.u: float = 0.0
        self.u_rate: float = 0.0
        self.angle: float = 0.0
        self.rate: float = 0.0
        self.x: float = 0.0
        self.vx: float = 0.0
        #: s, the present communication point
        self.time: float = 0.0
        #: whether no step has been made yet
        self.at_start: bool = True
        # held outputs
        self.ax: float = 0.0
        self.ay: float = 0.0
        self.coefficient: float = 0.0
        self.kept_time: float = 0.0
        self.kept_ax: float = 0.0
        self.kept_ay: float = 0.0
        self.kept_coefficient: float = 0.0
        self.kept_start: bool = True

    def start(self, parameters: dict[str, float], choices: dict[str, int], time: float) -> None:
        """Take parameters (SI units) and choices (item numbers) and begin at `time` (s)."""
        self.period = parameters["sample.period"]
        self.set_parameters(parameters, choices)
        self.u = self.u_rate = self.angle = self.rate = self.x = self.vx = 0.0
        self.ax = self.ay = self.coefficient = 0.0
        self.time = time
        self.at_start = True

    def set_parameters(self, parameters: dict[str, float], choices: dict[str, int]) -> None:
        """Take the tunable parameters and choices: all but sample.period."""
        self.k_u = parameters["feedback.slider_u"]
        self.k_u_rate = parameters["feedback.slider_u_rate"]
        self.k_angle = parameters["feedback.pendulum_angle"]
        self.k_rate = parameters["feedback.pendulum_angular_velocity"]
        self.k_x = parameters["feedback.parabola_x"]
        self.k_vx = parameters["feedback.parabola_vx"]
        self.angle_reference = parameters["reference.pendulum_angle"]
        self.x_reference = parameters["reference.parabola_x"]
        self.amplitude = parameters["waveform.amplitude"]
        self.frequency = parameters["waveform.frequency"]
        self.phase = parameters["waveform.phase"]
        self.start_time = parameters["waveform.start_time"]
        self.end_frequency = parameters["waveform.end_frequency"]
        self.duration = parameters["waveform.duration"]
        self.limit = parameters["limit.acceleration"]
        self.kind = choices["waveform.kind"]
        self.axis = choices["waveform.axis"]

    def set_inputs(self, values: Values, first: int) -> None:
        """Take the measurements values[first:first + 6], all finite, in the order of INPUTS."""
        self.u = values[first]
        self.u_rate = values[first + 1]
        self.angle = values[first + 2]
        self.rate = values[first + 3]
        self.x = values[first + 4]
        self.vx = values[first + 5]

    # -- the law ---------------------------------------------------------------------------------
    def elapsed(self, time: float) -> float:
        """Time (s) since the waveform's start, below zero before it."""
        elapsed = time - self.start_time
        if -START_SLACK * math.fabs(self.start_time) <= elapsed < 0.0:
            return 0.0
        return elapsed

    def cycles(self, elapsed: float) -> float:
        """Cycles of sine or chirp in that time."""
        if self.kind == CHIRP:
            return chirp_cycles(elapsed, self.frequency, self.end_frequency, self.duration)
        return self.frequency * elapsed

    def waveform(self, time: float) -> float:
        """The waveform at `time` (s), in the unit of its axis."""
        elapsed = self.elapsed(time)
        if self.kind == NO_WAVEFORM or elapsed < 0.0:
            return 0.0
        if self.kind == STEP:
            return self.amplitude
        return self.amplitude * wave(self.cycles(elapsed), self.phase)

    def waveform_rate(self, axis: int) -> float:
        """Its time derivative in the output of an axis, from the present time on."""
        if self.axis != axis or self.period != 0.0:
            return 0.0
        elapsed = self.elapsed(self.time)
        frequency = self.present_frequency(elapsed)
        return self.amplitude * wave_rate(self.cycles(elapsed), self.phase, frequency)

    def feedback(self, scale: float) -> float:
        """-K (measurement - reference), gains and measurements multiplied by `scale` each."""
        return -(
            (scale * self.k_u) * (scale * self.u)
            + (scale * self.k_u_rate) * (scale * self.u_rate)
            + (scale * self.k_angle) * (scale * self.angle - scale * self.angle_reference)
            + (scale * self.k_rate) * (scale * self.rate)
            + (scale * self.k_x) * (scale * self.x - scale * self.x_reference)
            + (scale * self.k_vx) * (scale * self.vx)
        )

    def controlled(self, time: float) -> float:
        """parabola.ax (m/s2) from the present inputs."""
        ax = self.feedback(1.0)
        if ax - ax != 0.0:
            ax = self.feedback(SMALL) / SMALL / SMALL
        if self.axis == X:
            ax += self.waveform(time)
        limit = self.limit
        if ax > limit:
            return limit
        if ax < -limit:
            return -limit
        return ax

    def prescribed(self, time: float) -> tuple[float, float]:
        """parabola.ay (m/s2) and parabola.coefficient_acceleration (1/(m s2))."""
        if self.axis == Y:
            return self.waveform(time), 0.0
        if self.axis == COEFFICIENT:
            return 0.0, self.waveform(time)
        return 0.0, 0.0

    def sample_time(self) -> float:
        """The time (s) for which the present outputs are computed, NaN where they are held."""
        time = self.time
        period = self.period
        if period == 0.0 or math.fabs(time / period) >= WHOLE:
            return time
        sample = period * float(math.floor(time / period + 0.5))
        if math.fabs(time - sample) <= PERIOD_SLACK * period + TIME_SLACK * math.fabs(time):
            return sample
        return time if self.at_start else math.nan

    def advance(self, time: float, duration: float, slopes: Inputs) -> None:
        """Go from the communication point `time` to time + duration (s), sampling on the way."""
        self.time = time
        period = self.period
        slack = PERIOD_SLACK * period + TIME_SLACK * (math.fabs(time) + duration)
        end = time + duration - slack
        # a period that time cannot resolve makes every communication point a sample
        if period != 0.0 and math.fabs(end / period) < WHOLE:
            # the last multiple of the period before the end; any after `time` hide that at `time`
            sample = period * (float(math.ceil(end / period)) - 1.0)
            if sample <= time + slack:
                sample = self.sample_time()
            if sample == sample:
                self.go_on(sample - time, slopes)
                self.ax = self.controlled(sample)
                self.ay, self.coefficient = self.prescribed(sample)
        self.time = time + duration
        self.at_start = False

    def go_on(self, duration: float, slopes: Inputs) -> None:
        """Bring the measurements to what they are after `duration` (s)."""
        self.u += duration * slopes[0]
        self.u_rate += duration * slopes[1]
        self.angle += duration * slopes[2]
        self.rate += duration * slopes[3]
        self.x += duration * slopes[4]
        self.vx += duration * slopes[5]

    def late(self, time: float, duration: float) -> str:
        slack = PERIOD_SLACK * duration + TIME_SLACK * (math.fabs(time) + duration)
        period = self.period
        if period != 0.0 and self.acts():
            within = (time + duration - slack) / period
            if math.fabs(within) < WHOLE:
                sample = period * (float(math.floor((time + slack) / period)) + 1.0)
                if sample < time + duration - slack:
                    fits = period / float(math.ceil((1.0 - PERIOD_SLACK) * period / duration))
                    return (
                        f"sample.period = {period:.6g} s has its sample at {sample:.9g} s within a "
                        f"communication step, {duration:.6g} s from {time:.9g} s on: it takes the "
                        "measurements of the step's start, carried on by their slopes if they have "
                        "any, and acts from its end on; communication steps of "
                        f"{fits:.12g} s would meet every sample"
                    )
        elif self.kind == STEP and time + slack < self.start_time < time + duration - slack:
            return (
                f"waveform.start_time = {self.start_time:.9g} s lies within a communication step, "
                f"{duration:.6g} s from {time:.9g} s on: the waveform steps at its end; end a "
                f"communication step at {self.start_time:.9g} s"
            )
        held = max(duration, period)
        frequency = math.fabs(self.present_frequency(self.elapsed(time)))
        if frequency * held > 0.5:
            return (
                f"the waveform's frequency, {frequency:.6g} Hz at {time:.9g} s, is above half the "
                f"rate at which its values are held, {held:.6g} s each, and comes out as another; "
                f"communication steps (and sample.period) of {FINE / frequency:.3g} s would follow"
            )
        return ""

    def present_frequency(self, elapsed: float) -> float:
        """Frequency (Hz) that long (s) after the waveform's start, 0 where there is none."""
        if elapsed < 0.0 or self.kind not in (SINE, CHIRP):
            return 0.0
        if self.kind == SINE:
            return self.frequency
        return chirp_frequency(elapsed, self.frequency, self.end_frequency, self.duration)

    def acts(self) -> bool:
        """Whether any output can vary."""
        return self.kind != NO_WAVEFORM or any(k != 0.0 for k in self.gains())

    def gains(self) -> list[float]:
        """K, in the order of INPUTS."""
        return [self.k_u, self.k_u_rate, self.k_angle, self.k_rate, self.k_x, self.k_vx]

    # -- rollback and saved state ----------------------------------------------------------------
    def get_state(self) -> list[float]:
        """Everything that changes while running, finite floats."""
        return [self.time, self.ax, self.ay, self.coefficient, 1.0 if self.at_start else 0.0]

    def set_state(self, state: list[float]) -> None:
        """Return to what get_state() gave, on an instance started with the same parameters."""
        if len(state) != 5:
            raise ValueError(
                f"the saved state has {len(state)} numbers where 5 belong: "
                "it was not written by ParabolaDrive; pass one that it wrote"
            )
        self.time = state[0]
        self.ax = state[1]
        self.ay = state[2]
        self.coefficient = state[3]
        self.at_start = state[4] != 0.0

    def keep(self) -> None:
        """Remember the present state, cheaply, for one undo()."""
        self.kept_time = self.time
        self.kept_ax = self.ax
        self.kept_ay = self.ay
        self.kept_coefficient = self.coefficient
        self.kept_start = self.at_start

    def undo(self) -> None:
        """Return to the state that keep() remembered."""
        self.time = self.kept_time
        self.ax = self.kept_ax
        self.ay = self.kept_ay
        self.coefficient = self.kept_coefficient
        self.at_start = self.kept_start

    # -- observation -----------------------------------------------------------------------------
    def observe(self, group: int, values: Values, first: int) -> None:
        """Write the outputs of one group to values[first + position in OUTPUTS]."""
        sample = self.sample_time()
        held = sample != sample
        if group == 0:
            values[first] = self.ax if held else self.controlled(sample)
        elif held:
            values[first + 1] = self.ay
            values[first + 2] = self.coefficient
        else:
            values[first + 1], values[first + 2] = self.prescribed(sample)

    def output_changes(self, seeds: list[float]) -> list[float]:
        sample = self.sample_time()
        if sample != sample or math.fabs(self.controlled(sample)) >= self.limit:
            return [0.0, 0.0, 0.0]
        changes = [0.0, 0.0, 0.0]
        for k, seed in zip(self.gains(), seeds, strict=True):
            changes[0] -= k * seed
        return changes

    def find_rates(self, group: int, slopes: Inputs, rates: Values, first: int) -> None:
        if group == 1:
            rates[first + 1] = self.waveform_rate(Y)
            rates[first + 2] = self.waveform_rate(COEFFICIENT)
        elif self.period != 0.0 or math.fabs(self.controlled(self.time)) >= self.limit:
            rates[first] = 0.0
        else:
            rates[first] = (
                self.waveform_rate(X)
                - self.k_u * slopes[0]
                - self.k_u_rate * slopes[1]
                - self.k_angle * slopes[2]
                - self.k_rate * slopes[3]
                - self.k_x * slopes[4]
                - self.k_vx * slopes[5]
            )


def law() -> ParabolaDrive:
    """The drive."""
    return ParabolaDrive()

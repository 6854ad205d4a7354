"""The law of the drive in extended precision, for references: kernel.py's, over arrays."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np

from curvebound.study.reference.equations import Array, Equations, Inputs, Number

_TURN = 2 * np.arctan2(Number(0), Number(-1))
_MEASURED = (
    "slider.u",
    "slider.u_rate",
    "pendulum.angle",
    "pendulum.angular_velocity",
    "parabola.x",
    "parabola.vx",
)


class Law(Equations):
    """parabola.ax = clip(-K (measurement - reference) + waveform); no state."""

    DESIGNED_FOR = ("parabola.coefficient_start",)

    def __init__(self, parameters: Mapping[str, Any]) -> None:
        super().__init__(parameters)
        self.gains = {name: parameters["feedback." + name.replace(".", "_")] for name in _MEASURED}
        self.reference = {
            "pendulum.angle": parameters["reference.pendulum_angle"],
            "parabola.x": parameters["reference.parabola_x"],
        }
        self.kind = parameters["waveform.kind"]

    def period(self) -> float:
        return float(np.ravel(self.parameters["sample.period"])[0])

    def breaks(self) -> list[float]:
        p = self.parameters
        begin = float(np.ravel(p["waveform.start_time"])[0])
        if self.kind == "none":
            return []
        if self.kind == "chirp":
            return [begin, begin + float(np.ravel(p["waveform.duration"])[0])]
        return [begin]

    def set_points(self) -> dict[str, float]:
        if not any(np.any(gain != 0) for gain in self.gains.values()):
            return {}
        return {
            name: float(np.ravel(self.reference.get(name, Number(0)))[0]) for name in self.gains
        }

    def waveform(self, time: Array) -> Array:
        """In the unit of the waveform's axis."""
        p = self.parameters
        begin = p["waveform.start_time"]
        elapsed = time - begin
        if self.kind == "none":
            return np.zeros_like(elapsed)
        size, frequency = p["waveform.amplitude"], p["waveform.frequency"]
        if self.kind == "step":
            value = size + np.zeros_like(elapsed)
        else:
            cycles = frequency * elapsed
            if self.kind == "chirp":
                length, last = p["waveform.duration"], p["waveform.end_frequency"]
                sweeping = np.minimum(elapsed, length)
                cycles = sweeping * (frequency + (last - frequency) * sweeping / (2 * length))
                cycles = cycles + last * (elapsed - sweeping)
            value = size * np.sin(_TURN * cycles + p["waveform.phase"])
        # a communication point may miss the start by rounding
        wave: Array = np.where(elapsed < -1e-12 * np.abs(begin), Number(0), value)
        return wave

    def outputs(
        self, names: Sequence[str], time: Array, state: Sequence[Array], inputs: Inputs
    ) -> dict[str, Array]:
        wave = self.waveform(time)
        axis = self.parameters["waveform.axis"]
        zero = np.zeros_like(wave)
        out = {
            "parabola.ay": wave if axis == "y" else zero,
            "parabola.coefficient_acceleration": wave if axis == "coefficient" else zero,
        }
        if "parabola.ax" in names:
            ax = wave if axis == "x" else zero
            for name, gain in self.gains.items():
                if np.any(gain != 0):
                    ax = ax - gain * (inputs[name] - self.reference.get(name, Number(0)))
            limit = self.parameters["limit.acceleration"]
            out["parabola.ax"] = np.clip(ax, -limit, limit)
        return {name: out[name] for name in names}


EQUATIONS = Law

"""Warnings while running: what the live error measures say, once each.

A plant is looked at after its 16th, 32nd and then every 64th communication step, so that the
outputs which this needs cost next to nothing.
"""

from __future__ import annotations

from typing import Final

__all__ = ["Watch"]

#: |energy.residual| above this fraction of the energy that has moved
ENERGY_FRACTION: Final = 1e-2
#: |constraint.drift| above this fraction of the radius
DRIFT_FRACTION: Final = 1e-3
#: model.acceleration_error above this
ACCELERATION_ERROR: Final = 0.3
#: magnification of errors by the motion, times that of a rounding, above this times the tolerance;
#: the magnification is a bound that few motions come near
ROUNDING: Final = 1e4
UNIT_ROUNDOFF: Final = 1.1102230246251565e-16
#: what the suggested step aims at, as a fraction of the bound
_AIM: Final = 0.1
#: what keeps a bound, rounded to one digit, above what it has to exceed
_GENEROUS: Final = 1.5
_FIRST_PAUSE: Final = 16
_LONGEST_PAUSE: Final = 64


class Watch:
    """When to look, what was said already, and the energy scale."""

    def __init__(self) -> None:
        #: communication steps until the next look
        self.countdown: int = _FIRST_PAUSE
        self.pause: int = _FIRST_PAUSE // 2
        self.said_energy: bool = False
        self.said_drift: bool = False
        self.said_linear: bool = False
        self.said_rounding: bool = False
        #: J, largest kinetic energy and largest change of the potential one so far
        self.moved: float = 0.0

    def due(self) -> bool:
        """Count a communication step; whether to look after it."""
        self.countdown -= 1
        if self.countdown > 0:
            return False
        self.pause = min(2 * self.pause, _LONGEST_PAUSE)
        self.countdown = self.pause
        return True

    def energy(
        self,
        kinetic: float,
        change: float,
        residual: float,
        order: int,
        setting: str,
        value: float,
        time: float,
    ) -> str:
        """The warning about the energy balance, or ''.

        kinetic (now or at the start), change of the potential energy since, residual in J;
        `setting` with its value is what rules the error, as its power `order`.
        """
        self.moved = max(self.moved, abs(kinetic), abs(change))
        if self.said_energy or not abs(residual) > ENERGY_FRACTION * self.moved > 0.0:
            return ""
        self.said_energy = True
        excess = abs(residual) / (_AIM * ENERGY_FRACTION * self.moved)
        better = value / excess if order <= 1 else value / excess ** (1.0 / order)
        return (
            f"energy.residual = {residual:.3g} J at time {time:.6g} s is more than "
            f"{ENERGY_FRACTION:g} of the energy that moves ({self.moved:.3g} J): the integration "
            f"is inaccurate; try {setting} = {better:.1g} instead of {value:g}"
        )

    def drift(self, drift: float, size: float, remedy: str, time: float) -> str:
        """The warning about the constraint, or ''; drift and size of the curve in m."""
        if self.said_drift or not abs(drift) > DRIFT_FRACTION * size:
            return ""
        self.said_drift = True
        return (
            f"constraint.drift = {drift:.3g} m at time {time:.6g} s is more than "
            f"{DRIFT_FRACTION:g} of the curve's size, {size:g} m: {remedy}"
        )

    def linear(self, error: float, remedy: str, time: float) -> str:
        """The warning about the linear fidelity, or ''."""
        if self.said_linear or not error > ACCELERATION_ERROR:
            return ""
        self.said_linear = True
        return (
            f"model.acceleration_error = {error:.3g} at time {time:.6g} s is more than "
            f"{ACCELERATION_ERROR:g}: the linear fidelity is beyond its range; {remedy}"
        )

    def rounding(
        self, magnification: float, tolerance: float, setting: str, remedy: str, time: float
    ) -> str:
        """The warning that no step size can keep to `tolerance`, which `setting` gives, or ''."""
        grown = UNIT_ROUNDOFF * magnification
        if self.said_rounding or not grown > ROUNDING * tolerance:
            return ""
        self.said_rounding = True
        return (
            f"at time {time:.6g} s the motion can magnify errors {magnification:.1g} times: "
            f"rounding alone may exceed {setting} = {tolerance:g}; {remedy}"
            f"raise {setting} to {_GENEROUS * grown / ROUNDING:.0e}"
        )

"""Warnings while running: what the live error measures say, once each.

A plant is looked at when its internal steps have grown by a quarter since the last look, or by
LONGEST_PAUSE, at the communication point that follows, at the start and at the end: what is found
does not hang on how a run is cut into communication steps, and the outputs that it needs cost next
to nothing.
"""

from __future__ import annotations

import math
from typing import Final

__all__ = ["Watch"]

#: |energy.residual| above this fraction of the energy that has moved
ENERGY_FRACTION: Final = 1e-2
#: |constraint.drift| above this fraction of the radius
DRIFT_FRACTION: Final = 1e-3
#: model.acceleration_error above this
ACCELERATION_ERROR: Final = 0.3
UNIT_ROUNDOFF: Final = 1.1102230246251565e-16
#: share of the motion in doubt, per magnification of errors, which is a bound that few come near
MAGNIFIED: Final = 1e-4 * UNIT_ROUNDOFF
#: what the suggested step aims at, as a fraction of the bound
_AIM: Final = 0.3
#: what keeps a bound, rounded to one digit, above what it has to exceed
_GENEROUS: Final = 1.5
#: share of the motion in doubt from which no tolerance can be kept
_HOPELESS: Final = 0.01
#: tolerance below which steps gain nothing
_CLOSEST: Final = 1e-14
#: internal steps between looks: a part of those made so far, and at most so many
_GROWTH: Final = 4
LONGEST_PAUSE: Final = 512
#: rounding of the energies and the work, in units of what adds up to them, in the first step and
#: per root of the number of steps
_NOISE: Final = 16.0


class Watch:
    """When to look, what was said already, and the energy scale."""

    def __init__(self) -> None:
        #: internal steps at which the next look is due, and at the last one
        self.next: int = 0
        self.seen: int = 0
        self.said_energy: bool = False
        self.said_drift: bool = False
        self.said_linear: bool = False
        self.said_rounding: bool = False
        self.said_growth: bool = False
        #: J, largest kinetic energy and largest change of the potential one met so far
        self.moved: float = 0.0

    def due(self, steps: int) -> bool:
        """Whether to look after `steps` internal steps."""
        if steps < self.next:
            return False
        self.seen = steps
        self.next = steps + max(1, min(steps // _GROWTH, LONGEST_PAUSE))
        return True

    def exceeds(self, residual: float, size: float) -> bool:
        """Whether `residual` is more than its share of `moved`, and than rounding explains.

        size: of what adds up to the residual, in J.
        """
        noise = UNIT_ROUNDOFF * (_NOISE + math.sqrt(float(self.seen))) * size
        return abs(residual) > max(ENERGY_FRACTION * self.moved, noise)

    def energy(
        self, residual: float, growth: float, order: int, setting: str, value: float, time: float
    ) -> str:
        """The warning about an energy balance of which exceeds() is true.

        growth: by how much a residual that grows with time will be larger at the end of the run;
        `setting` with its value is what rules the error, as its power `order`.
        """
        if not self.moved > 0.0:
            return ""
        self.said_energy = True
        excess = growth * abs(residual) / (_AIM * ENERGY_FRACTION * self.moved)
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
        self, doubt: float, tolerance: float, setting: str, remedy: str, time: float
    ) -> str:
        """The warning that no step size can keep to `tolerance`, which `setting` gives, or ''.

        doubt: the relative error that rounding can have made.
        """
        if self.said_rounding or not doubt > tolerance:
            return ""
        self.said_rounding = True
        told = (
            f"the motion up to time {time:.6g} s magnifies roundings to {doubt:.1g} of it: "
            f"rounding alone may exceed {setting} = {tolerance:g}; {remedy}"
        )
        if doubt > _HOPELESS:
            return f"{told}start farther from where the motion is unstable: no tolerance helps"
        return f"{told}raise {setting} to {_GENEROUS * doubt:.0e}"

    def growth(self, loss: float, tolerance: float, setting: str, time: float) -> str:
        """The warning that errors of steps have outgrown `tolerance`, which `setting` gives, or ''.

        loss: the relative error that they can have grown to.
        """
        if self.said_growth or not loss > tolerance:
            return ""
        self.said_growth = True
        closer = max(tolerance * tolerance / (_GENEROUS * loss), _CLOSEST)
        return (
            f"the motion up to time {time:.6g} s magnifies errors of steps to {loss:.1g} of it, "
            f"more than {setting} = {tolerance:g}: to keep to that, lower it to {closer:.0e}"
        )

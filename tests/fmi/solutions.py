"""Solutions in 15 digits of the three systems at their default parameters.

Undriven and undamped. From a Taylor series in 45 digits; the linear one also from its normal modes
and the bead from Jacobi elliptic functions.
"""

from __future__ import annotations

from typing import NamedTuple


class Solution(NamedTuple):
    """Names of two positions and of their two velocities, and their values at time 1 and 10 s."""

    fmu: str
    parameters: dict[str, str]
    names: tuple[str, str, str, str]
    at_1: tuple[float, float, float, float]
    at_10: tuple[float, float, float, float]


_BEAD = (
    "BeadOnWire",
    ("bead.x", "bead.y", "bead.vx", "bead.vy"),
    (-0.986291751131875, -0.165010853125541, -0.296905515916316, 1.77464364111266),
    (0.275087462576117, -0.961419205099125, -4.17559810095173, -1.19474905456048),
)
_PENDULUM = ("slider.u", "pendulum.angle", "slider.u_rate", "pendulum.angular_velocity")


def _bead(**choices: str) -> Solution:
    return Solution(_BEAD[0], {k.replace("_", ".", 1): v for k, v in choices.items()}, *_BEAD[1:])


ANGLE = _bead(model_formulation="angle")
PROJECTION = _bead(constraint_stabilization="projection")
UNSTABILISED = _bead(constraint_stabilization="none")
BAUMGARTE = _bead(constraint_stabilization="baumgarte")
NONLINEAR = Solution(
    "ParabolaPendulum",
    {"model.fidelity": "nonlinear"},
    _PENDULUM,
    (-0.253303205067521, -0.484556964241781, -0.589168094566075, -1.25295793073886),
    (-0.112074121556804, -0.295201431642521, 1.11389439174177, 1.11460636851215),
)
LINEAR = Solution(
    "ParabolaPendulum",
    {"model.fidelity": "linear"},
    _PENDULUM,
    (-0.249488700020316, -0.534995675175123, -0.491540787932609, -1.26539589948507),
    (0.187964711805705, 0.215396108598008, 0.527241555358503, 1.90816142341263),
)

SOLUTIONS = {
    "angle": ANGLE,
    "projection": PROJECTION,
    "none": UNSTABILISED,
    "baumgarte": BAUMGARTE,
    "nonlinear": NONLINEAR,
    "linear": LINEAR,
}

#: (x, y) of the bead at 2000 s: the IFToMM benchmark A01, a simple pendulum
BEAD_AT_2000 = (-0.81460307, -0.58001883)

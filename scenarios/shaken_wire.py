"""A bead on a wire that is shaken up and down at twice the bead's frequency: it is swung up.

The wire's vertical acceleration is an input signal, a function of time that is held over each
communication step (its value half a step later, so that the wire does not drift). Shaking at twice
the frequency of small swings feeds energy into them (parametric resonance) until their frequency
has moved away.
"""

import math

from curvebound.cosim import Scene

SWING = math.sqrt(9.81)  # rad/s, of small swings on a wire of 1 m
STEP = 0.01  # s


def shaking(t: float) -> float:
    """Vertical acceleration of the wire in m/s2: it moves by 5 cm to either side."""
    omega = 2.0 * SWING
    return 0.05 * omega * omega * math.cos(omega * (t + 0.5 * STEP))


scene = Scene(
    "shaken_wire",
    "a bead on a wire shaken up and down, swung up by parametric resonance",
    stop_time=20.0,
    step=STEP,
    needs={"bead.bead.angle": 1e-4},
    lesson=4,
)
scene.add("bead", "BeadOnWire", {"model.formulation": "angle", "bead.angle_start": 0.05})
scene.input("bead.wire.ay", shaking)
scene.record("bead.bead.*", "bead.wire.*", "bead.constraint.force", "bead.energy.*")

if __name__ == "__main__":
    scene.main()

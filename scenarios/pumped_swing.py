"""The parabola's coefficient is pumped at twice the frequency of a mode, whose motion grows.

Parametric resonance, as a child on a swing uses it: the slow mode, in which slider and bob swing
together at 2.397 rad/s, gains energy from a coefficient that varies by 20 % at twice that. The
variant `detuned` pumps at 1.8 times the frequency, and nothing grows.
"""

import math

from curvebound.cosim import Scene

STEP = 0.01  # s
MODE = 2.39719939786409 / (2.0 * math.pi)  # Hz, of the slow mode at the default parameters


def pumping(frequency: float) -> dict[str, float | str]:
    """Drive parameters such that the coefficient is 0.5 (1 + 0.2 cos(2 pi frequency t))."""
    omega = 2.0 * math.pi * frequency
    return {
        "waveform.amplitude": 0.1 * omega * omega,
        "waveform.frequency": frequency,
        # minus a cosine, half a step ahead as each value is held
        "waveform.phase": -0.5 * math.pi + math.pi * frequency * STEP,
    }


scene = Scene(
    "pumped_swing",
    "the coefficient pumped at twice a mode's frequency makes its motion grow",
    stop_time=40.0,
    step=STEP,
    needs={"plant.slider.u": 1e-3, "plant.pendulum.angle": 1e-3},
    lesson=6,
)
scene.add(
    "drive",
    "ParabolaDrive",
    {"waveform.kind": "sine", "waveform.axis": "coefficient", **pumping(2.0 * MODE)},
)
scene.add(
    "plant",
    "ParabolaPendulum",
    {
        "slider.u_start": 0.05,
        "pendulum.angle_start": 0.05,
        "parabola.coefficient_start": 0.6,
    },
)
scene.connect("drive.parabola.coefficient_acceleration", "plant.parabola.coefficient_acceleration")
scene.record("plant.slider.*", "plant.pendulum.*", "plant.parabola.*", "plant.energy.*")
scene.record("plant.constraint.normal_force")
scene.variant("detuned", {f"drive.{name}": value for name, value in pumping(1.8 * MODE).items()})

if __name__ == "__main__":
    scene.main()

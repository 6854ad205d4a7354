"""Everything at once: plants under drive, forces and damping, with inputs that change each step."""

from __future__ import annotations

import math

from harness import Instance, Value

INPUTS = {
    "BeadOnWire": {"wire.ax": 2.0, "wire.ay": 1.5, "bead.fx": 0.7, "bead.fy": -0.5},
    "ParabolaPendulum": {
        "parabola.ax": 2.0,
        "parabola.ay": 1.5,
        "parabola.coefficient_acceleration": 0.2,
        "slider.fx": 0.7,
        "slider.fy": -0.5,
        "pendulum.fx": 0.3,
        "pendulum.fy": -0.4,
    },
    "ParabolaDrive": {
        "slider.u": 0.5,
        "slider.u_rate": 2.0,
        "pendulum.angle": 0.6,
        "pendulum.angular_velocity": 2.5,
        "parabola.x": 0.3,
        "parabola.vx": 1.1,
    },
}

#: model -> FMU and parameters
MODELS: dict[str, tuple[str, dict[str, Value]]] = {
    "angle": ("BeadOnWire", {"model.formulation": "angle", "bead.damping": 0.3}),
    "projection": ("BeadOnWire", {"constraint.stabilization": "projection", "bead.damping": 0.3}),
    "none": ("BeadOnWire", {"constraint.stabilization": "none", "bead.damping": 0.3}),
    "baumgarte": ("BeadOnWire", {"constraint.stabilization": "baumgarte", "bead.damping": 0.3}),
    "nonlinear": (
        "ParabolaPendulum",
        {
            "slider.damping": 0.2,
            "pendulum.damping": 0.1,
            "parabola.coefficient_rate_start": 0.1,
        },
    ),
    "linear": (
        "ParabolaPendulum",
        {
            "model.fidelity": "linear",
            "slider.damping": 0.2,
            "pendulum.damping": 0.1,
            "parabola.coefficient_rate_start": 0.1,
        },
    ),
}

METHODS = ("explicit_euler", "semi_implicit_euler", "rk4", "adaptive", "implicit")


def constant(parameters: dict[str, Value]) -> dict[str, Value]:
    """The parameters without a rate of the coefficient, as `exact` needs."""
    return {**parameters, "parabola.coefficient_rate_start": 0.0}


def inputs_at(fmu: str, time: float, *, constant: bool = False) -> dict[str, float]:
    """Inputs of a time; with `constant`, those that leave the coefficient alone."""
    values = {
        name: size * math.sin(3.0 * time + i) for i, (name, size) in enumerate(INPUTS[fmu].items())
    }
    if constant:
        values["parabola.coefficient_acceleration"] = 0.0
    return values


def slopes_at(fmu: str, time: float, *, constant: bool = False) -> dict[str, float]:
    """Derivatives of inputs_at(); with `constant`, of those that `exact` can follow."""
    return {
        name: 3.0 * size * math.cos(3.0 * time + i)
        for i, (name, size) in enumerate(INPUTS[fmu].items())
        if not constant or name.endswith("x")
    }


def drive(instance: Instance, count: int, size: float, *, constant: bool = False) -> None:
    """`count` communication steps of `size`, each with inputs of its own."""
    begin = instance.time
    for i in range(count):
        instance.set(inputs_at(instance.fmu.name, instance.time, constant=constant))
        end = begin + (i + 1) * size
        instance.step(end - instance.time)
        instance.time = end

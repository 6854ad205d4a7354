"""The kernel's own models at points of the studies, in minimal coordinates."""

from __future__ import annotations

from collections.abc import Mapping

from ...models.base import Model
from ...models.bead_on_wire import bead_on_wire
from ...models.parabola_pendulum import parabola_pendulum

__all__ = ["kernel_of"]


def kernel_of(system: str, values: Mapping[str, float | str], *, damped: bool = True) -> Model:
    """The model of a system at its start; inputs not given are zero.

    system: "bead" or "pendulum"; KeyError for another.
    """
    real = {k: float(v) for k, v in values.items() if not isinstance(v, str)}
    if not damped:
        real |= {name: 0.0 for name in real if name.endswith(".damping")}
    model: Model
    if system == "bead":
        choices = {"model.formulation": 2, "constraint.stabilization": 1}
        model = bead_on_wire(choices)
    elif system == "pendulum":
        choices = {"model.fidelity": 1 if values["model.fidelity"] == "linear" else 2}
        model = parabola_pendulum(choices)
    else:
        raise KeyError(system)
    model.start(real, choices)
    model.set_inputs([real.get(name, 0.0) for name in model.INPUTS], 0)
    return model

"""energy.residual under drive, forces and damping: a live measure of the integration error."""

from __future__ import annotations

import numpy as np
import pytest
from driven import MODELS, constant, drive
from harness import Value

#: method -> order, counts of internal steps in a communication step of 0.05 s, bound of the
#: residual (J) at the largest count; the energy itself changes by 5 to 17 J
METHODS = {
    "explicit_euler": (1, (160, 320, 640, 1280), 1.5e-2),
    "semi_implicit_euler": (1, (160, 320, 640, 1280), 1.5e-2),
    "rk4": (4, (12, 24, 48, 96), 1e-10),
    "implicit": (4, (4, 8, 16, 32), 1e-9),
}


def residual_of(start, label: str, parameters: dict[str, Value]) -> float:
    """|energy.residual| (J) after a second that adds 5 to 17 J."""
    fmu, own = MODELS[label]
    instance = start(fmu, {**own, **parameters})
    assert instance["energy.residual"] == 0.0
    before = instance["energy.total"]
    drive(instance, 20, 0.05)
    assert instance["energy.total"] - before > 5.0
    kinetic, potential, total, rest = instance.get(
        "energy.kinetic", "energy.potential", "energy.total", "energy.residual"
    )
    assert total == kinetic + potential
    assert instance.errors == []
    return abs(rest)


@pytest.mark.parametrize("label", MODELS)
@pytest.mark.parametrize("method", METHODS)
def test_goes_to_zero_at_the_order_of_the_method(start, method: str, label: str) -> None:
    order, counts, bound = METHODS[method]
    rests = [
        residual_of(start, label, {"solver.method": method, "solver.step": 0.05 / count})
        for count in counts
    ]
    observed = -np.polyfit(np.log(counts), np.log(rests), 1)[0]
    # energy may converge faster than the state, as with RK4 on conservative systems
    assert observed > order - 0.15
    assert rests[-1] < bound


@pytest.mark.parametrize("label", MODELS)
def test_adaptive_keeps_it_near_the_tolerance(start, label: str) -> None:
    for tolerance in (1e-6, 1e-10):
        rest = residual_of(
            start, label, {"solver.method": "adaptive", "solver.tolerance": tolerance}
        )
        # some 10 J are at stake; the Baumgarte feedback moves more than the bead does
        assert rest < 500.0 * tolerance
    assert (
        residual_of(start, label, {"solver.method": "adaptive", "solver.tolerance": 1e-13}) < 1e-11
    )


def test_exact_leaves_only_rounding(start) -> None:
    fmu, parameters = MODELS["linear"]
    instance = start(fmu, {**constant(parameters), "solver.method": "exact"})
    before = instance["energy.total"]
    drive(instance, 20, 0.5, constant=True)
    assert instance.errors == []
    assert abs(instance["energy.total"] - before) > 1.0
    assert abs(instance["energy.residual"]) < 1e-13


def test_damping_alone_dissipates_what_is_missing(start) -> None:
    instance = start("ParabolaPendulum", MODELS["nonlinear"][1] | {"pendulum.damping": 2.0})
    last = instance["energy.total"]
    for _ in range(20):
        instance.set({"parabola.coefficient_acceleration": 0.0})
        instance.step(0.1)
    assert instance["energy.total"] < last - 0.5
    assert abs(instance["energy.residual"]) < 1e-10

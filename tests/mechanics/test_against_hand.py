"""The shipped kernels by hand against what is derived from their mechanics.py.

States are drawn from the declared ranges, drive, shape, forces and damping included.
"""

from __future__ import annotations

import math
from collections.abc import Iterator
from typing import Any

import mpmath
import numpy as np
import pytest

from curvebound.fmi.folder import find
from curvebound.kernel.base import acceleration_of
from curvebound.mechanics.derived import Derived
from curvebound.mechanics.numeric import ManyDigits, extended
from curvebound.study.stability.ranges import draw

DIGITS = 80
CLOSE = 1e-12
EPSILON = 2.3e-16


def derived_of(name: str) -> Derived:
    return find({"bead": "BeadOnWire", "pendulum": "ParabolaPendulum"}[name]).derived()


def symbols(system: Derived, F: Any, model: Any, values: dict[str, Any], t: float) -> Any:
    """Symbols of the state that a kernel is in."""
    real = {k: F.number(x) for k, x in values.items() if not isinstance(x, str)}
    s = system.at(F, real, F.number(t))
    state = (model.q0, model.q1, model.v0, model.v1)
    for i, name in enumerate(system.coordinates):
        s[name] = F.number(state[i])
    for i, name in enumerate(system.rates):
        s[name] = F.number(state[2 + i])
    return s


def cases(name: str, count: int, **fixed: float) -> Iterator[tuple[Any, dict[str, Any], float]]:
    """Kernels at their start, the values that they were started with, and a time."""
    system = {"bead": "BeadOnWire", "pendulum": "ParabolaPendulum"}[name]
    factory = find(system).fmu().system.factory  # type: ignore[attr-defined]
    for point in draw(system, count, seed=14):
        values = {**point.values, **fixed}
        real = {k: float(v) for k, v in values.items() if not isinstance(v, str)}
        choices = {"model.formulation": 2, "constraint.stabilization": 1}
        choices["model.fidelity"] = 1 if prefix(values) else 2
        model = factory(choices)
        model.start({**real, "constraint.stiffness": 0.0, "constraint.damping": 0.0}, choices)
        model.set_inputs([real[name] for name in model.INPUTS], 0)
        yield model, values, 0.01 * (point.number % 3)


def prefix(values: dict[str, Any]) -> str:
    return "linear_" if values.get("model.fidelity") == "linear" else ""


def weights(name: str, values: dict[str, Any]) -> tuple[float, float]:
    """Lengths (m) per unit of the coordinates."""
    return (1.0, 1.0 if name == "bead" else float(values["pendulum.length"]))


@pytest.mark.parametrize(
    ("name", "fixed"),
    [
        ("bead", {}),
        ("pendulum", {}),
        ("pendulum", {"slider.mass": 1e-12, "pendulum.mass": 1.0}),
        ("pendulum", {"slider.mass": 1e12, "pendulum.mass": 1.0}),
    ],
    ids=lambda x: x if isinstance(x, str) else ",".join(f"{k}={v:g}" for k, v in x.items()),
)
@pytest.mark.parametrize("count", [100, pytest.param(2000, marks=pytest.mark.slow)])
def test_accelerations(name: str, fixed: dict[str, float], count: int) -> None:
    system = derived_of(name)
    for model, values, t in cases(name, count // 4 if fixed else count, **fixed):
        hand = acceleration_of(model, t, model.q0, model.q1, model.v0, model.v1)
        s = symbols(system, extended, model, values, t)
        found = system.function(prefix(values) + "accelerations")(extended, s)
        per = weights(name, values)
        true = [float(x) * w for x, w in zip(found, per, strict=False)]
        got = [x * w for x, w in zip(hand, per, strict=True)][: len(true)]
        # relative to the vector: one component may vanish by chance
        size = math.hypot(*true)
        slopes = system.function(prefix(values) + "jacobian")(extended, s)
        state = [s[n] for n in (*system.coordinates, *system.rates)]
        pushes = sum(abs(values[n] / values[f"{n[:-3]}.mass"]) for n in system.forces)
        for x, y, row, w in zip(got, true, slopes, per, strict=False):
            # what rounding of the state and of the forces itself makes of them, where that is more
            parts = sum(abs(float(d * q)) * w for d, q in zip(row, state, strict=True))
            rounding = 8 * EPSILON * (parts + pushes)
            assert abs(x - y) <= max(CLOSE * size, rounding), (values, t, got, true)


def test_extended_precision_keeps_its_digits() -> None:
    """Errors of the derived equations against 80 digits: those of equations by hand."""
    system = derived_of("pendulum")
    many = ManyDigits()
    errors = []
    for model, values, t in cases("pendulum", 150):
        function = system.function(prefix(values) + "accelerations")
        found = function(extended, symbols(system, extended, model, values, t))
        with mpmath.workdps(DIGITS):
            true = function(many, symbols(system, many, model, values, t))
            for x, y in zip(found, true, strict=True):
                high = float(x)
                low = float(x - np.longdouble(high))
                if y != 0:
                    errors.append(float(abs((mpmath.mpf(high) + mpmath.mpf(low)) / y - 1)))
    assert np.median(errors) < 1.5e-19
    assert np.quantile(errors, 0.99) < 1e-15


@pytest.mark.parametrize("name", ["bead", "pendulum"])
def test_places_and_energies(name: str) -> None:
    system = derived_of(name)
    for model, values, _ in cases(name, 60):
        s = symbols(system, extended, model, values, 0.0)
        found = dict(system.function("places")(extended, s))
        found |= system.function(prefix(values) + "energies")(extended, s)
        got = [0.0] * len(model.OUTPUTS)
        for group in range(4):
            model.observe(group, got, 0)
        for output, y in found.items():
            x = got[list(model.OUTPUTS).index(output)]
            size = abs(y)
            if output == "energy.potential":
                model.energies_at(0.0)
                size = model.potential_size
            assert abs(x - y) <= CLOSE * size, (output, values)


@pytest.mark.parametrize("name", ["bead", "pendulum"])
def test_forces(name: str) -> None:
    system = derived_of(name)
    for model, values, _ in cases(name, 60):
        if prefix(values):
            continue  # in exact geometry with linear accelerations: no function of equations.py
        s = symbols(system, extended, model, values, 0.0)
        found = system.function("reactions")(extended, s)
        got = [0.0] * len(model.OUTPUTS)
        model.observe(model.OUTPUTS["constraint.force"] if name == "bead" else 4, got, 0)
        size = max(abs(float(y)) for y in found.values())
        for output, y in found.items():
            if output != "constraint.drift":
                x = got[list(model.OUTPUTS).index(output)]
                assert abs(x - y) <= CLOSE * size, (output, values)

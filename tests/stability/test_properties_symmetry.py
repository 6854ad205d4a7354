"""Symmetries of the equations, which the methods keep: mirror, units, time reversal."""

from __future__ import annotations

import math
from collections import Counter
from typing import Any

import numpy as np
import pytest
from hypothesis import strategies as st
from properties import (
    FMUS,
    NONLINEAR,
    counts,
    holds,
    of_kind,
    rate,
    run,
    run_or_none,
    sampled,
    variables,
)

from curvebound.fmi.declaration import COUNT, OUTPUT
from curvebound.units import exponents

#: what changes its sign in a mirror that swaps left and right
MIRRORED = (
    *("gravity.x", "wire.ax", "bead.fx", "parabola.ax", "slider.fx", "pendulum.fx"),
    *("bead.angle_start", "bead.angular_velocity_start"),
    *("slider.u_start", "slider.u_rate_start"),
    *("pendulum.angle_start", "pendulum.angular_velocity_start"),
)
MIRRORED_OUTPUTS = (
    *("bead.x", "bead.vx", "bead.angle", "bead.angular_velocity"),
    *("wire.x", "wire.vx", "wire.fx", "parabola.x", "parabola.vx", "parabola.fx"),
    *("slider.u", "slider.u_rate", "slider.x", "slider.vx", "pendulum.x", "pendulum.vx"),
    *("pendulum.angle", "pendulum.angular_velocity"),
)

methods = st.sampled_from(NONLINEAR)
#: communication and internal step, in units of the fastest time at the start
pieces = st.sampled_from([(0.3, 0.3), (0.5, 0.05), (1.0, 0.02)])


def prepared(system: str, values: Any, method: str, piece: tuple[float, float]) -> Any:
    fastest = rate(system, values)
    step, inner = piece[0] / fastest, piece[1] / fastest
    return {
        **values,
        "solver.method": method,
        "solver.step": inner,
        "solver.tolerance": 1e-8,
        "solver.max_steps": 3000,
    }, step


@counts(7, 300)
@pytest.mark.parametrize("system", FMUS)
def test_mirror(system: str, count: int) -> None:
    """Left and right swapped, every bit of every output is mirrored."""

    def check(values: Any, method: str, piece: tuple[float, float]) -> None:
        values, step = prepared(system, values, method, piece)
        mirrored = {k: -v if k in MIRRORED else v for k, v in values.items()}
        one = run_or_none(system, values, step, 3)
        other = run_or_none(system, mirrored, step, 3)
        assert (one is None) == (other is None)
        if one is None or other is None:
            return
        for name in of_kind(system, OUTPUT, COUNT):
            sign = -1.0 if name in MIRRORED_OUTPUTS else 1.0
            assert np.array_equal(one[name], sign * other[name]), name

    holds(count, check, sampled(system), methods, pieces, refused=0.25)


def test_half_a_turn_is_counted_alike_to_both_sides() -> None:
    """A step too large by far throws the bead to and fro through the centre: nearly half turns."""
    start = {
        "gravity.x": -1.0,
        "gravity.y": 0.0,
        "wire.radius": math.exp(2.0),
        "bead.damping": 1.0,
        "bead.angle_start": 0.0,
        "bead.angular_velocity_start": 0.135,
        "bead.fx": -1.0,
        "bead.fy": -1.0,
        "wire.ax": -1.0,
        "wire.ay": -1.0,
        "model.formulation": "lagrange_multiplier",
        "constraint.stabilization": "baumgarte",
        "solver.method": "semi_implicit_euler",
        "solver.step": 0.136,
    }
    mirrored = {k: -v if k in MIRRORED else v for k, v in start.items()}
    one, other = (run("bead", values, 1.36, 3) for values in (start, mirrored))
    assert np.array_equal(one["bead.angle"], -other["bead.angle"])
    assert np.abs(one["constraint.drift"]).max() > 1e6


@counts(7, 300)
@pytest.mark.parametrize("system", FMUS)
def test_units(system: str, count: int) -> None:
    """In other units of length, mass and time, all powers of two, every bit is the same."""

    def check(
        values: Any, method: str, piece: tuple[float, float], m: int, kg: int, s: int
    ) -> None:
        values, step = prepared(system, values, method, piece)
        powers = {"m": 2 * m, "kg": kg, "s": s}

        def factor(name: str) -> float:
            unit = exponents(variables(system)[name].unit or "1")
            return math.ldexp(1.0, sum(powers.get(base, 0) * n for base, n in unit.items()))

        if system == "bead":
            # their defaults have units too
            values = {"constraint.stiffness": 100.0, "constraint.damping": 20.0, **values}
        scaled = {k: v if isinstance(v, str) else v * factor(k) for k, v in values.items()}
        scaled["solver.max_steps"] = values["solver.max_steps"]
        one = run_or_none(system, values, step, 3)
        other = run_or_none(system, scaled, step * math.ldexp(1.0, s), 3)
        if one is None or other is None:
            # the range of floats has no other unit: an unstable motion may leave it in one only
            one = one or other
            assert one is None or max(np.abs(v).max() for v in one.values()) > 1e100
            return
        for name in of_kind(system, OUTPUT, COUNT):
            assert np.array_equal(one[name] * factor(name), other[name]), name

    shift = st.integers(-12, 12)
    holds(count, check, sampled(system), methods, pieces, shift, shift, shift, refused=0.25)


#: what leads from the end of a motion back, its rates reversed
STATES = {
    "bead": {
        "bead.angle": "bead.angle_start",
        "bead.angular_velocity": "bead.angular_velocity_start",
    },
    "pendulum": {
        "slider.u": "slider.u_start",
        "pendulum.angle": "pendulum.angle_start",
        "slider.u_rate": "slider.u_rate_start",
        "pendulum.angular_velocity": "pendulum.angular_velocity_start",
    },
}


@counts(7, 300)
@pytest.mark.parametrize("system", FMUS)
@pytest.mark.parametrize("method", ["implicit", "adaptive"])
def test_time_reversal(system: str, method: str, count: int) -> None:
    """Undamped, with reversed rates, the motion returns to where it started.

    `implicit` is symmetric where no step is halved: it does so however large its error;
    `adaptive` to its tolerance.
    """
    judged: Counter[bool] = Counter()

    def check(values: Any) -> None:
        values = {k: 0.0 if k.endswith(".damping") else v for k, v in values.items()}
        values |= {k: 0.0 for k in values if k.endswith(("_rate_start", "coefficient_acceleration"))
                   and k.startswith("parabola")}  # fmt: skip
        values |= {"constraint.stabilization": "projection"} if system == "bead" else {}
        values, step = prepared(system, values, method, (0.1, 0.02))
        values["solver.tolerance"] = 1e-11
        there = run_or_none(system, values, step, 5)
        if there is None:
            return
        back = dict(values)
        for output, start in STATES[system].items():
            sign = -1.0 if start.endswith(("velocity_start", "rate_start")) else 1.0
            back[start] = sign * float(there[output][-1])
        home = run_or_none(system, back, step, 5)
        if method == "implicit":
            even = home is not None and all(r["solver.steps"][-1] == 25 for r in (there, home))
            judged[even] += 1
            if not even:
                return
        assert home is not None
        for output, start in STATES[system].items():
            sign = -1.0 if start.endswith(("velocity_start", "rate_start")) else 1.0
            size = np.abs(there[output]).max() + np.abs(home[output]).max()
            if output.endswith("angle"):
                size = max(size, 1.0)
            elif output == "slider.u":
                size = max(size, values["pendulum.length"])
            else:
                size += 1e-3 * rate(system, values) * values.get("pendulum.length", 1.0)
            assert abs(sign * home[output][-1] - values[start]) <= 1e-7 * size, output

    holds(count, check, sampled(system), refused=0.0 if method == "adaptive" else 0.02)
    assert judged[False] <= 0.2 * judged.total(), judged

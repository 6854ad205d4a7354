"""A step that fails leaves one message, finite outputs and the state as it was.

The calls are made in a process of their own, one for each FMU.
"""

from __future__ import annotations

from typing import Any

import pytest
from call_worker import Call, Outcome, outcomes_of
from harness import OK, Extracted
from interface_table import rows
from refusals import (
    NAMES,
    NOT_FINITE,
    RUNNING,
    Family,
    assert_fine,
    assert_finite,
    assert_refused,
    begun,
    outside,
    running,
)


def failing(name: str, setting: dict[str, Any], step: Call, size: float = 0.1) -> list[Call]:
    """`step` fails after `setting`; then the state is restored and a good step made."""
    return [
        *running(name),
        ("set", setting),
        ("outputs",),
        ("state",),
        step,
        ("outputs",),
        ("state",),
        ("restore",),
        ("doStep", 0.2, size),
        ("outputs",),
        ("state",),
    ]


GOOD: Call = ("doStep", 0.2, 0.1)
FAILING_STEPS: dict[tuple[Any, ...], tuple[list[Call], tuple[str, ...]]] = {
    **{
        (name, row.name, repr(bad)): (failing(name, {row.name: bad}, GOOD), (row.name, repr(bad)))
        for name in NAMES
        for row in rows(name, "input")
        for bad in (*NOT_FINITE, 1e300)
    },
    **{
        (name, "step size", repr(bad)): (
            failing(name, {}, ("doStep", 0.2, bad)),
            ("communicationStepSize", repr(bad)),
        )
        for name in NAMES
        for bad in (0.0, -0.0, -0.1, 1e300, 5e-324, 1e-18, *NOT_FINITE)
    },
    **{
        (name, "communication point", repr(bad)): (
            failing(name, {}, ("doStep", bad, 0.1)),
            ("currentCommunicationPoint", repr(bad), "0.2"),
        )
        for name in NAMES
        for bad in (0.0, 0.19999, 0.20001, -0.2, 1e300, *NOT_FINITE)
    },
    **{
        ("ParabolaDrive", row.name, repr(bad)): (
            failing("ParabolaDrive", {row.name: bad}, GOOD),
            (row.name, repr(bad)),
        )
        for row in rows("ParabolaDrive", "parameter")
        if row.tunable
        for bad in outside(row)
    },
}
STEPS = Family({key: calls for key, (calls, _) in FAILING_STEPS.items()})
STRAIGHT = Family(
    {(name,): [*running(name), ("doStep", 0.2, 0.1), ("outputs",), ("state",)] for name in NAMES}
)


def assert_step_refused(fmu: Extracted, outcomes: list[Outcome], *parts: str) -> list[Outcome]:
    """Check the outcomes of failing() up to the failure; returns the rest."""
    begin = len(running(fmu.name)) + 1
    assert_fine(outcomes[:begin])
    before, state, refused, after, kept = outcomes[begin : begin + 5]
    assert_refused(fmu, refused, *parts)
    assert_fine([before, state, after, kept])
    assert_finite([before, after])
    assert after["value"] == before["value"]
    assert kept["value"] == state["value"]
    return outcomes[begin + 5 :]


@pytest.mark.parametrize(("name", "what"), dict.fromkeys(key[:2] for key in FAILING_STEPS))
def test_failing_step(extracted, name: str, what: str) -> None:
    for key in (key for key in FAILING_STEPS if key[:2] == (name, what)):
        rest = assert_step_refused(
            extracted[name], STEPS.outcome(extracted, key), *FAILING_STEPS[key][1]
        )
        assert_fine(rest)
        assert [r["value"] for r in rest[-2:]] == [
            r["value"] for r in STRAIGHT.outcome(extracted, (name,))[-2:]
        ]


# -- steps that the integration cannot make -------------------------------------------------------

_GROWING = {"gravity.y": 9.81e4, "model.fidelity": "linear"}
_SPINNING = {"bead.angular_velocity_start": 1e80, "constraint.stabilization": "none"}

#: key -> parameters, inputs, step size, parts of the message
LIMITS: dict[tuple[str, str], tuple[dict[str, Any], dict[str, float], float, tuple[str, ...]]] = {
    ("ParabolaPendulum", "rk4 grows"): (_GROWING, {}, 2.0, ("finite", "solver.step")),
    ("ParabolaPendulum", "explicit_euler grows"): (
        {**_GROWING, "solver.method": "explicit_euler"},
        {},
        2.0,
        ("finite", "solver.step"),
    ),
    ("ParabolaPendulum", "semi_implicit_euler grows"): (
        {**_GROWING, "solver.method": "semi_implicit_euler"},
        {},
        2.0,
        ("finite", "solver.step"),
    ),
    ("ParabolaPendulum", "implicit grows"): (
        {**_GROWING, "solver.method": "implicit"},
        {},
        2.0,
        ("finite", "solver.step"),
    ),
    ("ParabolaPendulum", "adaptive grows"): (
        {**_GROWING, "solver.method": "adaptive"},
        {},
        2.0,
        ("at time 0.0 s", "2.0 s"),
    ),
    # ends between what a float and what its square can hold
    **{
        ("ParabolaPendulum", f"{method} ends beyond 1e150"): (
            {**_GROWING, "solver.method": method, "parabola.coefficient_rate_start": 0.0},
            {"parabola.coefficient_acceleration": 0.0},
            0.8,
            ("at time 0.0 s", "0.8 s", remedy),
        )
        for method, remedy in (
            ("explicit_euler", "reduce solver.step"),
            ("semi_implicit_euler", "reduce solver.step"),
            ("rk4", "reduce solver.step"),
            # or what makes its error estimate give up before
            ("adaptive", ""),
            ("implicit", "reduce solver.step"),
            ("exact", "smaller"),
        )
    },
    ("ParabolaPendulum", "exact grows"): (
        {**_GROWING, "solver.method": "exact", "parabola.coefficient_rate_start": 0.0},
        {"parabola.coefficient_acceleration": 0.0},
        2.0,
        ("finite", "smaller"),
    ),
    **{
        ("BeadOnWire", f"{method} spins"): (
            {**_SPINNING, "solver.method": method},
            {},
            10.0,
            ("finite", "solver.step"),
        )
        for method in ("explicit_euler", "semi_implicit_euler", "rk4")
    },
    **{
        (name, f"{method} runs out of steps"): (
            {"solver.method": method, "solver.max_steps": 10},
            {},
            5.0,
            ("solver.max_steps = 10 ", "step size reached is", "raise solver.max_steps"),
        )
        for name in ("BeadOnWire", "ParabolaPendulum")
        for method in ("explicit_euler", "semi_implicit_euler", "rk4", "adaptive", "implicit")
    },
    ("ParabolaPendulum", "exact with an acceleration of the coefficient"): (
        {
            "solver.method": "exact",
            "model.fidelity": "linear",
            "parabola.coefficient_rate_start": 0.0,
        },
        {"parabola.coefficient_acceleration": 0.1},
        0.1,
        ("solver.method", "exact", "parabola.coefficient_acceleration", "constant"),
    ),
}


def limit_case(name: str, parameters: dict[str, Any], size: float, inputs: dict[str, float]):
    own = {key: value for key, value in RUNNING[name].items() if key != "solver.method"}
    return [
        *begun({**own, **parameters}),
        ("save",),
        ("set", inputs),
        ("outputs",),
        ("state",),
        ("doStep", 0.0, size),
        ("outputs",),
        ("state",),
        ("restore",),
        ("doStep", 0.0, 1e-5),
        ("outputs",),
    ]


LIMIT = Family(
    {
        key: limit_case(key[0], parameters, size, inputs)
        for key, (parameters, inputs, size, _) in LIMITS.items()
    }
)


@pytest.mark.parametrize("key", LIMITS, ids="-".join)
def test_step_beyond_the_limits(extracted, key: tuple[str, str]) -> None:
    outcomes = LIMIT.outcome(extracted, key)
    assert_fine(outcomes[:6])
    before, state, refused, after, kept = outcomes[6:11]
    assert_refused(extracted[key[0]], refused, *LIMITS[key][3])
    assert_finite([before, after])
    assert after["value"] == before["value"]
    assert kept["value"] == state["value"]
    restored, step, outputs = outcomes[11:]
    assert_fine([restored])
    if "spins" not in key[1]:
        assert_fine([step])
    assert_finite([outputs])


def test_a_tolerance_below_rounding(extracted) -> None:
    """It is met as far as floats go or refused, within the steps allowed."""
    calls = [
        *begun({"solver.method": "adaptive", "solver.tolerance": 5e-324, "solver.max_steps": 2000}),
        ("outputs",),
        ("state",),
        ("doStep", 0.0, 1.0),
        ("outputs",),
        ("state",),
    ]
    for name in ("BeadOnWire", "ParabolaPendulum"):
        (outcomes,) = outcomes_of(extracted[name], [calls])
        *_, before, state, step, after, kept = outcomes
        assert_finite([before, after])
        if step["status"] != OK:
            assert_refused(extracted[name], step, "solver.tolerance")
            assert (after["value"], kept["value"]) == (before["value"], state["value"])


def test_exact_with_a_rate_of_the_coefficient(extracted) -> None:
    calls = [
        *begun(
            {
                "solver.method": "exact",
                "model.fidelity": "linear",
                "parabola.coefficient_rate_start": 0.1,
            }
        ),
        ("doStep", 0.0, 0.1),
    ]
    (outcomes,) = outcomes_of(extracted["ParabolaPendulum"], [calls])
    assert_fine(outcomes[:-1])
    assert_refused(
        extracted["ParabolaPendulum"], outcomes[-1], "exact", "parabola.coefficient", "rate"
    )

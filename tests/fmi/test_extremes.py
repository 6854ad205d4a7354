"""Huge and tiny but finite values: each call succeeds or fails honestly, and no NaN is read.

The calls are made in a process of their own, one for each FMU.
"""

from __future__ import annotations

import random
from typing import Any

import pytest
from call_worker import Call, Outcome, outcomes_of
from harness import OK, Extracted
from interface_table import FINITE, INTERFACE
from refusals import (
    NAMES,
    REMEDY,
    assert_fine,
    assert_finite,
    begun,
)

EXTREMES = (1e300, 1.7976931348623157e308, 1e150, 1e100, 1e20, 1e-20, 1e-150, 1e-300, 5e-324)
#: few steps, so that no case takes long
_METHODS = {
    "BeadOnWire": [
        {"solver.method": method, "solver.max_steps": 200, **own}
        for method in ("explicit_euler", "semi_implicit_euler", "rk4", "adaptive", "implicit")
        for own in (
            {},
            {"model.formulation": "angle"},
            {"constraint.stabilization": "baumgarte"},
        )
    ],
    "ParabolaPendulum": [
        {"solver.method": method, "solver.max_steps": 200, "model.fidelity": fidelity}
        for method in ("explicit_euler", "semi_implicit_euler", "rk4", "adaptive", "implicit")
        for fidelity in ("linear", "nonlinear")
    ]
    + [{"solver.method": "exact", "model.fidelity": "linear"}],
    "ParabolaDrive": [
        {"waveform.kind": kind, "waveform.axis": axis, "sample.period": period, "slider.u": 1.0}
        for kind in ("sine", "chirp", "step")
        for axis in ("x", "y")
        for period in (0.0, 0.01)
    ],
}


def assert_honest(fmu: Extracted, case: list[Call], outcomes: list[Outcome]) -> None:
    """Each call succeeds silently or fails with a message, and nothing read is NaN or infinite."""
    assert_finite(outcomes)
    failed = False
    for call, outcome in zip(case, outcomes, strict=False):
        if fmu.forwarded or call[0] == "doStep":
            assert (outcome["status"] == OK) == (not outcome["errors"]), (call, outcome)
        if outcome["status"] != OK and not failed and call[0] != "outputs":
            # what is called after a failure is refused too
            failed = True
            assert len(outcome["errors"]) == 1, (case, outcome)
            assert REMEDY.search(outcome["errors"][0]), outcome


def extreme_case(values: dict[str, Any]) -> list[Call]:
    return [
        *begun(values),
        ("outputs",),
        ("doStep", 0.0, 0.01),
        ("outputs",),
        ("doStep", 0.01, 0.5),
        ("outputs",),
    ]


@pytest.mark.parametrize("name", NAMES)
def test_huge_and_tiny_values(extracted, name: str) -> None:
    cases = [
        extreme_case({**choices, row.name: value})
        for i, row in enumerate(INTERFACE[name])
        if row.type == "Real" and row.causality != "output"
        for j, value in enumerate([*EXTREMES, *(-x for x in EXTREMES)])
        if value > 0.0 or row.domain == FINITE
        for choices in (_METHODS[name][(5 * i + 2 * j) % len(_METHODS[name])],)
    ]
    for case, outcomes in zip(cases, outcomes_of(extracted[name], cases), strict=True):
        assert_honest(extracted[name], case, outcomes)


def random_extremes(name: str, draw: random.Random) -> dict[str, Any]:
    """Half of the parameters and inputs anywhere between 1e-300 and 1e300."""
    values: dict[str, Any] = dict(draw.choice(_METHODS[name]))
    for row in INTERFACE[name]:
        if row.type != "Real" or row.causality == "output" or draw.random() < 0.5:
            continue
        span = draw.choice((3.0, 20.0, 140.0, 300.0))
        size = 10.0 ** draw.uniform(-span, span)
        if row.causality == "input":
            size = min(size, 1e150)
        values[row.name] = size if row.domain != FINITE or draw.random() < 0.6 else -size
    return values


@pytest.mark.parametrize("count", [50, pytest.param(400, marks=pytest.mark.slow)])
@pytest.mark.parametrize("name", NAMES)
def test_extremes_together(extracted, name: str, count: int) -> None:
    draw = random.Random(11)
    cases = [extreme_case(random_extremes(name, draw)) for _ in range(count)]
    for case, outcomes in zip(cases, outcomes_of(extracted[name], cases), strict=True):
        assert_honest(extracted[name], case, outcomes)


def test_outputs_that_do_not_fit_a_float_fail_no_step(extracted) -> None:
    """Reading them is refused; the steps themselves, however many, can be made."""
    parameters = {"gravity.x": 1e150, "model.fidelity": "linear"}
    calls = [*begun(parameters), *[("doStep", i * 1e-4, 1e-4) for i in range(40)]]
    (outcomes,) = outcomes_of(extracted["ParabolaPendulum"], [[*calls, ("outputs",)]])
    assert_fine(outcomes[: len(calls)])
    assert_finite(outcomes)
    assert outcomes[-1]["errors"]

"""Calls out of order, unknown variables, and what may not be set: refused, never a crash.

The calls are made in a process of their own, one for each FMU.
"""

from __future__ import annotations

import pytest
from call_worker import Call, outcomes_of
from harness import DISCARD, ERROR, OK
from interface_table import INTERFACE, rows
from refusals import (
    ENTER,
    EXIT,
    NAMES,
    SETUP,
    assert_fine,
    assert_finite,
    begun,
    running,
)

MISUSES: dict[str, list[Call]] = {
    "fmi2DoStep before initialization": [SETUP, ("doStep", 0.0, 0.1)],
    "fmi2DoStep in initialization mode": [SETUP, ENTER, ("doStep", 0.0, 0.1)],
    "fmi2DoStep after fmi2Terminate": [*begun(), ("terminate",), ("doStep", 0.0, 0.1)],
    "fmi2ExitInitializationMode at once": [SETUP, EXIT],
    "fmi2EnterInitializationMode twice": [SETUP, ENTER, ENTER],
    "fmi2SetupExperiment while stepping": [*begun(), SETUP],
}


@pytest.mark.parametrize("name", NAMES)
@pytest.mark.parametrize("misuse", MISUSES)
def test_calls_out_of_order(extracted, name: str, misuse: str) -> None:
    (outcomes,) = outcomes_of(extracted[name], [MISUSES[misuse]])
    assert_fine(outcomes[:-1])
    assert outcomes[-1]["status"] >= DISCARD
    assert len(outcomes[-1]["errors"]) == 1
    assert misuse.split()[0] in outcomes[-1]["errors"][0]


@pytest.mark.parametrize("name", NAMES)
def test_outputs_before_initialization_are_no_nan(extracted, name: str) -> None:
    (outcomes,) = outcomes_of(extracted[name], [[("outputs",), SETUP, ("outputs",)]])
    assert_finite(outcomes)


@pytest.mark.parametrize("name", NAMES)
def test_values_stay_readable_after_terminate(extracted, name: str) -> None:
    calls = [*running(name), ("outputs",), ("terminate",), ("outputs",)]
    (outcomes,) = outcomes_of(extracted[name], [calls])
    assert_fine(outcomes)
    assert outcomes[-1]["value"] == outcomes[-3]["value"]


FIXED = [(name, row.name) for name in NAMES for row in rows(name, "parameter") if not row.tunable]


@pytest.mark.parametrize("name", NAMES)
def test_fixed_parameters_stay_after_initialization(extracted, name: str) -> None:
    variables = [v for n, v in FIXED if n == name]
    cases = [
        [*running(name), ("get", v), ("state",), ("set", {v: 2}), ("get", v), ("state",)]
        for v in variables
    ]
    for variable, outcomes in zip(variables, outcomes_of(extracted[name], cases), strict=True):
        *_, before, state, refused, after, kept = outcomes
        assert len(refused["errors"]) == 1, variable
        assert variable in refused["errors"][0]
        assert "before initialization ends" in refused["errors"][0]
        assert refused["status"] == (ERROR if extracted[name].forwarded else OK)
        assert (before["value"], state["value"]) == (after["value"], kept["value"])


@pytest.mark.parametrize("name", NAMES)
def test_outputs_cannot_be_set(extracted, name: str) -> None:
    variables = [row.name for row in rows(name, "output")]
    cases = [
        [*running(name), ("get", v), ("state",), ("set", {v: 3}), ("get", v), ("state",)]
        for v in variables
    ]
    for variable, outcomes in zip(variables, outcomes_of(extracted[name], cases), strict=True):
        *_, before, state, refused, after, kept = outcomes
        assert len(refused["errors"]) == 1
        assert f"{variable} is an output" in refused["errors"][0]
        assert (before["value"], state["value"]) == (after["value"], kept["value"])


@pytest.mark.parametrize("name", NAMES)
def test_unknown_value_references(extracted, name: str) -> None:
    size = len(INTERFACE[name])
    variables = extracted[name].variables
    integer = next(v.valueReference for v in variables.values() if v.type != "Real")
    real = next(v.valueReference for v in variables.values() if v.type == "Real")
    calls: list[Call] = []
    for vr in (size, 10**6, 2**31 - 1, 2**31, 2**32 - 1):
        calls += [("getReal", [vr]), ("getInteger", [vr]), ("getBoolean", [vr])]
        calls += [("getString", [vr]), ("setReal", [vr], [1.0]), ("setInteger", [vr], [1])]
        calls += [("setBoolean", [vr], [True]), ("setString", [vr], ["x"])]
    calls += [("getReal", [integer]), ("getInteger", [real]), ("setReal", [integer], [1.0])]
    calls += [("setInteger", [real], [1]), ("getBoolean", [real]), ("getString", [integer])]
    cases = [[*running(name), ("state",), call, ("state",), ("outputs",)] for call in calls]
    for call, outcomes in zip(calls, outcomes_of(extracted[name], cases), strict=True):
        before, refused, after, outputs = outcomes[-4:]
        assert len(refused["errors"]) == 1, call
        assert f"value reference {call[1][0]} " in refused["errors"][0]
        if call[1][0] < size:
            own = next(v for v in variables.values() if v.valueReference == call[1][0])
            assert f"{own.name} of type {own.type}, not {call[0][3:]}" in refused["errors"][0]
        assert not extracted[name].forwarded or refused["status"] == ERROR
        assert before["value"] == after["value"]
        assert_fine([outputs])

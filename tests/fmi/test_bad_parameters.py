"""Initialization fails, with one message, where a parameter is outside its domain.

The calls are made in a process of their own, one for each FMU.
"""

from __future__ import annotations

from typing import Any

import pytest
from call_worker import Call
from harness import ERROR
from interface_table import rows
from refusals import (
    ENTER,
    EXIT,
    NAMES,
    NOT_FINITE,
    SETUP,
    Family,
    assert_fine,
    assert_finite,
    assert_refused,
    begun,
    outside,
)

BAD_PARAMETERS = {
    (name, row.name): list(outside(row)) for name in NAMES for row in rows(name, "parameter")
}
_DEFAULTS = {(name, row.name): row.default for name in NAMES for row in rows(name, "parameter")}
BEFORE = Family(
    {
        (name, variable, repr(value)): [
            SETUP,
            ("set", {variable: value}),
            ENTER,
            ("reset",),
            *begun({variable: _DEFAULTS[name, variable]}),
            ("doStep", 0.0, 0.1),
            ("outputs",),
        ]
        for (name, variable), values in BAD_PARAMETERS.items()
        for value in values
    }
)
DURING = Family(
    {
        (name, variable, repr(value)): [
            SETUP,
            ENTER,
            ("outputs",),
            ("set", {variable: value}),
            ("outputs",),
            EXIT,
        ]
        for (name, variable), values in BAD_PARAMETERS.items()
        for value in values
    }
)


@pytest.mark.parametrize(("name", "variable"), BAD_PARAMETERS)
def test_parameter_outside_its_domain(extracted, name: str, variable: str) -> None:
    fmu = extracted[name]
    for value in map(repr, BAD_PARAMETERS[name, variable]):
        *accepted, refused = BEFORE.outcome(extracted, (name, variable, value))[:3]
        assert_fine(accepted)
        assert_refused(fmu, refused, variable, value)
        if fmu.forwarded:
            # the instance is as good as new after fmi2Reset
            after = BEFORE.outcome(extracted, (name, variable, value))[3:]
            assert_fine(after)
            assert_finite(after)


@pytest.mark.parametrize(("name", "variable"), BAD_PARAMETERS)
def test_parameter_set_to_it_in_initialization_mode(extracted, name, variable) -> None:
    for value in map(repr, BAD_PARAMETERS[name, variable]):
        *accepted, refused = DURING.outcome(extracted, (name, variable, value))
        assert_fine(accepted)
        assert_refused(extracted[name], refused, variable, value)
        # what has been computed before stays
        assert accepted[-1]["value"] == accepted[2]["value"]
        assert_finite(accepted)


INITIALIZATIONS: dict[tuple[Any, ...], tuple[list[Call], tuple[str, ...]]] = {
    ("ParabolaPendulum", "exact nonlinear"): (
        [SETUP, ("set", {"solver.method": "exact"}), ENTER],
        ("solver.method", "6", "model.fidelity = 1 (linear)"),
    ),
    ("BeadOnWire", "exact"): (
        [SETUP, ("set", {"solver.method": "exact"}), ENTER],
        ("solver.method", "6", "adaptive"),
    ),
    **{
        (name, "start time", repr(bad)): ([("setup", bad, None, None)], ("startTime", repr(bad)))
        for name in NAMES
        for bad in NOT_FINITE
    },
    **{
        (name, "tolerance", repr(bad)): (
            [("setup", 0.0, None, bad), ENTER],
            ("tolerance", repr(bad)),
        )
        for name in NAMES
        for bad in (0.0, -1e-6, *NOT_FINITE)
    },
    **{
        (name, row.name, repr(bad)): (
            [SETUP, ("set", {row.name: bad}), ENTER, EXIT],
            (row.name, repr(bad)),
        )
        for name in NAMES
        for row in rows(name, "input")
        for bad in NOT_FINITE
    },
}
INITIALIZATION = Family({key: calls for key, (calls, _) in INITIALIZATIONS.items()})


@pytest.mark.parametrize("key", INITIALIZATIONS, ids="-".join)
def test_other_failures_of_initialization(extracted, key: tuple[Any, ...]) -> None:
    *accepted, refused = INITIALIZATION.outcome(extracted, key)
    assert_fine(accepted)
    parts = INITIALIZATIONS[key][1]
    if key[1] == "start time" and extracted[key[0]].forwarded:
        parts = ("startTime", parts[1].replace("-", ""))
        assert refused["status"] == ERROR
        assert len(refused["errors"]) == 1
        assert all(part in refused["errors"][0] for part in parts)
    else:
        assert_refused(extracted[key[0]], refused, *parts)


def test_exact_on_the_bead_does_not_advise_what_it_has_not(extracted) -> None:
    (message,) = INITIALIZATION.outcome(extracted, ("BeadOnWire", "exact"))[-1]["errors"]
    assert "fidelity" not in message

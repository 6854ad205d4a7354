"""What the tests of failing calls share: the calls, and what a refusal must look like."""

from __future__ import annotations

import math
import re
from collections.abc import Iterator
from typing import Any

from call_worker import Call, Outcome, outcomes_of
from driven import INPUTS
from harness import DISCARD, ERROR, OK, Extracted
from interface_table import ENUMERATIONS, INTERFACE, NOT_NEGATIVE, POSITIVE, Row

NAMES = tuple(INTERFACE)
NAN, INF = math.nan, math.inf
NOT_FINITE = (NAN, INF, -INF)
REMEDY = re.compile(r"[:;,] (set|give|choose|reduce|raise|keep|continue|use|pass|rescale|or) ")

SETUP: Call = ("setup", 0.0, None, None)
ENTER: Call = ("enterInitializationMode",)
EXIT: Call = ("exitInitializationMode",)


def begun(parameters: dict[str, Any] | None = None) -> list[Call]:
    return [SETUP, ("set", parameters or {}), ENTER, EXIT]


class Family:
    """Cases by key, run when the first outcome is asked for."""

    def __init__(self, cases: dict[tuple[Any, ...], list[Call]]) -> None:
        self.cases = cases
        self.results: dict[tuple[Any, ...], list[Outcome]] = {}

    def outcome(self, extracted: dict[str, Extracted], key: tuple[Any, ...]) -> list[Outcome]:
        if key not in self.results:
            keys = [k for k in self.cases if k[0] == key[0]]
            found = outcomes_of(extracted[key[0]], [self.cases[k] for k in keys])
            self.results.update(zip(keys, found, strict=True))
        return self.results[key]


def assert_refused(fmu: Extracted, outcome: Outcome, *parts: str) -> None:
    """A call that failed as it should: status and one message that names `parts` and a remedy."""
    if fmu.forwarded:
        assert outcome["status"] == ERROR
    else:
        assert outcome["status"] >= DISCARD
    assert len(outcome["errors"]) == 1, outcome["errors"]
    (message,) = outcome["errors"]
    for part in parts:
        assert part in message, message
    assert REMEDY.search(message), message


def assert_fine(outcomes: list[Outcome]) -> None:
    for outcome in outcomes:
        assert (outcome["status"], outcome["errors"]) == (OK, [])


def assert_finite(outcomes: list[Outcome]) -> None:
    for outcome in outcomes:
        if isinstance(outcome["value"], list):
            assert all(math.isfinite(x) for x in outcome["value"])


def outside(row: Row) -> Iterator[float]:
    """Values outside the domain of a parameter."""
    if row.type in ENUMERATIONS:
        yield from (0, len(ENUMERATIONS[row.type]) + 1, -(2**31))
    elif row.type == "Integer":
        yield from (0, -(2**31))
    else:
        yield from NOT_FINITE
        if row.domain in (POSITIVE, NOT_NEGATIVE):
            yield from (-5e-324, -1e300)
        if row.domain == POSITIVE:
            yield from (0.0, -0.0)


#: at 0.2 s, with inputs and everything on
RUNNING: dict[str, dict[str, Any]] = {
    "BeadOnWire": {"bead.damping": 0.3, "solver.method": "implicit"},
    "ParabolaPendulum": {
        "slider.damping": 0.2,
        "pendulum.damping": 0.1,
        "parabola.coefficient_rate_start": 0.1,
        "solver.method": "adaptive",
    },
    "ParabolaDrive": {
        "feedback.slider_u": 2.0,
        "waveform.kind": "sine",
        "sample.period": 0.07,
    },
}


def running(name: str, parameters: dict[str, Any] | None = None) -> list[Call]:
    """Calls that bring an FMU to 0.2 s."""
    return [
        *begun({**RUNNING[name], **(parameters or {})}),
        ("set", INPUTS[name]),
        ("doStep", 0.0, 0.1),
        ("doStep", 0.1, 0.1),
        ("save",),
    ]

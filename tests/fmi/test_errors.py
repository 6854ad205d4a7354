"""What must fail fails with one message, without crash or NaN, and keeps the state.

The calls are made in a process of their own, one for each FMU and family of cases.
"""

from __future__ import annotations

import math
import random
import re
from collections.abc import Iterator
from typing import Any

import pytest
from call_worker import Call, Outcome, outcomes_of
from driven import INPUTS
from harness import DISCARD, ERROR, OK, Extracted
from interface_table import ENUMERATIONS, FINITE, INTERFACE, NOT_NEGATIVE, POSITIVE, Row, rows

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
    """Cases by key, run when the first outcome is asked for: one process for each FMU."""

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


# -- initialization: every parameter outside its domain -------------------------------------------


def outside(row: Row) -> Iterator[float]:
    """Values outside the domain of a parameter."""
    if row.type in ENUMERATIONS:
        yield from (0, -1, len(ENUMERATIONS[row.type]) + 1, 2**31 - 1, -(2**31))
    elif row.type == "Integer":
        yield from (0, -1, -(2**31))
    else:
        yield from NOT_FINITE
        if row.domain in (POSITIVE, NOT_NEGATIVE):
            yield from (-5e-324, -1.0, -1e300)
        if row.domain == POSITIVE:
            yield from (0.0, -0.0)


BAD_PARAMETERS = [
    (name, row.name, value)
    for name in NAMES
    for row in rows(name, "parameter")
    for value in outside(row)
]
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
        for name, variable, value in BAD_PARAMETERS
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
        for name, variable, value in BAD_PARAMETERS
    }
)


@pytest.mark.parametrize(("name", "variable", "value"), BAD_PARAMETERS)
def test_parameter_outside_its_domain(extracted, name: str, variable: str, value: float) -> None:
    fmu = extracted[name]
    *accepted, refused = BEFORE.outcome(extracted, (name, variable, repr(value)))[:3]
    assert_fine(accepted)
    assert_refused(fmu, refused, variable, repr(value))
    if fmu.forwarded:
        # the instance is as good as new after fmi2Reset
        after = BEFORE.outcome(extracted, (name, variable, repr(value)))[3:]
        assert_fine(after)
        assert_finite(after)


@pytest.mark.parametrize(("name", "variable", "value"), BAD_PARAMETERS)
def test_parameter_set_to_it_in_initialization_mode(extracted, name, variable, value) -> None:
    *accepted, refused = DURING.outcome(extracted, (name, variable, repr(value)))
    assert_fine(accepted)
    assert_refused(extracted[name], refused, variable, repr(value))
    # what has been computed before stays
    assert accepted[-1]["value"] == accepted[2]["value"]
    assert_finite(accepted)


INITIALIZATIONS: dict[tuple[Any, ...], tuple[list[Call], tuple[str, ...]]] = {
    ("ParabolaPendulum", "exact nonlinear"): (
        [SETUP, ("set", {"solver.method": "exact"}), ENTER],
        ("solver.method", "6", "model.fidelity = linear"),
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


# -- steps ----------------------------------------------------------------------------------------

#: at 0.2 s, with inputs and everything on
_RUNNING: dict[str, dict[str, Any]] = {
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
        *begun({**_RUNNING[name], **(parameters or {})}),
        ("set", INPUTS[name]),
        ("doStep", 0.0, 0.1),
        ("doStep", 0.1, 0.1),
        ("save",),
    ]


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
        for bad in (0.0, -0.0, -0.1, -1e300, 1e300, 5e-324, 1e-18, *NOT_FINITE)
    },
    **{
        (name, "communication point", repr(bad)): (
            failing(name, {}, ("doStep", bad, 0.1)),
            ("currentCommunicationPoint", repr(bad), "0.2"),
        )
        for name in NAMES
        for bad in (0.0, 0.1, 0.19999, 0.20001, 0.3, -0.2, 1e300, *NOT_FINITE)
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


@pytest.mark.parametrize("key", FAILING_STEPS, ids="-".join)
def test_failing_step(extracted, key: tuple[Any, ...]) -> None:
    name = key[0]
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
    own = {key: value for key, value in _RUNNING[name].items() if key != "solver.method"}
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


# -- what may not be called -----------------------------------------------------------------------

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
        assert not extracted[name].forwarded or refused["status"] == ERROR
        assert before["value"] == after["value"]
        assert_fine([outputs])


# -- huge and tiny values -------------------------------------------------------------------------

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


@pytest.mark.parametrize("name", NAMES)
def test_extremes_together(extracted, name: str) -> None:
    draw = random.Random(11)
    cases = [extreme_case(random_extremes(name, draw)) for _ in range(200)]
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

"""Failures inside an FMU: fmi2Error, one message, and an instance that works after fmi2Reset."""

from __future__ import annotations

import pytest

pytestmark = pytest.mark.usefixtures("system_python")

NAN = "nan"
INF = "inf"
EXACT = "6"  # a method for the linear fidelity alone

# variable -> values outside its domain (Real), or items that do not exist (enumerations, Integers)
INITIALIZATION = {
    "BeadOnWire": {
        "wire.radius": ("0", "-1", NAN, INF),
        "bead.mass": ("0", "-1", NAN, INF),
        "bead.damping": ("-0.25", NAN),
        "solver.step": ("0", "-0.001", NAN),
        "solver.tolerance": ("0", "-1", NAN),
        "solver.method": ("0", "7", "-1", EXACT),
        "solver.max_steps": ("0", "-1"),
        "model.formulation": ("0", "3"),
        "constraint.stabilization": ("0", "4"),
        "bead.angle_start": (NAN, "-inf"),
        "gravity.x": (NAN,),
        "gravity.y": (INF,),
    },
    "ParabolaPendulum": {
        "slider.mass": ("0", "-1", NAN),
        "pendulum.mass": ("0", "-1", NAN),
        "pendulum.length": ("0", "-1", NAN),
        "slider.damping": ("-1",),
        "pendulum.damping": ("-1",),
        "parabola.coefficient_start": (NAN, INF),
        "solver.method": ("0", "7", EXACT),
        "model.fidelity": ("0", "3"),
        "solver.step": ("0",),
    },
    "ParabolaDrive": {
        "waveform.kind": ("0", "5"),
        "waveform.axis": ("0", "4"),
        "limit.acceleration": (NAN,),
        "feedback.slider_u": (NAN,),
        "sample.period": ("-1", NAN),
    },
}

INPUTS = {
    "BeadOnWire": ("wire.ax", "wire.ay", "bead.fx", "bead.fy"),
    "ParabolaPendulum": ("parabola.ax", "parabola.coefficient_acceleration", "pendulum.fy"),
    "ParabolaDrive": ("slider.u", "parabola.vx"),
}


def is_real(fmu, name):
    return next(v for v in fmu.variables if v.get("name") == name).find("Real") is not None


def assert_one_message(logs, name, value):
    messages = [message for group in logs for message in group]
    assert len(messages) == 1, messages
    instance, status, category, text = messages[0]
    assert (instance, status, category) == ("i0", "Error", "logStatusError")
    assert name in text
    assert value.lstrip("-") in text or (value == EXACT and "exact" in text)


START = ["setup 0 - 0 -", "enter 0", "exit 0"]


def failing_initializations(unpacked, cases):
    """For each case eleven commands: one that fails, then the same instance doing well."""
    commands = unpacked.start()
    for name, value in cases:
        kind = "set" if is_real(unpacked, name) else "seti"
        commands += [f"{kind} 0 {unpacked.vr[name]} {value}", *START, "step 0 0 0.1", "reset 0"]
        commands += [*START, "step 0 0 0.1", "reset 0"]
    return commands


@pytest.mark.parametrize("fmu", list(INITIALIZATION))
def test_initialization_fails_and_works_after_reset(host, fmus, fmu):
    unpacked = fmus[fmu]
    cases = [(name, value) for name, values in INITIALIZATION[fmu].items() for value in values]
    commands = failing_initializations(unpacked, cases)
    result = host([*commands, "free 0"])
    for k, (name, value) in enumerate(cases):
        at = 2 + 11 * k
        answers = [a[0] for a in result.answers[at : at + 11]]
        first = answers.index("Error")
        assert first <= 3, (name, value, answers)
        assert answers[first:5] == ["Error"] * (5 - first)
        assert answers[5:] == ["OK"] * 6
        assert_one_message(result.logs[at : at + first + 1], name, value)
        # what was refused afterwards says that the instance has failed
        assert all("after an error" in m[0][3] for m in result.logs[at + first + 1 : at + 5])


def failing_steps(unpacked, inputs):
    """Pairs of commands of which the second, a step at 0.1 s, fails, with words of the message."""
    return [
        *(
            (f"set 0 {unpacked.vr[n]} {v}", "step 0 0.1 0.1", n, v)
            for n in inputs
            for v in (NAN, INF)
        ),
        ("get 0 0", "step 0 0.1 0", "step", "0"),
        ("get 0 0", "step 0 0.1 -0.1", "step", "0.1"),
        ("get 0 0", "step 0 0.1 nan", "step", "nan"),
        ("get 0 0", "step 0 0.3 0.1", "currentCommunicationPoint", "0.3"),
        ("get 0 0", "step 0 0 0.1", "currentCommunicationPoint", "0.1"),
        ("get 0 0", "step 0 nan 0.1", "currentCommunicationPoint", "nan"),
    ]


def around(unpacked, steps):
    """For each failing step sixteen commands: up to it, and after it."""
    outputs = f"get 0 {' '.join(map(str, unpacked.outputs()))}"
    commands = unpacked.start()
    good = [*START, "step 0 0 0.1", outputs]
    for set_up, step, *_ in steps:
        commands += [*good, set_up, step, outputs, "save 0 0", "reset 0", *good, "reset 0"]
    return commands


@pytest.mark.parametrize("fmu", list(INPUTS))
def test_steps_fail_and_keep_the_state(host, fmus, fmu):
    unpacked = fmus[fmu]
    steps = failing_steps(unpacked, INPUTS[fmu])
    commands = around(unpacked, steps)
    result = host([*commands, "free 0"])
    for k, (_, _, name, value) in enumerate(steps):
        answers = result.answers[2 + 16 * k : 18 + 16 * k]
        statuses = [a[0] for a in answers]
        assert statuses == ["OK"] * 6 + ["Error"] + ["OK"] * 9, (name, value)
        assert answers[4] == answers[7] == answers[14]
        assert not any("nan" in x or "inf" in x for x in answers[7])
        assert_one_message(result.logs[2 + 16 * k : 18 + 16 * k], name, value)


def test_exact_needs_a_constant_coefficient(host, pendulum):
    vr = pendulum.vr
    result = host(
        [
            *pendulum.start(),
            f"seti 0 {vr['model.fidelity']} 1 {vr['solver.method']} 6",
            "setup 0 - 0 -",
            "enter 0",
            "exit 0",
            "step 0 0 0.1",
            f"set 0 {vr['parabola.coefficient_acceleration']} 0.5",
            "step 0 0.1 0.1",
        ]
    )
    assert [a[0] for a in result.answers] == ["OK"] * 8 + ["Error"]
    assert_one_message(result.logs, "coefficient", "exact")


def test_the_largest_number_of_steps(host, bead):
    vr = bead.vr
    result = host(
        [
            *bead.start(),
            f"seti 0 {vr['solver.max_steps']} 10",
            "setup 0 - 0 -",
            "enter 0",
            "exit 0",
            "step 0 0 0.01",
            "step 0 0.01 1",
        ]
    )
    assert [a[0] for a in result.answers] == ["OK"] * 7 + ["Error"]
    assert_one_message(result.logs, "solver.max_steps", "10")


# -- other people's slaves, which raise, log and give up


def acting(odd, act, k=0):
    return [f"seti {k} {odd.vr['act']} {act}", f"setup {k} - 0 -", f"enter {k}", f"exit {k}"]


GOOD = ["setup 0 - 0 -", "enter 0", "exit 0", "step 0 0 0.5", "get 0 1"]


def test_an_exception_is_an_error_and_the_instance_lives(host, odd):
    result = host(
        [
            *odd.start(),
            *acting(odd, 1),
            "save 0 0",
            "step 0 0 0.5",
            "get 0 1",
            "step 0 0 0.5",
            "write 0 0 0",
            "reset 0",
            *GOOD,
            "free 0",
        ]
    )
    status = [a[0] for a in result.answers]
    assert status == ["OK"] * 7 + ["Error", "OK", "Error"] + ["OK"] * 8
    assert [len(group) for group in result.logs[7:11]] == [1, 0, 1, 0]
    assert result.logs[7][0][1] == "Error"
    assert "ValueError('raised in the step, 100 %s %n of it')" in result.logs[7][0][3]
    assert result.answers[-2] == ["OK", "2"]


def test_a_saved_state_revives_an_instance_whose_code_has_raised(host, odd):
    result = host(
        [
            *odd.start(),
            *acting(odd, 0),
            "step 0 0 0.5",
            "save 0 0",
            f"seti 0 {odd.vr['act']} 1",
            "step 0 0.5 0.5",
            "restore 0 0",
            "get 0 1",
            "step 0 0.5 0.5",
            "get 0 1",
            "drop 0 0",
            "free 0",
        ]
    )
    status = [a[0] for a in result.answers]
    assert status == ["OK"] * 9 + ["Error"] + ["OK"] * 6
    assert result.answers[11:14] == [["OK", "2"], ["OK"], ["OK", "2.5"]]


def counts(odd, *names):
    return f"geti 0 {' '.join(str(odd.vr[name]) for name in names)}"


def test_nothing_is_left_of_an_exception(host, odd):
    """Neither itself nor its class, its text, or what its frames held."""
    failing = [*acting(odd, 5), "step 0 0 0.5", "reset 0"]
    result = host([*odd.start(), *2 * failing, *GOOD, counts(odd, "given", "alive")])
    assert [text.split(": ")[-1] for *_, text in result.messages] == 2 * ["Own()"]
    assert result.answers[-1] == ["OK", "8", "0"]


@pytest.mark.parametrize("act", [1, 2])
def test_nothing_is_left_of_what_was_told(host, odd, act):
    failing = [*acting(odd, act), "step 0 0 0.5", "reset 0"]
    tell = [*GOOD, counts(odd, "heap"), "reset 0"]
    result = host([*odd.start(), *5 * failing, *tell, *20 * failing, *tell])
    assert len(result.messages) == 25
    first, last = (int(result.answers[at][1]) for at in (-len(tell) - 20 * len(failing) - 2, -2))
    assert last - first < 20 * 8


def test_nothing_is_left_of_results(host, odd):
    slopes = f"derivatives 0 {odd.vr['y']} {odd.vr['y']}"
    result = host([*odd.start(), *GOOD, slopes, slopes, counts(odd, "given", "alive")])
    assert result.answers[-1] == ["OK", "2", "0"]


def test_an_exception_during_initialization(host, odd):
    result = host([*odd.start(), *acting(odd, 11), "reset 0", *GOOD, "free 0"])
    assert [a[0] for a in result.answers] == ["OK"] * 4 + ["Error"] * 2 + ["OK"] * 7
    assert "raised in initialization" in result.logs[4][0][3]


def test_an_error_message_makes_an_error(host, odd):
    result = host([*odd.start(), *acting(odd, 2), "step 0 0 0.5", "get 0 1", "reset 0", *GOOD])
    assert [a[0] for a in result.answers] == ["OK"] * 6 + ["Error"] + ["OK"] * 7
    assert result.messages == [
        ("i0", "Error", "logStatusError", "failed in the step: 100 %s %n of it")
    ]
    result = host([*odd.start(), *acting(odd, 12), "reset 0", *GOOD])
    assert [a[0] for a in result.answers] == ["OK"] * 4 + ["Error"] * 2 + ["OK"] * 6
    assert result.logs[4][0][3] == "failed in initialization: 100 %s %n of it"


def test_a_slave_that_gives_up_discards_the_step(host, odd):
    result = host(
        [
            *odd.start(),
            *acting(odd, 3),
            "step 0 0 0.5",
            "status 0",
            "step 0 0.5 0.5",
            "terminate 0",
            "free 0",
        ]
    )
    assert [a[0] for a in result.answers] == ["OK"] * 6 + ["Discard", "OK", "Error", "OK", "OK"]
    assert result.answers[7] == ["OK", "Discard", "OK", "0", "Error", "OK", "1", "OK", "''"]


def test_debug_logging_filters_notes_only(host, odd):
    """Errors and warnings reach the tool whatever it has switched off."""
    warning = ("Warning", "logStatusWarning", "mind the %s%n")
    note = ("OK", "logAll", "noted in the step at 5 %")
    own = ("OK", "mine", "own")
    cases = {
        "0": [warning],
        "1": [note, warning, own],
        "1 mine": [warning, own],
        "1 other logAll": [note, warning],
        "0 mine": [warning],
    }
    commands = [f"load 0 {odd.binary}"]
    for k, switch in enumerate(cases):
        commands += [odd.new(0, k), f"debug {k} {switch}", *acting(odd, 4, k), f"step {k} 0 0.5"]
    logging = len(cases)
    commands += [odd.new(0, logging, logging=1), *acting(odd, 4, logging), f"step {logging} 0 0.5"]
    result = host(commands)
    assert {a[0] for a in result.answers} == {"OK"}
    for k, expected in enumerate((*cases.values(), [note, warning, own])):
        assert [m[1:] for m in result.messages if m[0] == f"i{k}"] == expected


def test_strings(host, odd):
    vr = odd.vr["text"]
    bad = f"sets\t0\t{vr}\tb\xff".encode("latin-1").decode("utf-8", "surrogateescape")
    result = host(
        [
            *odd.start(),
            f"sets 0 {vr} häß%s",
            f"sets 0 {vr} NULL",
            "setup 0 - 0 -",
            "enter 0",
            f"gets 0 {vr}",
            f"gets 0 {vr} {vr}",
        ]
    )
    assert [a[0] for a in result.answers] == ["OK", "OK", "OK", "Error", "OK", "OK", "OK", "OK"]
    assert result.answers[6] == ["OK", "häß%s"]
    assert bad

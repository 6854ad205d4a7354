"""Saved states: kept, restored, serialised, and refused where they are not this FMU's own."""

from __future__ import annotations

import pytest

pytestmark = pytest.mark.usefixtures("system_python")


def ready(k):
    return [f"setup {k} - 0 -", f"enter {k}", f"exit {k}"]


def show(fmu, k=0):
    return f"get {k} {' '.join(map(str, fmu.outputs()))}"


@pytest.mark.parametrize("name", ["BeadOnWire", "ParabolaPendulum", "ParabolaDrive"])
def test_going_back_gives_the_same_steps_again(host, fmus, name):
    fmu = fmus[name]
    forward = ["step 0 0.2 0.1", show(fmu), "step 0 0.3 0.1", show(fmu)]
    result = host(
        [
            *fmu.start(),
            *ready(0),
            "steps 0 0 0.1 2",
            "save 0 0",
            *forward,
            "save 0 1",
            "restore 0 0",
            *forward,
            "restore 0 1",
            show(fmu),
            "save 0 1",  # overwritten
            "restore 0 0",
            "restore 0 1",
            show(fmu),
            "drop 0 0",
            "drop 0 1",
            "free 0",
        ]
    )
    assert {a[0] for a in result.answers} == {"OK"}
    assert result.answers[7:11] == result.answers[13:17]
    assert result.answers[10] == result.answers[18] == result.answers[22]


def test_a_state_brings_its_phase_along(host, bead):
    """A failed or terminated instance continues from a state saved while it was well."""
    result = host(
        [
            *bead.start(),
            "save 0 0",
            *ready(0),
            "step 0 0 0.1",
            "save 0 1",
            "step 0 0.1 -1",
            "restore 0 1",
            "status 0",
            "step 0 0.1 0.1",
            "terminate 0",
            "restore 0 1",
            "step 0 0.1 0.1",
            "restore 0 0",
            "step 0 0.2 0.1",
            *ready(0),
            "step 0 0 0.1",
        ]
    )
    status = [a[0] for a in result.answers]
    assert [k for k, s in enumerate(status) if s != "OK"] == [8, 16]
    assert result.answers[10][1:4] == ["OK", "OK", "0.10000000000000001"]


def test_a_state_brings_the_stop_time_along(host, bead):
    result = host(
        [
            *bead.start(),
            "setup 0 - 0 1",
            "enter 0",
            "exit 0",
            "step 0 0 0.5",
            "save 0 0",
            "write 0 0 0",
            "reset 0",
            "restore 0 0",
            "step 0 0.5 1",
            bead.new(0, 1),
            "read 1 0 1",
            "restore 1 1",
            "step 1 0.5 0.5",
            "step 1 1 0.5",
        ]
    )
    status = [a[0] for a in result.answers]
    assert [k for k, s in enumerate(status) if s != "OK"] == [10, 15]
    assert all("after stopTime = 1 s" in result.logs[k][0][3] for k in (10, 15))


def test_states_of_another_instance_of_the_same_fmu(host, bead):
    result = host(
        [
            *bead.start(),
            bead.new(0, 1),
            *ready(0),
            *ready(1),
            "steps 0 0 0.1 3",
            "save 0 0",
            show(bead, 0),
            "restore 1 0",
            show(bead, 1),
            "write 0 0 0",
            "free 0",  # which frees its states
            "restore 1 0",
            "drop 1 0",
            "read 1 0 2",
            "restore 1 2",
            show(bead, 1),
            "step 1 0.3 0.1",
        ]
    )
    status = [a[0] for a in result.answers]
    assert [k for k, s in enumerate(status) if s != "OK"] == [16, 17]
    assert all(
        "not a state of this FMU, or already freed" in result.logs[k][0][3] for k in (16, 17)
    )
    assert result.answers[11] == result.answers[13] == result.answers[20]


def test_a_state_used_after_it_was_freed(host, bead):
    result = host(
        [
            *bead.start(),
            *ready(0),
            "save 0 0",
            "drop 0 0",
            "restore 0 0",
            "write 0 0 0",
            "save 0 0",
            "drop 0 0",
            "restore 0 1",  # NULL
            "step 0 0 0.1",
        ]
    )
    assert [a[0] for a in result.answers] == ["OK"] * 7 + ["Error"] * 5 + ["OK"]


def test_states_of_another_fmu(host, bead, pendulum):
    result = host(
        [
            *bead.start(0, 0),
            *pendulum.start(1, 1),
            *ready(0),
            *ready(1),
            "save 0 0",
            "write 0 0 0",
            "restore 1 0",
            "drop 1 0",
            "read 1 0 1",
            "restore 1 1",
            "step 1 0 0.1",
            "read 0 0 2",
            "restore 0 2",
            "step 0 0 0.1",
        ]
    )
    status = [a[0] for a in result.answers]
    assert [k for k, s in enumerate(status) if s != "OK"] == [12, 13, 14, 15]
    assert bead.guid in result.logs[14][0][3]
    assert pendulum.guid in result.logs[14][0][3]


def test_a_state_in_another_process(host, bead, tmp_path):
    """What one process has written another one continues from, to the last bit."""
    # The host keeps bytes in memory only, so an instance of another load of the library stands in.
    result = host(
        [
            *bead.start(),
            *ready(0),
            "steps 0 0 0.1 3",
            "save 0 0",
            "write 0 0 0",
            "step 0 0.3 0.1",
            show(bead),
            "free 0",
            "unload 0",
            *bead.start(),
            "read 0 0 0",
            "restore 0 0",
            "step 0 0.3 0.1",
            show(bead),
        ]
    )
    assert {a[0] for a in result.answers} == {"OK"}
    assert result.answers[9] == result.answers[-1]


def test_every_altered_or_missing_byte_is_noticed(host, bead):
    setup = [*bead.start(), *ready(0), "save 0 0", "write 0 0 0", "length 0"]
    length = int(host(setup).answers[-1][1])
    commands = list(setup)
    for offset in range(length):
        commands += [f"flip 0 {offset}", "read 0 0 1", f"flip 0 {offset}"]
    commands += ["read 0 0 1"]
    for cut in range(length):
        commands += [f"cut 0 {length - 1 - cut}", "read 0 0 1"]
    result = host([*commands, "step 0 0 0.1"])
    reads = [
        (answer[0], len(group))
        for command, answer, group in zip(commands, result.answers, result.logs, strict=False)
        if command.startswith("read")
    ]
    assert reads[length] == ("OK", 0)
    del reads[length]
    assert set(reads) == {("Error", 1)}
    assert len(reads) == 2 * length
    assert result.answers[-1] == ["OK"]


def test_thousands_of_states(host, bead):
    """As many as a master keeps; freed with the instance."""
    many = [*bead.start(), *ready(0), *(["save 0 0", "write 0 0 0", "read 0 0 1"] * 2000), "free 0"]
    assert {
        a[0] for a in host([*many, bead.new(), *ready(0), "save 0 2", "step 0 0 0.1"]).answers
    } == {"OK"}

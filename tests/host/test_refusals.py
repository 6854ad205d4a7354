"""What the FMU's binary refuses (order, pointers, FMU), and which folders it finds."""

from __future__ import annotations

import math
import urllib.parse

import pytest

from .conftest import Answers

pytestmark = pytest.mark.usefixtures("system_python")


def started(fmu):
    return [*fmu.start(), "setup 0 - 0 -", "enter 0", "exit 0"]


def assert_refused(result, at, *words):
    """The command at that place gave fmi2Error and exactly one message that holds the words."""
    assert result.answers[at][0] == "Error"
    assert len(result.logs[at]) == 1, result.logs[at]
    name, status, category, text = result.logs[at][0]
    assert (name, status, category) == ("i0", "Error", "logStatusError")
    for word in words:
        assert word in text


#: commands after instantiation of which the last is refused, and words of the message
ORDER = [
    (["step 0 0 0.1"], ("fmi2DoStep", "before fmi2EnterInitializationMode")),
    (["setup 0 - 0 -", "enter 0", "step 0 0 0.1"], ("fmi2DoStep", "in initialization mode")),
    (["exit 0"], ("fmi2ExitInitializationMode", "before")),
    (["get 0 0"], ("fmi2GetReal", "before fmi2EnterInitializationMode")),
    (["terminate 0"], ("fmi2Terminate",)),
    (
        ["setup 0 - 0 -", "enter 0", "enter 0"],
        ("fmi2EnterInitializationMode", "in initialization mode"),
    ),
    (["setup 0 - 0 -", "enter 0", "setup 0 - 0 -"], ("fmi2SetupExperiment",)),
    (["setup 0 - nan -"], ("startTime = nan",)),
    (["setup 0 - 1 inf"], ("stopTime = inf",)),
    (["setup 0 - 2 1"], ("stopTime = 1", "startTime = 2")),
    (["setup 0 - 0 -", "enter 0", "exit 0", "enter 0"], ("between communication steps",)),
    (
        ["setup 0 - 0 0.25", "enter 0", "exit 0", "step 0 0 0.2", "step 0 0.2 0.2"],
        ("stopTime = 0.25",),
    ),
    (
        ["setup 0 - 0 -", "enter 0", "exit 0", "terminate 0", "step 0 0 0.1"],
        ("after fmi2Terminate",),
    ),
    (
        ["setup 0 - 0 -", "enter 0", "exit 0", "terminate 0", "terminate 0"],
        ("after fmi2Terminate",),
    ),
    (
        ["setup 0 - 0 -", "enter 0", "exit 0", "terminate 0", "set 0 0 1"],
        ("after fmi2Terminate",),
    ),
    (["cancel 0"], ("fmi2CancelStep",)),
]


def one_after_the_other(host, fmu, parts):
    """What each part says, of commands in one process that has loaded the FMU."""
    result = host([f"load 0 {fmu.binary}", *(command for part in parts for command in part)])
    at, found = 1, []
    for part in parts:
        own = slice(at, at + len(part))
        found.append(Answers(result.status, "", result.answers[own], result.logs[own]))
        at += len(part)
    return found


@pytest.fixture(scope="module")
def ordered(host, bead):
    """What each of ORDER says, and after it the same instance once it is reset."""
    again = ("reset 0", "setup 0 - 0 -", "enter 0", "exit 0", "step 0 0 1", "free 0")
    parts = [[bead.new(), *commands, *again] for commands, _ in ORDER]
    return one_after_the_other(host, bead, parts)


@pytest.mark.parametrize("number", range(len(ORDER)))
def test_the_order_of_calls(ordered, number):
    commands, words = ORDER[number]
    result = ordered[number]
    at = len(commands)
    assert [a[0] for a in result.answers[:at]] == ["OK"] * at
    assert_refused(result, at, *words)
    assert [a[0] for a in result.answers[at + 1 :]] == ["OK"] * 6, "it works again after fmi2Reset"


def test_nothing_but_reading_after_a_failed_step(host, bead):
    x = bead.vr["bead.x"]
    result = host(
        [
            *started(bead),
            "step 0 0 0.1",
            f"get 0 {x}",
            "status 0",
            "step 0 0.1 -0.1",
            f"get 0 {x}",
            "status 0",
            "step 0 0.1 0.1",
            f"set 0 {x} 1",
            "terminate 0",
            "reset 0",
            "setup 0 - 0 -",
            "enter 0",
            "exit 0",
            "step 0 0 0.1",
            f"get 0 {x}",
            "free 0",
        ]
    )
    a = result.answers[5:]
    assert [x[0] for x in a] == ["OK"] * 3 + ["Error"] + ["OK"] * 2 + ["Error"] * 3 + ["OK"] * 7
    assert a[1] == a[4] == a[14]
    assert a[2] == ["OK", "OK", "OK", "0.10000000000000001", "Error", "OK", "0", "OK", "''"]
    assert a[5] == ["OK", "Error", "OK", "0.10000000000000001", "Error", "OK", "0", "OK", "''"]


def test_null_arguments(host, bead):
    result = host([*started(bead), "misuse 0", "step 0 0 0.1"])
    bad, harmless = " ".join(result.answers[5]).split(" | ")
    assert set(bad.split()) == {"Error"}
    assert harmless.split() == ["OK"] * 3
    assert len(result.logs[5]) == len(bad.split())
    assert result.answers[6] == ["OK"], "nothing of this has changed the instance"


def test_strange_components(host, bead, pendulum):
    # a component of another FMU
    result = host(
        [*pendulum.start(1, 0), f"load 0 {bead.binary}", "strange 0", "setup 0 - 0 -", "enter 0"]
    )
    assert set(result.answers[3]) == {"Error"}
    assert result.messages == []
    assert result.answers[4:] == [["OK"]] * 2
    # one that was freed, before and after its place is taken by another
    result = host([*bead.start(), "free 0", "strange 0", bead.new(0, 1), "strange 0", "enter 1"])
    assert set(result.answers[3]) == set(result.answers[5]) == {"Error"}
    assert result.answers[6] == ["OK"]


def test_derivatives_of_the_plants(host, bead):
    commands = [f"derivatives 0 {bead.vr['wire.ax']} {bead.vr['bead.x']}", "step 0 0 0.1"]
    result = host([*started(bead), *commands])
    assert result.answers[5:] == [["OK"] * 3, ["OK"]]


def test_directional_derivatives(host, bead):
    vr = bead.vr
    force, ax, ay = vr["constraint.force"], vr["wire.ax"], vr["wire.ay"]
    commands = [
        *bead.start(logging=1),
        f"set 0 {vr['bead.angle_start']} 0.3",
        "setup 0 - 0 -",
        f"change 0 {force} {ay} 1",
        "enter 0",
        f"change 0 {force} {ay} 2 {ax} 1",
        "exit 0",
        f"change 0 {force} {ax} 1",
        f"change 0 {ax} {ay} 1",
        f"change 0 {force} {vr['bead.x']} 1",
        "step 0 0 0.1",
    ]
    result = host(commands)
    assert [a[0] for a in result.answers[4:]] == ["Error", *["OK"] * 4, *["Error"] * 2, "OK"]
    assert float(result.answers[6][1]) == pytest.approx(math.sin(0.3) - 2.0 * math.cos(0.3))
    assert float(result.answers[8][1]) == pytest.approx(math.sin(0.3))
    assert "wire.ax is no output" in result.logs[9][0][3]
    assert "bead.x is no input" in result.logs[10][0][3]


# -- instantiation


#: name, GUID and resource location, where not that of the FMU, and a word of the message
UNUSABLE = [
    (
        "a",
        "{8c4e810f-3df3-4a00-8276-176fa3c9f000}",
        None,
        "{8c4e810f-3df3-4a00-8276-176fa3c9f000}",
    ),
    ("a", "NULL", None, "fmuGUID = NULL"),
    ("NULL", None, None, "instanceName"),
    ("EMPTY", None, None, "instanceName"),
    ("a", None, "file:///nowhere/resources", "/nowhere/resources"),
    ("a", None, "file://elsewhere/tmp", "elsewhere"),
    ("a", None, "http://localhost/tmp", "http"),
    ("a", None, "resources", "resources"),
    ("a", None, "file:///tmp/%00", "%00"),
    ("a", None, "file:///tmp/%FF", "%FF"),
    ("a", None, "file:///tmp", "slavemodule"),
]


@pytest.fixture(scope="module")
def instantiated(host, bead):
    """What each of UNUSABLE says, and a good one after it."""
    parts = []
    for name, guid, uri, _ in UNUSABLE:
        line = "\t".join(["new", "0", "0", name, guid or bead.guid, uri or bead.uri, "0"])
        parts.append([line, bead.new(0, 1), "free 1"])
    return one_after_the_other(host, bead, parts)


@pytest.mark.parametrize("number", range(len(UNUSABLE)))
def test_instantiation_that_fails_says_why(instantiated, number):
    *_, word = UNUSABLE[number]
    result = instantiated[number]
    assert result.answers == [["Error"], ["OK"], ["OK"]]
    assert len(result.messages) == 1
    assert result.messages[0][1] == "Error"
    assert word in result.messages[0][3] or "fmuResourceLocation" in result.messages[0][3]


FOLDERS = ["plain", "a b", "100%", "a%20b", "häß ☃", "#1?x=y", "a+b&c;d", "file:"]
ALL = " ".join(FOLDERS)
FORMS = ["file:{0}", "file://{0}", "file://localhost{0}", "FILE://{0}/", "file://{1}", "{2}"]


@pytest.mark.parametrize(
    ("folder", "form"),
    [
        *((ALL, form) for form in FORMS),
        *(pytest.param(f, form, marks=pytest.mark.slow) for f in FOLDERS for form in FORMS),
    ],
)
def test_resource_locations(host, bead, copy_of, folder, form):
    fmu = copy_of(bead, folder)
    path = str(fmu.folder / "resources")
    escaped = "".join(f"%{b:02X}" for b in path.encode()).replace("%2F", "/")
    uri = form.format(urllib.parse.quote(path), escaped, path)
    line = "\t".join(["new", "0", "0", "i0", fmu.guid, uri, "0"])
    result = host([f"load\t0\t{fmu.binary}", line, "enter 0", "exit 0", "step 0 0 0.1"])
    assert result.messages == []
    assert result.answers == [["OK"]] * 5


@pytest.mark.parametrize("uri", ["NULL", "EMPTY"])
def test_without_resource_location_the_library_finds_its_own(host, bead, uri):
    result = host([f"load 0 {bead.binary}", f"new 0 0 i0 {bead.guid} {uri} 0", "enter 0", "exit 0"])
    assert result.answers == [["OK"]] * 4


def test_a_guid_in_a_file_beside_the_library(host, bead, copy_of):
    fmu = copy_of(bead, "plain")
    guid = "{11111111-2222-3333-4444-555555555555}"
    fmu.binary.with_name("guid.txt").write_text(guid + "\n")
    result = host([f"load 0 {fmu.binary}", fmu.new(), f"new 0 0 i0 {guid} {fmu.uri} 0"])
    assert result.answers == [["OK"], ["Error"], ["OK"]]
    # some tools unpack resources and binaries only
    (fmu.folder / "modelDescription.xml").unlink()
    assert host([f"load 0 {fmu.binary}", fmu.new()]).answers == [["OK"], ["Error"]]


def test_an_incomplete_fmu_is_refused(host, bead, copy_of):
    fmu = copy_of(bead, "plain")
    module = (fmu.folder / "resources" / "slavemodule.txt").read_text().strip()
    code = fmu.folder / "resources" / f"{module}.py"
    text = code.read_text()
    code.write_text("raise RuntimeError('not 100 %s')\n")
    result = host([*fmu.start()])
    assert result.answers[-1] == ["Error"]
    assert "not 100 %s" in result.messages[0][3]
    code.unlink()
    result = host([*fmu.start()])
    assert result.answers[-1] == ["Error"]
    code.write_text(text)
    assert host([*fmu.start()]).answers[-1] == ["OK"]

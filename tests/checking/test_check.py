"""`curvebound check`: sound FMUs and scenes pass, each fault fails with the words for it."""

from __future__ import annotations

import json
import subprocess
import sys
from collections.abc import Callable
from pathlib import Path
from types import SimpleNamespace
from xml.etree import ElementTree

import pytest

from curvebound.checking import run, worker
from curvebound.checking.finding import FAILED, Finding
from curvebound.checking.fmu import FmuCheck
from curvebound.checking.request import Request
from curvebound.checking.run import check
from curvebound.cli import main
from curvebound.cosim.instance import Instance

Make = Callable[[str], Path]


def told(path: Path, until: str = "", **request: object) -> dict[str, tuple[str, str]]:
    """Outcome and text by check, in this process; `until`: the last check to do."""
    found = {}
    for one in FmuCheck(path, Request(**request)).findings():  # type: ignore[arg-type]
        found[one.check] = one.outcome, one.text
        if one.check == until:
            break
    return found


def told_apart(path: Path, until: str) -> dict[str, tuple[str, str]]:
    """The same in a process of its own: two FMUs of the same names share modules in one."""
    script = (
        f"import sys; sys.path.insert(0, {str(Path(__file__).parent)!r})\n"
        "import json, pathlib, test_check\n"
        f"print(json.dumps(test_check.told(pathlib.Path({str(path)!r}), {until!r})))\n"
    )
    done = subprocess.run([sys.executable, "-c", script], capture_output=True, text=True)
    assert done.returncode == 0, done.stderr
    return {name: tuple(one) for name, one in json.loads(done.stdout).items()}


def failures(found: dict[str, tuple[str, str]]) -> list[str]:
    return [name for name, (outcome, _) in found.items() if outcome == "failed"]


@pytest.mark.parametrize(
    "name",
    ["ParabolaDrive", "ParabolaPendulum", pytest.param("BeadOnWire", marks=pytest.mark.slow)],
)
def test_ours_pass(name: str, fmus: Path) -> None:
    found = told(fmus / f"{name}.fmu")
    assert failures(found) == [], found
    skipped = {check for check, (outcome, _) in found.items() if outcome == "skipped"}
    assert skipped == ({"bounds", "methods"} if name == "ParabolaDrive" else {"bounds"})
    assert "in another instance too" in found["states"][1]
    if name != "ParabolaDrive":
        assert found["methods"][1].startswith("errors relative to the largest value: ")
        assert "exact refused by its message" in found["methods"][1]
        assert "implicit 1" in found["methods"][1]


@pytest.mark.slow
def test_ours_with_a_changed_equation(interpreted_fmus: Path, changed: Callable) -> None:
    path = changed(
        interpreted_fmus / "BeadOnWire.fmu", "cartesian.py",
        "self.a1 = ey - factor * q1", "self.a1 = 1.001 * ey - factor * q1",
    )  # fmt: skip
    found = told_apart(path, "against_reference")
    assert failures(found) == ["against_reference"]
    assert "the start is right, so the equations" in found["against_reference"][1]


def test_ours_with_a_changed_reference(fmus: Path, changed: Callable) -> None:
    path = changed(fmus / "BeadOnWire.fmu", "/reference.csv", "\n0.01,0.999999", "\n0.01,0.998999")
    found = told(path, "against_reference")
    assert failures(found) == ["against_reference"]
    assert "the start is right, so the equations" in found["against_reference"][1]


def test_ours_with_a_wrong_start(fmus: Path, changed: Callable) -> None:
    path = changed(fmus / "BeadOnWire.fmu", "Description.xml", 'start="1.0"', 'start="2.0"')
    found = told(path, "starts")
    assert failures(found) == ["starts"]
    assert "starts at 1.0, the description says 2.0" in found["starts"][1]


def test_ours_that_restores_nothing(fmus: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(Instance, "restore", lambda self: None)
    found = told(fmus / "BeadOnWire.fmu", "states", stop=0.1)
    assert failures(found) == ["states"]
    assert found["states"][1].startswith("explicit_euler: ")
    assert "when the state is restored" in found["states"][1]


@pytest.mark.slow
def test_ours_with_a_broken_restore(interpreted_fmus: Path, changed: Callable) -> None:
    path = changed(
        interpreted_fmus / "BeadOnWire.fmu", "plant.py", "self.model.set_state(state[0])", "pass"
    )
    found = told_apart(path, "states")
    assert failures(found) == ["states"]
    assert "when the state is restored" in found["states"][1]


def test_a_truncated_file(fmus: Path, truncated: Callable) -> None:
    found = told(truncated(fmus / "BeadOnWire.fmu"))
    assert list(found) == failures(found) == ["description"]
    assert "cannot be read as an FMU" in found["description"][1]


def test_a_foreign_one_passes(foreign: Make) -> None:
    found = told(foreign("NONE"))
    assert failures(found) == [], found
    assert found["against_reference"][1].startswith("Oscillator_ref.csv: ")
    assert found["methods"] == ("skipped", "it has no enumeration solver.method")


@pytest.mark.parametrize(
    ("rows", "words"),
    [
        ("0,nan\n1,0\n", "its column x holds NaN or infinity"),
        ("0,0\n1,0\n0.5,0\n", "its times go back"),
        ("0,0\n1e9,0\n", "communication points, and a check takes 1000000 at most"),
    ],
)
def test_a_reference_that_is_none(rows: str, words: str, foreign: Make, tmp_path: Path) -> None:
    (tmp_path / "r.csv").write_text(f"time,x\n{rows}")
    found = told(foreign("NONE"), reference=tmp_path / "r.csv")
    assert words in " ".join(text for _, text in found.values()), found


@pytest.mark.parametrize(
    ("asked", "words"),
    [
        ({"stop": 0.0}, "no run from 0 s to 0 s"),
        ({"step": 0.0}, "by 0 s"),
        ({"stop": -1.0}, "-1 s"),
    ],
)
def test_zero_and_less_are_not_taken_for_what_the_fmu_has(
    asked: dict[str, float], words: str, foreign: Make
) -> None:
    outcome, text = told(foreign("NONE"), "simulation", **asked)["simulation"]
    assert outcome == "failed"
    assert words in text


def test_steps_that_cannot_be_run(foreign: Make) -> None:
    found = told(foreign("NONE"), "simulation", stop=1e9, step=1e-9)
    assert "communication points, and a check takes 1000000 at most" in found["simulation"][1]


@pytest.mark.parametrize(
    ("fault", "failed", "words"),
    [
        ("EQUATION", "against_reference", "Oscillator_ref.csv by up to 0.0"),
        ("START", "starts", "k starts at 2.0, the description says 1.0"),
        ("STATE", "states", "v is "),
        ("RESET", "reset", "v is "),
        ("NOT_A_NUMBER", "simulation", "x is nan at t = 0.6 s"),
    ],
)
def test_a_foreign_one_with_a_fault(fault: str, failed: str, words: str, foreign: Make) -> None:
    found = told(foreign(fault), failed)
    assert failed in failures(found)
    assert words in found[failed][1]


def test_a_given_reference_with_inputs_and_its_bound(foreign: Make, tmp_path: Path) -> None:
    """Held input 1 over the first step: x and v after it in closed form (Euler steps)."""
    x = v = 0.0
    rows = ["time,x,v", "0,0,0"]
    for k in range(200):
        x, v = x + 1e-3 * v, v + 1e-3 * ((1.0 if k < 100 else -2.0) - x)
        if k in (99, 199):
            rows.append(f"{(k + 1) / 1000!r},{x!r},{v!r}")
    (tmp_path / "r.csv").write_text("\n".join(rows))
    (tmp_path / "i.csv").write_text("time,u\n0,1\n0.1,-2\n")
    options = {"reference": tmp_path / "r.csv", "inputs": tmp_path / "i.csv"}
    start = {"x_start": 0.0}
    found = told(foreign("NONE"), "bounds", start=start, most={"x": 0.01}, **options)
    assert found["against_reference"][0] == "passed", found
    assert found["bounds"][0] == "passed"
    found = told(foreign("NONE"), "bounds", start=start, most={"x": 0.001}, **options)
    assert "0.001 is allowed (exceeded first at t = 0.1 s)" in found["bounds"][1]
    found = told(foreign("NONE"), "bounds", start=start, most={"xx": 1.0}, **options)
    assert "did you mean x?" in found["bounds"][1]


@pytest.mark.parametrize(
    ("fault", "failed", "words"),
    [
        ("CRASH", "simulation", "it ends the process with SIGABRT"),
        pytest.param("HANG", "simulation", "it had not ended after 8 s", marks=pytest.mark.slow),
        pytest.param("RANDOM", "process", "other bits in each process", marks=pytest.mark.slow),
    ],
)
def test_what_only_processes_show(fault: str, failed: str, words: str, foreign: Make) -> None:
    timeout = 8.0 if fault == "HANG" else 120.0
    report = check(str(foreign(fault)), "FMU", Request(), timeout=timeout)
    texts = {one.check: one.text for one in report.findings if one.outcome == "failed"}
    assert words in texts[failed]


def test_other_bits_of_one_output_in_another_process_are_told(
    foreign: Make, monkeypatch: pytest.MonkeyPatch
) -> None:
    sound, other = (FmuCheck(foreign(f), Request()).digest() for f in ("NONE", "EQUATION"))
    assert sound["v"] != other["v"]
    digests = iter((sound, {**sound, "v": other["v"]}))
    monkeypatch.setattr(run, "_worked", lambda *_, **__: ([{"digest": next(digests)}], ""))
    (finding,) = check("Oscillator.fmu", "FMU", Request()).findings
    assert finding == Finding("process", FAILED, "v: other bits in each process")


SCENE = """
from curvebound.cosim import Scene
scene = Scene("coarse", stop_time=1.0, step=0.05, needs={"bead.bead.x": 1e-6})
scene.add("bead", "BeadOnWire", {"solver.method": "rk4", "solver.step": 0.05})
"""


@pytest.fixture
def workers_here(monkeypatch: pytest.MonkeyPatch) -> None:
    """The workers' processes are this one."""

    def done_here(command: list[str], **_: object) -> subprocess.CompletedProcess[bytes]:
        worker.main(Path(command[-1]))
        return subprocess.CompletedProcess(command, 0, b"", b"")

    here = SimpleNamespace(run=done_here, TimeoutExpired=subprocess.TimeoutExpired)
    monkeypatch.setattr(run, "subprocess", here)


@pytest.mark.usefixtures("workers_here")
def test_json_junit_and_the_status(
    tmp_path: Path, capsys: pytest.CaptureFixture[str], foreign: Make
) -> None:
    (tmp_path / "coarse.py").write_text(SCENE)
    junit = tmp_path / "report.xml"
    words = [str(foreign("NONE")), str(tmp_path / "coarse.py")]
    assert main(["check", *words, "--json", "--junit", str(junit)]) == 1
    data = json.loads(capsys.readouterr().out)
    assert [one["passed"] for one in data["targets"]] == [True, False]
    assert data["passed"] is False
    (failed,) = [f for f in data["targets"][1]["findings"] if f["outcome"] == "failed"]
    assert failed["check"] == "needs"
    assert "The error of bead.bead.x reaches" in failed["text"]
    suites = ElementTree.parse(junit).getroot().findall("testsuite")
    assert [suite.get("failures") for suite in suites] == ["0", "1"]
    assert suites[1].find("testcase/failure").get("message") == failed["text"]  # type: ignore
    assert int(suites[0].get("skipped", "")) == len(suites[0].findall("testcase/skipped")) > 0


def test_a_sound_one_has_status_0_and_none_has_2(
    foreign: Make, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    assert main(["check", str(foreign("NONE")), "--max", "x=2"]) == 0
    assert "another process gives the same bits" in " ".join(capsys.readouterr().out.split())
    assert main(["check", str(tmp_path / "none.fmu")]) == 2
    assert main(["check", "bead_on_wir"]) == 2
    assert "did you mean bead_on_wire" in capsys.readouterr().err

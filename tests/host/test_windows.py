"""The C host and random sequences on Windows, under Wine: what Linux gives, but for rounding.

.ci/importers installs Wine, a compiler for Windows and Windows CPythons; without them these tests
are skipped.
"""

from __future__ import annotations

import os
import re
import shutil
import subprocess
from pathlib import Path

import pytest

from .conftest import HERE, Answers, parse
from .test_c_host import whole_run
from .test_failures import INITIALIZATION, INPUTS, around, failing_initializations, failing_steps
from .test_fuzz import letter
from .test_refusals import ORDER, started

TOOLS = Path(
    os.environ.get("CURVEBOUND_IMPORTERS") or Path.home() / ".cache" / "curvebound-importers"
)
CROSS = shutil.which("x86_64-w64-mingw32-gcc")
WINE = shutil.which("wine64") or shutil.which("wine")
VERSIONS = ("3.10", "3.11", "3.13")

pytestmark = [
    pytest.mark.slow,  # .ci/run waits for its installations before the slow tests
    pytest.mark.usefixtures("system_python"),
    pytest.mark.skipif(not WINE, reason="no Wine: run .ci/importers"),
    pytest.mark.skipif(not CROSS, reason="no compiler for Windows: run .ci/importers"),
]


def windows(path):
    """A path of this machine as Wine has it."""
    return f"Z:{path}"


def compile_for_windows(source, target, *flags):
    done = subprocess.run(
        [
            *(CROSS, "-std=c11", "-Wall", "-Wextra", "-O1", "-D__USE_MINGW_ANSI_STDIO=1"),
            *("-D_POSIX_C_SOURCE=200809L", *flags, HERE / source, "-o", target),
            *("-static", "-lpthread", "-lm"),
        ],
        capture_output=True,
        text=True,
    )
    assert done.returncode == 0, done.stderr
    assert not done.stderr, done.stderr
    return target


def python_folder(version):
    folder = TOOLS / "windows" / version
    if not folder.is_dir():
        pytest.skip(f"{folder} is not there: run .ci/importers")
    return folder


def wine(program, arguments, python, text="", timeout=600):
    """Run a Windows program; its streams are pipes, since Wine knows too little of files."""
    environment = {
        "PATH": "/usr/bin:/bin",
        "HOME": os.environ.get("HOME", "/"),
        "WINEPREFIX": str(TOOLS / "wine"),
        "WINEDEBUG": "-all",
    }
    if python:
        environment["CURVEBOUND_PYTHON"] = windows(python_folder(python))
    return subprocess.run(
        [WINE, program, *arguments],
        input=text,
        env=environment,
        capture_output=True,
        text=True,
        timeout=timeout,
    )


@pytest.fixture(scope="session")
def windows_host_program(tmp_path_factory):
    return compile_for_windows("host.c", tmp_path_factory.mktemp("windows") / "host.exe")


@pytest.fixture(scope="session")
def windows_host(windows_host_program):
    """Run commands, as for the host on Linux, in a host on Windows with that Python."""

    def run(commands, python):
        text = "".join((c if "\t" in c else c.replace(" ", "\t")) + "\n" for c in commands)
        text = re.sub(
            r"(\tfile://)?(/[^\t\n]*)/binaries/linux64/([^\t\n]*)\.so",
            r"Z:\2/binaries/win64/\3.dll",
            text,
        )
        text = text.replace("\tfile:///", "\tfile:///Z:/")
        done = wine(windows_host_program, [], python, text)
        answers, logs = parse(done.stdout)
        result = Answers(done.returncode, done.stderr, answers, logs)
        assert done.returncode == 0, (done.returncode, done.stdout[-2000:], done.stderr[-2000:])
        assert len(answers) >= len(commands), done.stdout[-2000:]
        return result

    return run


NUMBER = re.compile(r"-?\b\d+(?:\.\d+)?(?:e[-+]?\d+)?\b")


def assert_same_words(one, other, tolerance):
    """Texts equal but for drives of paths, and for numbers that differ by rounding."""
    one, other = (text.replace("/Z:", "").replace("Z:", "") for text in (one, other))
    assert NUMBER.sub("#", one) == NUMBER.sub("#", other)
    for a, b in zip(NUMBER.findall(one), NUMBER.findall(other), strict=True):
        assert float(a) == pytest.approx(float(b), rel=tolerance, abs=tolerance)


def assert_same(one, other, tolerance=1e-12):
    """Two hosts' answers: the same statuses and messages, and the same numbers but for rounding."""
    for k, (mine, theirs) in enumerate(zip(one.answers, other.answers, strict=True)):
        assert_same_words(" ".join(mine), " ".join(theirs), tolerance)
        assert [m[:3] for m in one.logs[k]] == [m[:3] for m in other.logs[k]]
        for a, b in zip(one.logs[k], other.logs[k], strict=True):
            assert_same_words(a[3], b[3], 1e-9)


def test_the_binary_needs_nothing_but_windows(bead):
    library = bead.folder / "binaries" / "win64" / f"{bead.identifier}.dll"
    objdump = CROSS.removesuffix("gcc") + "objdump"
    done = subprocess.run([objdump, "-p", library], capture_output=True, text=True, check=True)
    needed = set(re.findall(r"DLL Name: (\S+)", done.stdout))
    assert needed <= {"KERNEL32.dll", "msvcrt.dll", "ADVAPI32.dll"}
    table = done.stdout.split("[Ordinal/Name Pointer] Table", 1)[1].split("\n\n", 1)[0]
    exported = [line.split()[-1] for line in table.splitlines() if "[" in line]
    assert len(exported) == 34
    assert all(name.startswith("fmi2") for name in exported)


@pytest.mark.parametrize("python", VERSIONS)
@pytest.mark.parametrize("name", ["BeadOnWire", "ParabolaPendulum", "ParabolaDrive"])
def test_valid_runs_give_linux_numbers(host, windows_host, fmus, name, python):
    commands = whole_run(fmus[name], fmus[name].outputs())
    result = windows_host(commands, python)
    assert result.messages == []  # nor that it runs interpreted
    assert_same(result, host(commands))


@pytest.mark.parametrize("python", VERSIONS)
def test_without_its_compiled_kernel_an_fmu_says_so(windows_host, copy_of, bead, python):
    """So the runs without this message were compiled ones."""
    fmu = copy_of(bead, "interpreted")
    kernels = list((fmu.folder / "resources").glob("*.pyd"))
    assert len(kernels) == 2
    for kernel in kernels:
        kernel.unlink()
    (message,) = windows_host(fmu.start(), python).messages
    assert "runs interpreted" in message[3]
    assert f"cpython {python}." in message[3]


@pytest.mark.parametrize("name", ["BeadOnWire", "ParabolaPendulum", "ParabolaDrive"])
def test_failures_are_those_of_linux(host, windows_host, fmus, name):
    fmu = fmus[name]
    cases = [(n, value) for n, values in INITIALIZATION[name].items() for value in values]
    for commands in (
        failing_initializations(fmu, cases),
        around(fmu, failing_steps(fmu, INPUTS[name])),
    ):
        assert_same(windows_host(commands, "3.11"), host(commands))


def test_refusals_are_those_of_linux(host, windows_host, bead, pendulum):
    commands = [f"load 0 {bead.binary}", f"load 1 {pendulum.binary}"]
    for wrong, _ in ORDER:
        commands += [bead.new(), *wrong, "free 0"]
    for name, guid, uri in (
        ("a", "{wrong}", bead.uri),
        ("NULL", bead.guid, bead.uri),
        ("a", bead.guid, "file:///nowhere/resources"),
        ("a", bead.guid, "http://localhost/tmp"),
        ("a", bead.guid, "resources"),
        ("a", bead.guid, "file:///tmp/%00"),
    ):
        commands.append("\t".join(("new", "0", "0", name, guid, uri, "0")))
    derivatives = f"derivatives 0 {bead.vr['wire.ax']} {bead.vr['bead.x']}"
    commands += [*started(bead)[1:], "misuse 0", derivatives, "status 0", "step 0 0 0.1"]
    commands += [pendulum.new(1, 1), "save 0 0", "write 0 0 0", "length 0"]
    commands += ["flip 0 70", "read 0 0 1", "flip 0 70", "read 0 0 1", "restore 0 1", "restore 1 0"]
    commands += ["read 1 0 2", "drop 0 0", "restore 0 0", "step 0 0.1 0.1", "status 0"]
    commands += ["free 0", pendulum.new(1, 0), "strange 0"]
    assert_same(windows_host(commands, "3.11"), host(commands))


def test_instances_in_threads(host, windows_host, bead):
    vr = bead.vr["bead.x"]
    commands = [f"load 0 {bead.binary}", f"parallel 0 8 200 {bead.guid} {bead.uri} {vr}"]
    assert_same(windows_host(commands, "3.11"), host(commands))


def test_without_any_python_the_message_says_what_was_tried(windows_host, bead):
    result = windows_host([*bead.start(), bead.new()], None)
    assert result.answers == [["OK"], ["Error"], ["Error"]]
    text = result.messages[0][3]
    for place in ("CURVEBOUND_PYTHON", "registry", "PATH"):
        assert place in text


def test_a_python_of_the_registry(windows_host, bead):
    folder = python_folder("3.13")
    key = r"HKCU\Software\Python\PythonCore\3.13\InstallPath"
    added = wine("reg", ["add", key, "/ve", "/d", windows(folder), "/f"], None)
    assert added.returncode == 0, added.stderr
    try:
        commands = [*bead.start(), *started(bead)[2:], "step 0 0 0.1"]
        assert [a[0] for a in windows_host(commands, None).answers] == ["OK"] * 6
    finally:
        wine("reg", ["delete", r"HKCU\Software\Python", "/f"], None)


def fuzz(fmus, name, count, tmp_path, python):
    fmu = fmus[name]
    other = next(f for n, f in fmus.items() if n != name)
    program = compile_for_windows("fuzz.c", tmp_path / "fuzz.exe")
    variables = tmp_path / "variables.txt"
    lines = [
        f"{v.get('valueReference')} {letter(v)} {v.get('causality')[0]}" for v in fmu.variables
    ]
    variables.write_text("\n".join(lines) + "\n")
    arguments = [os.environ.get("FUZZ_SEED", "21"), "0", str(count), name]
    for one in (fmu, other):
        library = one.folder / "binaries" / "win64" / f"{one.identifier}.dll"
        arguments += [windows(library), one.guid, one.uri.replace("file:///", "file:///Z:/")]
        if one is fmu:
            arguments.append(windows(variables))
    done = wine(program, arguments, python, timeout=3000)
    assert done.returncode == 0, f"{done.stdout[-3000:]}\n{done.stderr[-3000:]}"
    assert f"{name}: {count} sequences" in done.stdout


@pytest.mark.parametrize(
    ("name", "python"),
    [("BeadOnWire", "3.10"), ("ParabolaPendulum", "3.11"), ("ParabolaDrive", "3.13")],
)
def test_random_sequences(fmus, name, python, tmp_path):
    """FUZZ_COUNT of them each: 6700 make the twenty thousand, which take a quarter of an hour."""
    fuzz(fmus, name, int(os.environ.get("FUZZ_COUNT", "1000")), tmp_path, python)

"""The FMUs in a process without Python: a plain C host."""

from __future__ import annotations

import os
import re
import subprocess
import sys
from pathlib import Path

import pytest
from fmpy.fmi2 import FMU2Slave

from curvebound.fmi.compile import why_not

pytestmark = pytest.mark.usefixtures("system_python")

PLAIN = {"PATH": "/usr/bin:/bin"}


def whole_run(fmu, vrs, count=20):
    """The commands of a simulation from instantiation to the end."""
    show = " ".join(map(str, vrs))
    return [
        *fmu.start(),
        "setup 0 - 0 -",
        "enter 0",
        "exit 0",
        f"get 0 {show}",
        *(f"steps 0 {k * 0.05!r} 0.05 1 {show}" for k in range(count)),
        "terminate 0",
        "free 0",
    ]


def rows(result):
    return [[float(x) for x in a[1:]] for a in result.answers if len(a) > 1]


def slave_of(fmu):
    """An initialised instance in fmpy."""
    slave = FMU2Slave(
        guid=fmu.guid,
        unzipDirectory=str(fmu.folder),
        modelIdentifier=fmu.identifier,
        instanceName="fmpy",
    )
    slave.instantiate()
    slave.setupExperiment(startTime=0.0)
    slave.enterInitializationMode()
    slave.exitInitializationMode()
    return slave


def in_fmpy(fmu, vrs, count=20):
    slave = slave_of(fmu)
    values = [slave.getReal(vrs)]
    for k in range(count):
        slave.doStep(k * 0.05, 0.05)
        values.append(slave.getReal(vrs))
    slave.terminate()
    slave.freeInstance()
    return values


@pytest.mark.parametrize(
    "name",
    [
        "ParabolaPendulum",
        *(pytest.param(n, marks=pytest.mark.slow) for n in ("BeadOnWire", "ParabolaDrive")),
    ],
)
def test_a_plain_environment_gives_fmpys_numbers(host, fmus, name):
    vrs = fmus[name].outputs()
    result = host(whole_run(fmus[name], vrs), PLAIN)
    assert result.status == 0
    assert result.error == ""
    assert result.messages == []
    assert rows(result) == in_fmpy(fmus[name], vrs)


def test_a_virtual_environment_first_on_path(host, bead, tmp_path):
    subprocess.run(
        ["/usr/bin/python3", "-m", "venv", "--without-pip", str(tmp_path / "venv")], check=True
    )
    vrs = bead.outputs()
    environment = {"PATH": f"{tmp_path}/venv/bin:/usr/bin:/bin"}
    assert rows(host(whole_run(bead, vrs), environment)) == in_fmpy(bead, vrs)


def test_the_interpreter_of_these_tests_first_on_path(host, bead):
    environment = {"PATH": f"{Path(sys.executable).parent}:/usr/bin:/bin"}
    vrs = bead.outputs()
    assert rows(host(whole_run(bead, vrs), environment)) == in_fmpy(bead, vrs)


def test_the_tools_own_python_variables_do_no_harm(host, bead):
    environment = {
        **PLAIN,
        "PYTHONHOME": "/nowhere",
        "PYTHONPATH": "/nowhere",
        "PYTHONMALLOC": "bad",
    }
    assert host(whole_run(bead, bead.outputs()), environment).status == 0


def private_python(environment):
    """The libpython that a host with this environment maps, by its own account."""
    return {"LD_DEBUG": "files", **environment}


def loaded_python(result):
    found = re.findall(r"calling init: (\S*libpython3\.\d+\S*)", result.error)
    return found[-1] if found else None


def libraries():
    """Those of CPython in the usual folders."""
    found = sorted(
        path
        for folder in (
            "/usr/lib",
            "/usr/lib64",
            "/usr/local/lib",
            os.path.join(sys.base_prefix, "lib"),
        )
        for place in ("", "*/")
        for path in Path(folder).glob(f"{place}libpython3.1[0-9].so.1.0")
    )
    return found or pytest.skip("no libpython in the usual folders")


def test_the_environment_variable_comes_first(host, bead):
    for library in libraries():
        environment = private_python({**PLAIN, "CURVEBOUND_PYTHON": str(library)})
        result = host(whole_run(bead, bead.outputs(), 2), environment)
        assert os.path.realpath(loaded_python(result)) == os.path.realpath(library)


def test_a_library_whose_program_tells_a_wrong_prefix_has_its_own(host, bead, tmp_path):
    program = tmp_path / "python"
    library = libraries()[0]
    program.write_text(f"#!/bin/sh\nprintf '%s\\n' {program} {tmp_path} {library}\n")
    program.chmod(0o755)
    environment = private_python({**PLAIN, "CURVEBOUND_PYTHON": str(program)})
    result = host(whole_run(bead, bead.outputs(), 2), environment)
    assert result.answers[-1] == ["OK"]
    assert os.path.realpath(loaded_python(result)) == os.path.realpath(library)


def test_an_unusable_choice_is_passed_over(host, bead, tmp_path):
    for choice in (tmp_path / "missing.so", tmp_path / "missing", tmp_path, bead.binary):
        environment = {**PLAIN, "CURVEBOUND_PYTHON": str(choice)}
        assert host(bead.start(), environment).answers[-1] == ["OK"]


def test_without_any_python_the_message_names_what_was_tried(host, bead, tmp_path):
    for minor in range(10, 15):  # found before the system's, and not loadable
        (tmp_path / f"libpython3.{minor}.so.1.0").touch()
    environment = {"PATH": "/nowhere", "LD_LIBRARY_PATH": str(tmp_path)}
    result = host([*bead.start(), "new 1 0 again " + f"{bead.guid} {bead.uri} 0"], environment)
    assert result.answers == [["OK"], ["Error"], ["Error"]]
    instance, status, _, text = result.messages[0]
    assert (instance, status) == ("i0", "Error")
    places = [
        text.index(x) for x in ("CURVEBOUND_PYTHON", "python3 on PATH", "libpython3.13.so.1.0")
    ]
    assert places == sorted(places)
    assert len(result.messages) == 2


def test_loading_and_unloading_repeatedly(host, bead, pendulum):
    once = [*bead.start(0, 0), "free 0", "unload 0", *pendulum.start(1, 1), "free 1", "unload 1"]
    assert host([*once, *once, *once]).status == 0
    # ended with everything still in use
    assert host([*bead.start(0, 0), *pendulum.start(1, 1), "setup 0 - 0 -", "enter 0"]).status == 0


def test_instances_in_threads(host, bead):
    vr = bead.vr["bead.x"]
    result = host([f"load 0 {bead.binary}", f"parallel 0 8 200 {bead.guid} {bead.uri} {vr}"])
    answer = result.answers[-1]
    assert answer[::2] == ["OK"] * 8
    assert len(set(answer[1::2])) == 1


@pytest.mark.parametrize("count", [2000, pytest.param(10000, marks=pytest.mark.slow)])
def test_thousands_of_instances_cost_little_memory(host, bead, count):
    commands = [f"load 0 {bead.binary}", f"churn 0 {count} {bead.guid} {bead.uri}"]
    status, growth = host(commands).answers[-1]
    print(f"{growth} bytes stay of each of {count} instances")
    assert status == "OK"
    assert float(growth) < 300.0


def test_sys_path_does_not_grow(bead):
    before = sys.path[:]
    resources = str(bead.binary.parents[2] / "resources")
    instances = [slave_of(bead) for _ in range(3)]
    assert sys.path == [resources, *before]
    for instance in instances:
        instance.freeInstance()
    assert sys.path == before
    assert resources not in sys.path_importer_cache


def test_the_binary_runs_on_older_systems(bead):
    """It needs no glibc newer than of 2012, and no other library."""
    done = subprocess.run(
        ["objdump", "-T", bead.binary], capture_output=True, text=True, check=True
    )
    defined = {
        line.split()[-1] for line in done.stdout.splitlines() if " g " in line and ".text" in line
    }
    assert all(name.startswith("fmi2") for name in defined)
    assert bead.binary.stat().st_size < 64_000
    done = subprocess.run(
        ["objdump", "-p", bead.binary], capture_output=True, text=True, check=True
    )
    needed = set(re.findall(r"NEEDED +(\S+)", done.stdout))
    assert needed <= {"libc.so.6", "libdl.so.2", "libpthread.so.0"}


@pytest.mark.parametrize("name", ["BeadOnWire", "ParabolaPendulum", "ParabolaDrive"])
def test_nothing_in_an_fmu_needs_a_system_newer_than_of_2012(fmus, name):
    """Neither the binary nor the compiled kernel: symbols of glibc 2.17 at most, none of C++."""
    folder = fmus[name].folder
    files = [*(folder / "binaries" / "linux64").iterdir(), *(folder / "resources").rglob("*")]
    libraries = [f for f in files if f.is_file() and f.read_bytes()[:4] == b"\x7fELF"]
    assert len(libraries) == (1 if why_not() else 3)
    for library in libraries:
        done = subprocess.run(
            ["objdump", "-T", library], capture_output=True, text=True, check=True
        )
        versions = re.findall(r"GLIBC_([0-9.]+)", done.stdout)
        assert max(tuple(map(int, v.split("."))) for v in versions) <= (2, 17), library
        assert "GLIBCXX" not in done.stdout
        assert "CXXABI" not in done.stdout


def test_an_old_cpp_library_first_on_the_path_does_no_harm(host, compile_host, bead, tmp_path):
    compile_host("stub.c", tmp_path / "libstdc++.so.6", "-shared", "-fPIC")
    vrs = bead.outputs()
    environment = {**PLAIN, "LD_LIBRARY_PATH": str(tmp_path)}
    assert rows(host(whole_run(bead, vrs), environment)) == in_fmpy(bead, vrs)


# -- the same code and other code side by side


@pytest.fixture(scope="module")
def alone(host, fmus):
    """What each FMU gives in a process of its own."""
    return {name: rows(host(whole_run(f, f.outputs(), 5))) for name, f in fmus.items()}


@pytest.mark.parametrize("scope", ["RTLD_LOCAL", "RTLD_GLOBAL"])
def test_several_fmus_in_one_process(
    host, host_program, compile_host, fmus, alone, scope, tmp_path
):
    program = host_program  # of RTLD_LOCAL
    if scope == "RTLD_GLOBAL":
        program = compile_host("host.c", tmp_path / "host", f"-DSCOPE={scope}")
    commands = []
    for k, fmu in enumerate(fmus.values()):
        commands += [*fmu.start(k, k), f"setup {k} - 0 -", f"enter {k}", f"exit {k}"]
        commands += [f"get {k} {' '.join(map(str, fmu.outputs()))}"]
    for step in range(5):
        for k, fmu in enumerate(fmus.values()):
            commands += [f"steps {k} {step * 0.05!r} 0.05 1 {' '.join(map(str, fmu.outputs()))}"]
    together = rows(host(commands, program=program))
    n = len(fmus)
    for k, name in enumerate(fmus):
        assert [together[k], *together[n + k :: n]] == alone[name]


@pytest.fixture(scope="module")
def two_builds(interpreted_fmus, edited_bead, tmp_path_factory, unpack):
    """BeadOnWire as it is, and from sources with another factor in the kinetic energy."""
    return [
        unpack(path, tmp_path_factory.mktemp("bead"))
        for path in (interpreted_fmus / "BeadOnWire.fmu", edited_bead)
    ]


def assert_own_results(own, other):
    """Kinetic energies of a run each: positive, and in the ratio of the two factors."""
    assert all(x > 0.0 for x in own)
    assert other == pytest.approx([1.002 * x for x in own], rel=1e-14)


def test_two_builds_interleaved_in_the_c_host(host, two_builds):
    vr = two_builds[0].vr["energy.kinetic"]
    commands = []
    for k, fmu in enumerate(two_builds):
        commands += [*fmu.start(k, k), f"setup {k} - 0 -", f"enter {k}", f"exit {k}"]
    for step in range(10):
        commands += [f"steps {k} {step * 0.1!r} 0.1 1 {vr}" for k in (0, 1)]
    values = [row[0] for row in rows(host(commands))]
    assert_own_results(values[0::2], values[1::2])


def test_two_builds_interleaved_in_fmpy(two_builds):
    slaves = [slave_of(fmu) for fmu in two_builds]
    values = ([], [])
    for step in range(10):
        for k in (0, 1):
            slaves[k].doStep(step * 0.1, 0.1)
            values[k].extend(slaves[k].getReal([two_builds[k].vr["energy.kinetic"]]))
    for slave in slaves:
        slave.terminate()
        slave.freeInstance()
    assert_own_results(*values)

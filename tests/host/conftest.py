"""The C host, the FMUs it loads, and a way to talk to it."""

from __future__ import annotations

import inspect
import shutil
import subprocess
import sys
import urllib.parse
import xml.etree.ElementTree as ET
import zipfile
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path

import heap
import pytest
from pythonfmu.builder import FmuBuilder

from curvebound.compiling.toolchain import compiler
from curvebound.fmi.binaries import compile_binary, why_not
from curvebound.fmi.folder import names

HERE = Path(__file__).parent
PLAIN = {"PATH": "/usr/bin:/bin"}


@dataclass
class Unpacked:
    """An FMU in a folder of its own."""

    folder: Path
    guid: str
    identifier: str
    #: name -> value reference
    vr: dict[str, int]
    #: the ScalarVariable elements
    variables: list[ET.Element] = field(repr=False)

    @property
    def binary(self) -> Path:
        return self.folder / "binaries" / "linux64" / f"{self.identifier}.so"

    @property
    def uri(self) -> str:
        return "file://" + urllib.parse.quote(f"{self.folder}/resources")

    def outputs(self) -> list[int]:
        """Value references of the Real outputs."""
        return [
            self.vr[v.get("name", "")]
            for v in self.variables
            if v.get("causality") == "output" and v.find("Real") is not None
        ]

    def start(self, fmu: int = 0, instance: int = 0, *, logging: int = 0) -> list[str]:
        """The commands that load the FMU and instantiate it."""
        return [f"load {fmu} {self.binary}", self.new(fmu, instance, logging=logging)]

    def new(self, fmu: int = 0, instance: int = 0, *, logging: int = 0) -> str:
        return f"new {instance} {fmu} i{instance} {self.guid} {self.uri} {logging}"


def unpacked(archive: Path, folder: Path) -> Unpacked:
    with zipfile.ZipFile(archive) as content:
        content.extractall(folder)
    root = ET.parse(folder / "modelDescription.xml").getroot()
    simulation = root.find("CoSimulation")
    assert simulation is not None
    variables = root.findall("ModelVariables/ScalarVariable")
    return Unpacked(
        folder,
        root.get("guid", ""),
        simulation.get("modelIdentifier", ""),
        {v.get("name", ""): int(v.get("valueReference", "")) for v in variables},
        variables,
    )


@dataclass
class Answers:
    """What the host said: one answer for each command, and the log messages before it."""

    status: int
    error: str
    answers: list[list[str]]
    logs: list[list[tuple[str, str, str, str]]]

    @property
    def messages(self) -> list[tuple[str, str, str, str]]:
        """All log messages: instance, status, category, text."""
        return [message for group in self.logs for message in group]


def parse(output: str) -> tuple[list[list[str]], list[list[tuple[str, str, str, str]]]]:
    answers: list[list[str]] = []
    logs: list[list[tuple[str, str, str, str]]] = []
    pending: list[tuple[str, str, str, str]] = []
    for line in output.splitlines():
        if line.startswith("LOG\t"):
            instance, status, category, text = line[4:].split("\t", 3)
            pending.append((instance, status, category, text))
        elif line.startswith("="):
            answers.append(line[1:].split())
            logs.append(pending)
            pending = []
        elif pending:  # a message of several lines
            pending[-1] = (*pending[-1][:3], f"{pending[-1][3]}\n{line}")
        else:
            answers.append(["Error", line])
    return answers, logs


def compile_c(source: Path, target: Path, *flags: str) -> Path:
    command = compiler()
    if command is None or sys.platform != "linux":
        pytest.skip("no C compiler on Linux here")
    done = subprocess.run(
        [
            *command,
            "-std=c11",
            "-Wall",
            "-Wextra",
            *flags,
            str(source),
            "-o",
            str(target),
            "-ldl",
            "-lpthread",
        ],
        capture_output=True,
        text=True,
    )
    assert done.returncode == 0, done.stderr
    assert not done.stderr, done.stderr
    return target


@pytest.fixture(scope="session")
def compile_host() -> Callable[..., Path]:
    """Compile a C source of this folder: name, target, flags."""
    return lambda name, target, *flags: compile_c(HERE / name, target, *flags)


@pytest.fixture(scope="session")
def host_program(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The compiled host."""
    return compile_c(HERE / "host.c", tmp_path_factory.mktemp("host") / "host", "-O1", "-g")


Host = Callable[..., Answers]


_LIBRARY = """
from sysconfig import get_config_var
print(get_config_var("LIBDIR"), get_config_var("INSTSONAME"), sep="/")
"""


@pytest.fixture(scope="session")
def host(host_program: Path) -> Host:
    """Run commands in a fresh host process: host(commands, environment, program=..., check=True).

    Words of a command are separated by spaces, or by tabs where it has any. Without an environment
    it need not look for the system's Python, which takes a process each time.
    """
    asked = subprocess.run(
        ["python3", "-c", _LIBRARY], env=PLAIN, capture_output=True, text=True, check=True
    )
    known = {**PLAIN, "CURVEBOUND_PYTHON": asked.stdout.strip()}

    def run(
        commands: Sequence[str],
        environment: Mapping[str, str] = known,
        *,
        program: Path = host_program,
        check: bool = True,
    ) -> Answers:
        text = "".join((c if "\t" in c else c.replace(" ", "\t")) + "\n" for c in commands)
        done = subprocess.run(
            [str(program)],
            input=text,
            env=dict(environment),
            capture_output=True,
            text=True,
            timeout=120,
        )
        answers, logs = parse(done.stdout)
        result = Answers(done.returncode, done.stderr, answers, logs)
        if check:
            assert done.returncode == 0, (done.returncode, done.stdout[-2000:], done.stderr[-2000:])
            assert len(answers) >= len(commands), done.stdout[-2000:]
        return result

    return run


@pytest.fixture(scope="session")
def system_python(host: Host, bead: Unpacked) -> None:
    """Skip where the system's python3 has no shared library that the host could load."""
    result = host(bead.start())
    if result.answers[-1] != ["OK"] and "no usable libpython" in result.messages[-1][3]:
        pytest.skip(result.messages[-1][3])


@pytest.fixture(scope="session")
def built(fmu_folder: Path) -> dict[str, Path]:
    """The FMUs of this project, built."""
    if compile_binary() is None:
        pytest.skip(why_not())
    return {name: fmu_folder / f"{name}.fmu" for name in names()}


@pytest.fixture(scope="session")
def fmus(built: dict[str, Path], tmp_path_factory: pytest.TempPathFactory) -> dict[str, Unpacked]:
    """The FMUs of this project, unpacked."""
    return {name: unpacked(path, tmp_path_factory.mktemp(name)) for name, path in built.items()}


@pytest.fixture(scope="session")
def unpack() -> Callable[[Path, Path], Unpacked]:
    """Unpack an archive into a folder."""
    return unpacked


@pytest.fixture(scope="session")
def bead(fmus: dict[str, Unpacked]) -> Unpacked:
    return fmus["BeadOnWire"]


@pytest.fixture(scope="session")
def pendulum(fmus: dict[str, Unpacked]) -> Unpacked:
    return fmus["ParabolaPendulum"]


@pytest.fixture
def copy_of(tmp_path: Path) -> Callable[[Unpacked, str], Unpacked]:
    """Copy an unpacked FMU into a folder of the given name."""

    def copy(fmu: Unpacked, name: str) -> Unpacked:
        folder = tmp_path / name
        shutil.copytree(fmu.folder, folder)
        return Unpacked(folder, fmu.guid, fmu.identifier, fmu.vr, fmu.variables)

    return copy


_ODD = '''
import gc
import weakref

from pythonfmu import Fmi2Causality, Fmi2Slave, Integer, Real, String
from pythonfmu.enums import Fmi2Status

GIVEN = []  # weak references to what the binary was given


class Text(str):
    """A text of which is known whether it is still there."""


class List(list):
    """A list of which is known, too."""


def given(*objects):
    GIVEN.extend(map(weakref.ref, objects))
    return objects[0]


def alive():
    gc.collect()  # classes are cycles
    return sum(one() is not None for one in GIVEN)


class Odd(Fmi2Slave):
    """Does what `act` says, in the way that PythonFMU's users do."""

    def __init__(self, **kwargs):
        super().__init__(**kwargs)
        self.act = 0
        self.y = 1.5
        self.text = "a"
        self.register_variable(Integer("act", causality=Fmi2Causality.parameter))
        self.register_variable(Real("y", causality=Fmi2Causality.output))
        self.register_variable(String("text", causality=Fmi2Causality.parameter))
        counts = {"given": lambda: len(GIVEN), "alive": alive, "heap": heap}
        for name, count in counts.items():
            self.register_variable(Integer(name, causality=Fmi2Causality.output, getter=count))

    def get_real_output_derivatives(self, vrs, orders):
        return given(List([0.25] * len(vrs)))

    def fail(self):
        """Raise an exception; it, its class, its text and what its frame holds are GIVEN."""
        class Own(Exception):
            def __repr__(self):
                return given(Text("Own()"))

        error, local = Own(), Text("of the frame")
        given(error, local, Own)
        try:
            raise error
        finally:
            del error  # it holds its frame

    def perform(self, where):
        if self.act == 1:
            raise ValueError(f"raised in {where}, 100 %s %n of it")
        if self.act == 2:
            self.log(f"failed in {where}: 100 %s %n of it", Fmi2Status.error)
            return False
        if self.act == 3:
            return False
        if self.act == 4:
            self.log(f"noted in {where} at 5 %", Fmi2Status.ok)
            self.log("mind the %s%n", Fmi2Status.warning)
            self.log("own", Fmi2Status.ok, "mine")
        if self.act == 5:
            self.fail()
        return True

    def enter_initialization_mode(self):
        if self.act > 10:
            self.act -= 10
            self.perform("initialization")
            self.act += 10

    def do_step(self, time, step):
        self.y += step
        return self.perform("the step")
'''


@pytest.fixture(scope="session")
def odd(tmp_path_factory: pytest.TempPathFactory) -> Unpacked:
    """A plain PythonFMU FMU with the binary of this project, which fails as it is told."""
    folder = tmp_path_factory.mktemp("odd")
    library = compile_binary()
    if library is None:
        pytest.skip(why_not())
    (folder / "odd_slave.py").write_text(inspect.getsource(heap) + _ODD)
    before = sys.path[:]
    archive = FmuBuilder.build_FMU(folder / "odd_slave.py", dest=folder)
    sys.path[:] = before
    fmu = unpacked(archive, folder / "unpacked")
    shutil.copy(library, fmu.binary)
    return fmu

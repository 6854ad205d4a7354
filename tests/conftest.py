"""What the tests of built FMUs share: the FMUs themselves, built and extracted once a session."""

from __future__ import annotations

import gc
import os
import shutil
import sys
from collections.abc import Callable, Iterator, Sequence
from functools import cache, partial, partialmethod
from pathlib import Path

import pytest
from harness import Extracted, Instance
from source_copies import build_edited, copy_sources, declarations, with_short_reference

from curvebound.fmi import compile as kernel
from curvebound.fmi import documentation
from curvebound.fmi.build import build
from curvebound.fmi.compile import why_not
from curvebound.fmi.folder import find
from curvebound.fmi.reference import ReferenceResult, reference_result
from curvebound.locks import locked
from curvebound.study.runner import Runner
from curvebound.study.sweep.task import Point, Row, Task, run_points

SLOW_LIMIT = 1800  # s that a slow test may take

NAMES = ("BeadOnWire", "ParabolaDrive", "ParabolaPendulum")


def pytest_collection_modifyitems(items: list[pytest.Item]) -> None:
    for item in items:
        if item.get_closest_marker("slow") and not item.get_closest_marker("timeout"):
            item.add_marker(pytest.mark.timeout(SLOW_LIMIT))


def pytest_collection_finish() -> None:
    """What was collected stays to the end: no garbage collection looks through it again."""
    gc.collect()
    gc.freeze()


@pytest.hookimpl(wrapper=True)
def pytest_runtest_makereport(item: pytest.Item) -> Iterator[None]:
    """Where everything is installed (CI=true, see .ci/run), a skipped test is a failed one."""
    report = yield
    if report.skipped and os.environ.get("CI") == "true" and not hasattr(report, "wasxfail"):
        report.outcome = "failed"
        report.longrepr = f"skipped though CI=true: {report.longrepr[-1]}"
    return report


def shared(factory: pytest.TempPathFactory, name: str, make: Callable[[Path], None]) -> Path:
    """The folder `name` of this run, filled by make(folder) in one of the processes that test."""
    base = factory.getbasetemp()
    folder = (base.parent if "PYTEST_XDIST_WORKER" in os.environ else base) / name
    with locked(folder.with_suffix(".lock"), wait=True):
        if not folder.is_dir():
            scratch = folder.with_suffix(".part")
            make(scratch)
            scratch.rename(folder)
    return folder


@cache
def _reference(name: str) -> ReferenceResult:
    return reference_result(find(name).fmu())


def _share_references(patch: pytest.MonkeyPatch) -> None:
    patch.setattr(documentation, "reference_result", lambda fmu: _reference(fmu.name))


def _built(folder: Path, *, compiled: bool) -> None:
    with pytest.MonkeyPatch.context() as patch:
        _share_references(patch)
        for name in NAMES:
            build(name, folder, compiled=compiled)


@pytest.fixture(autouse=True, scope="module")
def _same_sys_path() -> Iterator[None]:
    """PythonFMU's wrapper puts a folder into sys.path for each instance: other modules' tests, and
    the processes they start, shall not search a thousand deleted folders at every import."""
    before = sys.path[:]
    yield
    sys.path[:] = before


@pytest.fixture
def interpreting(monkeypatch: pytest.MonkeyPatch) -> None:
    """What this process builds runs interpreted: no minute of compiling for a second's run."""
    monkeypatch.setattr(kernel, "why_not", lambda *_, **__: "this test runs interpreted")


@pytest.fixture
def short_reference(monkeypatch: pytest.MonkeyPatch) -> None:
    """What this process builds has a reference result of one step: most of the time of a build.

    Not where an FMU of the package's own systems goes into the cache.
    """
    short = with_short_reference(documentation.reference_result)
    monkeypatch.setattr(documentation, "reference_result", short)


@pytest.fixture
def one_reference(monkeypatch: pytest.MonkeyPatch) -> None:
    """What this process builds of the package's own systems shares their reference results."""
    _share_references(monkeypatch)


@pytest.fixture
def points_here(monkeypatch: pytest.MonkeyPatch) -> None:
    """Points of sweeps are run in this process: starting workers takes most of a short one."""

    def run(task: Task, points: Sequence[Point], workers: int) -> Iterator[list[Row]]:
        for point in points:
            yield run_points(task, [point])

    monkeypatch.setattr("curvebound.study.sweep.engine.run_locally", run)


@pytest.fixture
def timed_once(monkeypatch: pytest.MonkeyPatch) -> None:
    """What a setting costs is taken from one run, where a test does not look at costs."""
    monkeypatch.setattr(Runner, "cost", partialmethod(Runner.cost, runs=1, enough=0.0))


@pytest.fixture(scope="session")
def fmu_folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Folder of the three built FMUs, compiled where a C compiler is found."""
    return shared(tmp_path_factory, "fmus", partial(_built, compiled=not why_not()))


@pytest.fixture(scope="session")
def fmus(fmu_folder: Path) -> Path:
    """The same, where a folder's own tests do not take the name for something else."""
    return fmu_folder


@pytest.fixture(scope="session")
def interpreted_fmus(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Folder of the three FMUs, built without compiling the kernel."""
    return shared(tmp_path_factory, "interpreted", partial(_built, compiled=False))


def _edited(folder: Path) -> None:
    package = copy_sources(folder)
    system = declarations(package) / "bead_on_wire" / "base.py"
    edits = {
        # too little for a warning
        "system": (system, "kinetic = 0.5 *", "kinetic = 0.501 *"),
        "kernel": (package / "kernel" / "rk4.py", "0.5 * h", "0.50 * h"),
    }
    build_edited(package, folder, edits, "BeadOnWire", "ParabolaDrive")


@pytest.fixture(scope="session")
def edited(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Bead and drive, interpreted, from edited sources: the folders `system` and `kernel`.

    In both the kinetic energy of the bead is by 1.002 too large, in `kernel` a text of all FMUs'
    kernel has changed as well.
    """
    return shared(tmp_path_factory, "edited", _edited)


@pytest.fixture(scope="session")
def edited_bead(edited: Path) -> Path:
    """The bead whose kinetic energy is by 1.002 too large."""
    return edited / "system" / "BeadOnWire.fmu"


def _extracted(folder: Path) -> Iterator[dict[str, Extracted]]:
    found = {name: Extracted(folder / f"{name}.fmu") for name in NAMES}
    yield found
    for fmu in found.values():
        shutil.rmtree(fmu.folder, ignore_errors=True)


@pytest.fixture(scope="session")
def extracted(fmus: Path) -> Iterator[dict[str, Extracted]]:
    """The FMUs of `fmus`, extracted, by name."""
    yield from _extracted(fmus)


@pytest.fixture(scope="session")
def interpreted(interpreted_fmus: Path) -> Iterator[dict[str, Extracted]]:
    """The FMUs of `interpreted_fmus`, extracted, by name."""
    yield from _extracted(interpreted_fmus)


@pytest.fixture
def instantiate(extracted: dict[str, Extracted]) -> Iterator[Callable[..., Instance]]:
    """Makes instances (name or Extracted, then the arguments of Instance) and frees them all."""
    made: list[Instance] = []

    def make(fmu: str | Extracted, **settings: object) -> Instance:
        chosen = extracted[fmu] if isinstance(fmu, str) else fmu
        made.append(Instance(chosen, **settings))  # type: ignore[arg-type]
        return made[-1]

    yield make
    for instance in made:
        instance.free()


@pytest.fixture
def start(instantiate: Callable[..., Instance]) -> Callable[..., Instance]:
    """Makes an initialised instance: name, then the arguments of Instance.start."""

    def make(fmu: str | Extracted, *arguments: object, **settings: object) -> Instance:
        instance = instantiate(fmu)
        instance.start(*arguments, **settings)  # type: ignore[arg-type]
        return instance

    return make

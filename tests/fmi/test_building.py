"""Building an FMU: the same bytes from the same sources, a GUID that follows the content."""

from __future__ import annotations

import ast
import functools
import os
import subprocess
import sys
import zipfile
from pathlib import Path
from xml.etree import ElementTree

import pytest
from interface_table import INTERFACE
from source_copies import build_from, copy_sources

from curvebound import __date__
from curvebound.errors import CurveboundError
from curvebound.fmi import binaries
from curvebound.fmi.build import _digest, _write, build
from curvebound.fmi.compile import why_not
from curvebound.fmi.description import timestamp
from curvebound.fmi.folder import find
from curvebound.fmi.runtime import runtime, system_sources

NAMES = tuple(INTERFACE)


def head(path: Path) -> ElementTree.Element:
    with zipfile.ZipFile(path) as archive:
        return ElementTree.fromstring(archive.read("modelDescription.xml"))


def guid(path: Path) -> str:
    return head(path).get("guid") or ""


def same_files(one: Path, other: Path) -> None:
    """Name what differs, before comparing the bytes."""
    with zipfile.ZipFile(one) as a, zipfile.ZipFile(other) as b:
        assert a.namelist() == b.namelist()
        assert [n for n in a.namelist() if a.read(n) != b.read(n)] == []
        assert [i.date_time for i in a.infolist()] == [i.date_time for i in b.infolist()]
    assert one.read_bytes() == other.read_bytes()


ONE_AND_ALL = ("BeadOnWire", *(pytest.param(name, marks=pytest.mark.slow) for name in NAMES[1:]))


@pytest.mark.usefixtures("one_reference")
@pytest.mark.parametrize("name", ONE_AND_ALL)
def test_twice_the_same_bytes(fmus, tmp_path, name: str) -> None:
    compiled = build(name, tmp_path / "compiled", compiled=not why_not())
    same_files(fmus / f"{name}.fmu", compiled.path)
    assert compiled.path == tmp_path / "compiled" / f"{name}.fmu"
    assert compiled.name == name
    assert str(compiled.path) in compiled.message
    assert "\n" not in compiled.message


@pytest.mark.parametrize(
    ("names", "compiled"),
    [
        (("BeadOnWire",), False),
        pytest.param(NAMES, False, marks=pytest.mark.slow),
        pytest.param(NAMES, True, marks=pytest.mark.slow),
    ],
)
def test_same_bytes_from_another_place_at_another_time(
    fmus, interpreted_fmus, tmp_path, names: tuple[str, ...], compiled: bool
) -> None:
    if compiled and why_not():
        pytest.skip(f"not compiled: {why_not()}")
    package = copy_sources(tmp_path / "copy")
    for i, path in enumerate(sorted(tmp_path.rglob("*"))):
        os.utime(path, (1e9 + i, 1e9 + 2 * i))
    elsewhere = tmp_path / "elsewhere"
    elsewhere.mkdir()
    other = {"PYTHONHASHSEED": "5", "TZ": "Pacific/Auckland", "LC_ALL": "C"}
    if not compiled:  # what is compiled lies in the cache, which may be found by it
        other["HOME"] = "/nonexistent"
    build_from(
        package, tmp_path / "out", *names, compiled=compiled, cwd=elsewhere, environment=other
    )
    for name in names:
        before = (fmus if compiled else interpreted_fmus) / f"{name}.fmu"
        same_files(before, tmp_path / "out" / f"{name}.fmu")
    assert list(elsewhere.iterdir()) == []


@pytest.mark.slow
@pytest.mark.skipif(bool(why_not()), reason=f"not compiled: {why_not()}")
def test_compiling_anew_gives_the_same_bytes(fmus, tmp_path) -> None:
    package = copy_sources(tmp_path / "copy")
    fresh = {"CURVEBOUND_CACHE": str(tmp_path / "cache")}
    build_from(package, tmp_path / "out", *NAMES, compiled=True, environment=fresh)
    for name in NAMES:
        same_files(fmus / f"{name}.fmu", tmp_path / "out" / f"{name}.fmu")


@pytest.mark.usefixtures("short_reference")
def test_the_date_is_that_of_the_sources_or_of_source_date_epoch(
    interpreted_fmus, tmp_path, monkeypatch
) -> None:
    first = interpreted_fmus / "BeadOnWire.fmu"
    monkeypatch.setenv("SOURCE_DATE_EPOCH", "1234567890")
    second = build("BeadOnWire", tmp_path, compiled=False).path
    assert head(second).get("generationDateAndTime") == "2009-02-13T23:31:30Z"
    with zipfile.ZipFile(second) as archive:
        assert {i.date_time for i in archive.infolist()} == {(2009, 2, 13, 23, 31, 30)}
    assert head(first).get("generationDateAndTime") != "2009-02-13T23:31:30Z"
    # the date is no part of the content
    assert guid(first) == guid(second)
    monkeypatch.setenv("SOURCE_DATE_EPOCH", "0")
    assert timestamp().isoformat() == "1970-01-01T00:00:00+00:00"
    monkeypatch.delenv("SOURCE_DATE_EPOCH")
    assert timestamp().isoformat() == f"{__date__}T00:00:00+00:00"


def test_the_guid_follows_the_content(interpreted_fmus, edited) -> None:
    names = ("BeadOnWire", "ParabolaDrive")
    before = {name: guid(interpreted_fmus / f"{name}.fmu") for name in names}
    assert len(set(before.values())) == 2
    for label in ("system", "kernel"):
        after = {name: guid(edited / label / f"{name}.fmu") for name in names}
        # every FMU carries the kernel that knows no system, and its own system, no other's
        expected = list(names) if label == "kernel" else ["BeadOnWire"]
        assert [name for name in names if after[name] != before[name]] == expected, label
        before = after


def test_the_digest_follows_each_part() -> None:
    core, folder = runtime(), find("BeadOnWire")
    own, stated = system_sources(folder, core), folder.statement()
    assert {"declaration", "kernel", "base"} <= {module.split(".")[-1] for module in own.files}
    digests = [_digest(core, own, drawing, stated) for drawing in (b"one", b"another")]
    for module, text in own.files.items():
        edited = own._replace(files={**own.files, module: f"{text}# edited"})
        digests.append(_digest(core, edited, b"one", stated))
    for name, source in stated.items():
        digests.append(_digest(core, own, b"one", {**stated, name: source + b"# edited"}))
    digests.append(_digest(core._replace(digest="edited"), own, b"one", stated))
    assert len(set(digests)) == len(digests)


@functools.cache  # most modules are in each FMU
def imports_of(source: bytes) -> set[str]:
    """The packages and modules that a module imports by absolute names."""
    found = set()
    for node in ast.walk(ast.parse(source)):
        if isinstance(node, ast.Import):
            found |= {alias.name.split(".")[0] for alias in node.names}
        elif isinstance(node, ast.ImportFrom) and node.level == 0:
            found.add((node.module or "").split(".")[0])
    return found


@pytest.mark.parametrize("name", NAMES)
def test_what_an_fmu_carries(fmus: Path, name: str) -> None:
    with zipfile.ZipFile(fmus / f"{name}.fmu") as archive:
        assert archive.testzip() is None
        names = archive.namelist()
        assert len(names) == len(set(names))
        assert names[0] == "modelDescription.xml"
        assert f"binaries/linux64/{name}.so" in names
        assert f"binaries/win64/{name}.dll" in names
        assert not [n for n in names if n.endswith(".pyc") or "__pycache__" in n or "\\" in n]
        modules = [n for n in names if n.startswith("resources/") and n.endswith(".py")]
        # what studies read of the system, and the FMU does not run
        modules = [n for n in modules if n.split("/")[1] not in ("mechanics.py", "reference.py")]
        imported = {top for module in modules for top in imports_of(archive.read(module))}
        tops = {n.split("/")[1].removesuffix(".py") for n in modules}
        # curvebound itself: only to_xml, which PythonFMU's builder calls, asks for it
        assert imported - tops - {"curvebound"} <= set(sys.stdlib_module_names)


def test_what_an_fmu_runs_does_not_need_the_package(interpreted_fmus: Path, tmp_path) -> None:
    """Its resources alone, in a Python without site-packages."""
    with zipfile.ZipFile(interpreted_fmus / "BeadOnWire.fmu") as archive:
        archive.extractall(tmp_path)
    resources = tmp_path / "resources"
    main = (resources / "slavemodule.txt").read_text().strip()
    script = (
        "import importlib, sys\n"
        f"sys.path.insert(0, {str(resources)!r})\n"
        f"cls = importlib.import_module({main!r}).BeadOnWire\n"
        f"slave = cls(instance_name='x', resources={str(resources)!r})\n"
        "slave.setup_experiment(0.0); slave.enter_initialization_mode()\n"
        "slave.exit_initialization_mode()\n"
        "assert slave.do_step(0.0, 0.01) is True\n"
        "assert not [m for m in sys.modules if m.split('.')[0] in ('numpy', 'pythonfmu')]\n"
    )
    done = subprocess.run(
        [sys.executable, "-I", "-S", "-c", script], capture_output=True, text=True
    )
    assert done.returncode == 0, done.stderr


def test_an_unknown_name_is_refused_with_those_that_exist(tmp_path) -> None:
    with pytest.raises(CurveboundError, match="BeadOnWire, ParabolaDrive, ParabolaPendulum"):
        build("NoSuchFmu", tmp_path)
    assert list(tmp_path.iterdir()) == []


@pytest.mark.usefixtures("short_reference")
def test_building_leaves_the_interpreter_as_it_was(tmp_path) -> None:
    path, modules, writes = sys.path[:], set(sys.modules), sys.dont_write_bytecode
    cwd = Path.cwd()
    build("ParabolaDrive", tmp_path, compiled=False)
    assert sys.path == path
    assert not [m for m in set(sys.modules) - modules if "ParabolaDrive_" in m]
    assert sys.dont_write_bytecode == writes
    assert Path.cwd() == cwd


@pytest.mark.usefixtures("short_reference")
def test_a_build_that_fails_leaves_the_old_fmu(tmp_path, monkeypatch) -> None:
    path = tmp_path / "ParabolaDrive.fmu"
    path.write_bytes(b"as it was")

    def fail(*_: object) -> None:
        raise OSError("disk full")

    monkeypatch.setattr("zipfile.ZipFile.writestr", fail)
    with pytest.raises(OSError, match="disk full"):
        build("ParabolaDrive", tmp_path, compiled=False)
    assert path.read_bytes() == b"as it was"
    assert list(tmp_path.iterdir()) == [path]


@pytest.mark.usefixtures("short_reference")
def test_pythonfmus_binary_offers_no_derivatives(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """It cannot pass them on: nothing is promised on any system."""
    monkeypatch.setattr(binaries, "compile_binary", lambda _: None)
    monkeypatch.setattr(binaries, "why_not", lambda *_: "not here")
    offered = head(build("BeadOnWire", tmp_path, compiled=False).path).find("CoSimulation")
    assert offered is not None
    assert offered.get("providesDirectionalDerivative") == "false"
    assert offered.get("canInterpolateInputs") == "false"
    assert offered.get("maxOutputDerivativeOrder") == "0"


def test_an_archive_is_the_same_wherever_it_is_written(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """The description first, then by name; one date, which archives have from 1980 on."""
    files = {"b.txt": b"1" * 1000, "modelDescription.xml": b"2", "a.so": b"3", "c.dll": b"4"}
    for epoch, date in (("0", (1980, 1, 1, 0, 0, 0)), ("1234567890", (2009, 2, 13, 23, 31, 30))):
        monkeypatch.setenv("SOURCE_DATE_EPOCH", epoch)
        _write(tmp_path / "a.zip", files)
        with zipfile.ZipFile(tmp_path / "a.zip") as archive:
            found = archive.infolist()
            assert {info.filename: archive.read(info) for info in found} == files
        assert [info.filename for info in found] == [
            "modelDescription.xml", "a.so", "b.txt", "c.dll"
        ]  # fmt: skip
        assert {info.date_time for info in found} == {date}
        assert [info.external_attr >> 16 for info in found] == [0o644, 0o755, 0o644, 0o755]
        assert {info.create_system for info in found} == {3}
        assert found[2].compress_size < 100

"""Wheel and sdist: built clean, and used from an empty folder by somebody without a checkout."""

from __future__ import annotations

import json
import os
import re
import subprocess
import sys
import tarfile
import zipfile
from collections.abc import Callable
from email import message_from_string
from pathlib import Path
from xml.etree import ElementTree

import pytest

from curvebound.compiling.toolchain import PLATFORMS, compiler_for

pytestmark = pytest.mark.slow

ROOT = Path(__file__).parents[1]
VERSION = re.search(r'__version__ = "(.*)"', (ROOT / "src/curvebound/__init__.py").read_text())[1]  # type: ignore[index]
#: what a user writes
SCRIPT = """
import numpy as np
import curvebound
from curvebound.cosim import Needs, Result, Scene

scene = Scene("mine", stop_time=1.0, step=0.1, needs=Needs({"bead.bead.x": 1e-6}))
scene.add("bead", "BeadOnWire", {"bead.mass": 2.0}).record("bead.bead.*")
result: Result = scene.run()
angle: np.ndarray = result["bead.bead.angle"]
print(result.time[-1], len(angle))
"""
WRONG = SCRIPT + "scene.add(3, 'BeadOnWire')\n"


@pytest.fixture(scope="module")
def dist(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Both files, the wheel made from the sdist."""
    folder, scratch = tmp_path_factory.mktemp("dist"), tmp_path_factory.mktemp("scratch")
    done = subprocess.run(
        [sys.executable, "-m", "build", "--outdir", str(folder), str(ROOT)],
        env={**os.environ, "TMPDIR": str(scratch)},
        capture_output=True,
        text=True,
    )
    assert done.returncode == 0, done.stdout[-3000:] + done.stderr[-3000:]
    assert list(scratch.glob("curvebound-*")) == []
    return folder


@pytest.fixture(scope="module")
def installed(
    dist: Path, tmp_path_factory: pytest.TempPathFactory
) -> Callable[..., subprocess.CompletedProcess[str]]:
    """Runs a program of an environment that has the wheel and no extra, in an empty folder.

    With further variables of its environment, if any are given.
    """
    folder = tmp_path_factory.mktemp("user")
    python = folder / "env" / "bin" / "python"
    subprocess.run([sys.executable, "-m", "venv", str(folder / "env")], check=True)
    (wheel,) = dist.glob("*.whl")
    subprocess.run([str(python), "-m", "pip", "install", "-q", str(wheel)], check=True)
    (folder / "empty").mkdir()
    environment = {**os.environ, "CURVEBOUND_CACHE": str(folder / "cache")}
    environment.pop("PYTHONPATH", None)

    def run(*words: str, **more: str) -> subprocess.CompletedProcess[str]:
        return subprocess.run(
            [str(python.with_name(words[0])), *words[1:]],
            cwd=folder / "empty",
            env={**environment, **more},
            capture_output=True,
            text=True,
        )

    return run


def test_what_the_two_files_hold(dist: Path) -> None:
    (wheel,), (sdist,) = dist.glob("*.whl"), dist.glob("*.tar.gz")
    assert wheel.name.startswith(f"curvebound-{VERSION}-")
    assert sdist.name == f"curvebound-{VERSION}.tar.gz"
    names = zipfile.ZipFile(wheel).namelist()
    for name in (
        "curvebound/py.typed", "curvebound/_scenarios/bead_on_wire.py",
        "curvebound/_fmus/bead_on_wire/fmu.py", "curvebound/_LICENSE",
    ):  # fmt: skip
        assert name in names
    assert any(name.startswith("curvebound/_compiled/") for name in names)
    assert not [n for n in names if n.startswith("tests") or "__pycache__" in n]
    with tarfile.open(sdist) as archive:
        kept = archive.getnames()
    for name in ("README.md", "CITATION.cff", "tests/test_package.py", "hatch_build.py"):
        assert f"curvebound-{VERSION}/{name}" in kept


def test_a_package_index_shows_pictures_links_and_classifiers(dist: Path) -> None:
    (wheel,) = dist.glob("*.whl")
    archive = zipfile.ZipFile(wheel)
    (name,) = [n for n in archive.namelist() if n.endswith(".dist-info/METADATA")]
    text = archive.read(name).decode()
    metadata = message_from_string(text)
    assert metadata["Version"] == VERSION
    assert "Typing :: Typed" in metadata.get_all("Classifier", [])
    assert len(metadata.get_all("Project-URL", [])) >= 3
    pictures = re.findall(r"!\[[^]]*\]\(([^)]*)\)", text)
    assert pictures
    assert all(address.startswith("https://") for address in pictures)


def test_the_version_is_the_same_everywhere() -> None:
    assert f"\nversion: {VERSION}\n" in (ROOT / "CITATION.cff").read_text()
    assert f"\n## {VERSION} (20" in (ROOT / "CHANGELOG.md").read_text()


def test_it_works_from_an_empty_folder_without_any_extra(installed: Callable) -> None:
    listed = json.loads(installed("curvebound", "list", "--json").stdout)
    assert "bead_on_wire" in listed["scenes"]
    built = installed("curvebound", "build", "BeadOnWire", "--out", "here")
    assert built.returncode == 0, built.stderr
    checked = installed("curvebound", "check", "here/BeadOnWire.fmu", "--junit", "here/check.xml")
    assert checked.returncode == 0, checked.stdout + checked.stderr
    read = installed("python", "-c", "print(open('here/check.xml').read())").stdout
    assert ElementTree.fromstring(read.encode()).find("testsuite").get("failures") == "0"  # type: ignore[union-attr]
    run = installed("python", "-c", SCRIPT)
    assert run.stdout.split() == ["1.0", "11"], run.stderr


@pytest.mark.skipif(
    not all(map(compiler_for, PLATFORMS)), reason="no compiler for both: run .ci/importers"
)
def test_building_needs_no_compiler(installed: Callable, tmp_path: Path) -> None:
    built = installed(
        *("curvebound", "build", "BeadOnWire", "--out", str(tmp_path)),
        PATH="/nowhere",
        CURVEBOUND_CACHE=str(tmp_path / "cache"),
    )
    assert built.returncode == 0, built.stderr
    names = zipfile.ZipFile(tmp_path / "BeadOnWire.fmu").namelist()
    for binary in ("binaries/linux64/BeadOnWire.so", "binaries/win64/BeadOnWire.dll"):
        assert binary in names
        assert f"{Path(binary).parent.as_posix()}/guid.txt" in names  # this project's own
    for suffix in (".abi3.so", ".pyd"):
        assert len([n for n in names if n.startswith("resources/") and n.endswith(suffix)]) == 2


def test_a_system_of_ones_own_needs_no_cython(installed: Callable, dist: Path) -> None:
    """The core came compiled, the system cannot be: it says so, and runs interpreted."""
    (wheel,) = dist.glob("*.whl")
    assert any(n.endswith(".abi3.so") for n in zipfile.ZipFile(wheel).namelist())
    assert installed("python", "-m", "pip", "install", "-q", "sympy").returncode == 0
    assert installed("curvebound", "new", "my_system").returncode == 0
    built = installed("curvebound", "build", "my_system", "--out", "build")
    assert "interpreted (no Cython, which curvebound[compiler] brings)" in built.stdout
    run = installed("curvebound", "run", "my_system/scene.py")
    assert run.returncode == 0, run.stderr


def test_a_users_type_checker_sees_the_types(installed: Callable) -> None:
    assert installed("python", "-m", "pip", "install", "-q", "mypy").returncode == 0
    right = installed("python", "-m", "mypy", "--strict", "-c", SCRIPT)
    assert right.returncode == 0, right.stdout
    wrong = installed("python", "-m", "mypy", "--strict", "-c", WRONG)
    assert 'Argument 1 to "add" of "Scene" has incompatible type "int"' in wrong.stdout

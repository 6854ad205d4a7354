"""A name that a scene or an SSP gives never leads out of the folder that is written into."""

from __future__ import annotations

import zipfile
from pathlib import Path
from typing import Any

import pytest

from curvebound.cli import main
from curvebound.cosim import Scene, load_scene
from curvebound.cosim.ssp import write_ssp
from curvebound.files import inside
from curvebound.study.stability.map_report import files_of
from curvebound.study.stability.maps import Request

HOSTILE = (
    "../../../X", "/abs/X", "..", ".", "", ".hidden", "a/b", "a\\b", "C:X", "CON", "nul.txt", "x\n",
    "=cmd()", "-rf", "~root", "a" * 300, "\0", "x ", "\u202etxt",
)  # fmt: skip


@pytest.mark.parametrize("name", HOSTILE)
def test_no_name_leaves_its_folder(name: str, tmp_path: Path) -> None:
    path = inside(tmp_path / "out", name, ".csv")
    assert path.parent == tmp_path / "out"
    assert path.name.endswith(".csv")
    path.parent.mkdir()
    path.write_text("")
    assert [p.name for p in path.parent.iterdir()] == [path.name]
    assert not path.name.startswith((".", "-", "="))


def test_different_names_have_different_files_and_plain_ones_their_own(tmp_path: Path) -> None:
    assert len({inside(tmp_path, name) for name in HOSTILE}) == len(HOSTILE)
    for plain in ("bead_on_wire", "Schwingung grün", "a.b-c+d", "7"):
        assert inside(tmp_path, plain) == tmp_path / plain


@pytest.fixture(
    params=["../../../X", pytest.param("/tmp/curvebound-abs/X", marks=pytest.mark.slow)]
)
def hostile(request: pytest.FixtureRequest, tmp_path: Path) -> Path:
    """An SSP whose system bears such a name."""
    folder = tmp_path / "in"
    folder.mkdir()
    scene = load_scene("bead_on_wire")
    scene.name = request.param
    scene.stop_time = 0.1
    return write_ssp(scene, folder / "hostile.ssp")


@pytest.fixture
def inner(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """The present folder, deep in one in which nothing else may appear."""
    folder = tmp_path / "a" / "b" / "c" / "d"
    folder.mkdir(parents=True)
    monkeypatch.chdir(folder)
    return folder


def everything_but(inner: Path, top: Path) -> list[Path]:
    around = {inner, *inner.parents, top / "in", top / "in" / "hostile.ssp"}
    found = [p for p in top.rglob("*") if inner not in p.parents and p not in around]
    return found + [p for p in (Path("/tmp/curvebound-abs"),) if p.exists()]


@pytest.mark.parametrize(
    "command",
    [
        ["run", "{}", "--replay", "--out", "r.csv"],
        ["ssp", "{}"],
        ["sweep", "{}", "--vary", "bead.bead.damping=0,1", "--workers", "1"],
    ],
    ids=lambda command: command[0],
)
def test_commands_write_below_the_present_folder(
    command: list[str], hostile: Path, inner: Path, tmp_path: Path
) -> None:
    assert main([word.format(hostile) for word in command]) == 0
    assert any(path.is_file() for path in inner.rglob("*X_*"))
    assert everything_but(inner, tmp_path) == []


@pytest.mark.parametrize("command", ["study", "stability"])
def test_folders_of_scenes_are_below_the_output_folder(
    command: str, hostile: Path, inner: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    pytest.importorskip("scipy")
    folders: list[Path] = []

    def stop(_: Any, where: Any, *__: Any) -> None:
        folders.append(where)
        raise KeyboardInterrupt

    if command == "study":
        monkeypatch.setattr("curvebound.study.precision.study.Study.run", stop)
        monkeypatch.setattr(
            "curvebound.study.precision.report.write_study", lambda *_, **__: Path("page")
        )
        assert main(["study", str(hostile), "--no-plots", "--out", "out"]) == 1
        assert folders[0].parent.parent == Path("out")
    else:
        request = Request(str(hostile), "bead.bead.mass=1,2", (), ("rk4",))
        where = inside(Path("out"), request.made().name)
        assert where.parent == Path("out")
        assert all(path.parent == where for path in files_of(request, where))
    assert everything_but(inner, tmp_path) == []


def test_variants_have_files_of_their_own(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """'a b' and 'a/b' were both written as a_b, the second over the first."""
    scene = tmp_path / "scene.py"
    scene.write_text(
        "from curvebound.cosim import Scene\n"
        "scene = Scene('s', stop_time=0.02, step=0.01)\n"
        "scene.add('bead', 'BeadOnWire')\n"
        "for name in ('a/b', 'a_b', '../b'):\n"
        "    scene.variant(name, {'bead.bead.mass': 2.0})\n"
    )
    (tmp_path / "out").mkdir()
    assert main(["run", str(scene), "--variants", "--out", str(tmp_path / "out" / "r.csv")]) == 0
    assert len(list((tmp_path / "out").iterdir())) == 4
    there = sorted(p.name for p in tmp_path.iterdir() if p.name != "__pycache__")
    assert there == ["out", "scene.py"]


def test_what_is_written_into_a_package_stays_in_its_resources(tmp_path: Path) -> None:
    scene = Scene("s", stop_time=0.1, step=0.01)
    for name in ("a/bead", "/bead"):
        scene.add(name, "BeadOnWire", {"bead.mass": 2.0})
    package = write_ssp(scene, tmp_path / "s.ssp")
    with zipfile.ZipFile(package) as archive:
        names = archive.namelist()
    assert all(".." not in name and not name.startswith("/") for name in names)
    assert len([name for name in names if name.endswith(".ssv")]) == 3
    again = load_scene(package)
    assert {c.name: c.start["bead.mass"] for c in again.components.values()} == {
        "a/bead": 2.0,
        "/bead": 2.0,
    }

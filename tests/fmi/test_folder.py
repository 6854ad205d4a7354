"""Systems in folders of their own, anywhere."""

from __future__ import annotations

import shutil
import sys
import zipfile
from pathlib import Path

import pytest

from curvebound import places
from curvebound.cosim import Scene
from curvebound.errors import CurveboundError
from curvebound.fmi.build import build
from curvebound.fmi.folder import find, names


def copy_as(name: str, folder: Path) -> Path:
    """A copy of the bead's system under another name."""
    own = folder / name
    ignored = shutil.ignore_patterns("__pycache__")
    shutil.copytree(places.fmus_directory() / "bead_on_wire", own, ignore=ignored)
    fmu = "".join(word.capitalize() for word in name.split("_"))
    source = own / "fmu.py"
    source.write_text(source.read_text().replace('name="BeadOnWire"', f'name="{fmu}"'))
    return own


def test_a_shipped_system_by_the_name_of_fmu_and_folder() -> None:
    assert names() == ["BeadOnWire", "ParabolaDrive", "ParabolaPendulum"]
    for name in ("BeadOnWire", "bead_on_wire"):
        assert find(name).path == (places.fmus_directory() / "bead_on_wire").resolve()


def test_a_system_by_path_and_by_name_beside_a_scene(tmp_path: Path, monkeypatch) -> None:
    own = copy_as("loop", tmp_path / "systems")
    assert find(own).name == "Loop"
    for which in ("Loop", "loop", "systems/loop"):
        assert find(which, tmp_path).path == own.resolve()
    monkeypatch.chdir(tmp_path / "systems")
    assert find("loop").path == own.resolve()
    # what is beside a scene goes before what is shipped
    assert find(copy_as("bead_on_wire", tmp_path / "systems"), tmp_path) == find(
        "BeadOnWire", tmp_path
    )


def test_what_is_no_system_is_told(tmp_path: Path) -> None:
    copy_as("loop", tmp_path / "systems")
    with pytest.raises(CurveboundError, match="BeadOnWire, Loop, ParabolaDrive"):
        find("Lop", tmp_path)
    with pytest.raises(CurveboundError, match=r"no folder of a system: it has no fmu\.py"):
        find(tmp_path)


@pytest.mark.parametrize(
    ("text", "said"),
    [
        ("FMU = 1\n", "declares no FMU"),
        ("import nothing_of_that_name\n", "fmu.py fails to load: ModuleNotFoundError"),
        ("FMU = \n", "fmu.py fails to load: SyntaxError"),
    ],
)
def test_a_mistake_in_a_system_names_the_file(tmp_path: Path, text: str, said: str) -> None:
    own = copy_as("loop", tmp_path)
    own.rename(tmp_path / "hoop")
    with pytest.raises(CurveboundError, match="declares an FMU 'Loop': call it 'Hoop'"):
        build(tmp_path / "hoop", tmp_path)
    (tmp_path / "hoop" / "fmu.py").write_text(text)
    with pytest.raises(CurveboundError, match=said):
        build(tmp_path / "hoop", tmp_path)


def test_an_edit_is_seen_at_once_and_leaves_nothing_behind(tmp_path: Path) -> None:
    own = copy_as("loop", tmp_path)
    assert find(own).fmu().step_size == 0.01
    source = own / "fmu.py"
    source.write_text(source.read_text().replace("variables=(", "step_size=0.02, variables=(", 1))
    assert find(own).fmu().step_size == 0.02
    assert not list(own.rglob("__pycache__"))


@pytest.mark.usefixtures("interpreting", "short_reference")
def test_a_scene_runs_a_system_that_lives_beside_it(tmp_path: Path) -> None:
    copy_as("loop", tmp_path / "systems")
    for source in ("Loop", "systems/loop"):
        scene = Scene("round", stop_time=0.1, step=0.01)
        scene.folder = tmp_path
        scene.add("body", source)
        result = scene.run()
        assert len(result.data) == 11
        assert result.drawings["body"].name == "Loop"


@pytest.mark.usefixtures("short_reference")
def test_adding_and_editing_a_system_changes_no_other(tmp_path: Path) -> None:
    one = copy_as("one_loop", tmp_path)
    alone = build(one, tmp_path / "a", compiled=False).path
    other = copy_as("other_loop", tmp_path)
    with (other / "kernel.py").open("a") as file:
        file.write("# edited\n")
    added = build(other, tmp_path / "a", compiled=False).path
    assert build(one, tmp_path / "b", compiled=False).path.read_bytes() == alone.read_bytes()
    with zipfile.ZipFile(added) as archive:
        (kernel,) = [name for name in archive.namelist() if name.endswith("/kernel.py")]
        assert archive.read(kernel).endswith(b"# edited\n")
    with zipfile.ZipFile(alone) as archive:
        assert not [name for name in archive.namelist() if "other" in name.lower()]


def test_two_systems_of_one_name_do_not_mix(tmp_path: Path) -> None:
    one, other = copy_as("loop", tmp_path / "a"), copy_as("loop", tmp_path / "b")
    source = other / "fmu.py"
    source.write_text(
        source.read_text().replace('"wire.radius", "m", 1.0', '"wire.radius", "m", 2.0')
    )
    starts = [
        next(v.start for v in find(path).fmu().variables if v.name == "wire.radius")
        for path in (one, other, one)
    ]
    assert starts == [1.0, 2.0, 1.0]
    assert not [path for path in sys.path if str(tmp_path) in path]

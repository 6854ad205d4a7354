"""What a package holds, word for word: of a scene with all there is, and of a bare one."""

from __future__ import annotations

import zipfile
from collections.abc import Callable
from pathlib import Path

import pytest
from descriptions import BARE, FULL, packed

from curvebound.cosim import Adaptive, Needs, Scene, load_scene
from curvebound.cosim.ssp import in_fmpy, write_ssp


def full(folder: Path) -> Scene:
    """Two of one FMU, one of another of the same name, and a bare one."""
    often = FULL.replace('canBeInstantiatedOnlyOncePerProcess="true"', "")
    packed(often, folder / "all.fmu")
    packed(often.replace('description="the first"', ""), folder / "more.fmu")
    able = 'canGetAndSetFMUstate="true" canHandleVariableCommunicationStepSize="true"/>'
    packed(BARE.replace('"bare"/>', f'"bare" {able}'), folder / "bare.fmu")
    scene = Scene(
        "every", stop_time=0.25, step=0.1, description="of all", algorithm="jacobi", hold="first",
        record_every=2, tolerance=1e-5, loop_tolerance=1e-9, order=("two", "one", "three", "four"),
        adaptive=Adaptive(tolerance=1e-3, scales={"one.x": 2.0}, smallest=1e-4, largest=0.05),
        needs=Needs({"one.x": 1e-3}, budget=0.5, frame_rate=25.0),
    )  # fmt: skip
    scene.add(
        "one", folder / "all.fmu", {"p": 7, "e": "off", "s": 5, "f": "0"}, feedthrough={"x": ["a"]}
    )
    scene.add("two", folder / "all.fmu", {"p": 1, "f": 1})
    scene.add("three", folder / "more.fmu")
    scene.add("four", folder / "bare.fmu", {"u": 3}, feedthrough=False)
    scene.connect("one.x", "two.a").connect("two.y", "three.a", 2.0, -1.5)
    scene.input("one.a", ([0.0, 0.15, 0.15], [0.0, 3.0, 5.0])).input("one.b", 4.0)
    scene.input("three.p", 3)
    scene.variant("slow", {"one.p": 9})
    return scene.record("three.y", "two.z", "three.o", "one.o", "two.w")


def bare(folder: Path) -> Scene:
    packed(BARE, folder / "bare.fmu")
    return Scene("small", stop_time=1.0, step=0.5).add("one", folder / "bare.fmu").record("one.y")


def told(scene: Scene, folder: Path) -> str:
    """All that is in its package, but the FMUs' contents, and the Python for fmpy."""
    with zipfile.ZipFile(write_ssp(scene, folder / "scene.ssp")) as archive:
        parts = []
        for one in archive.infolist():
            mode = oct(one.external_attr >> 16)
            parts.append(f"== {one.filename} {one.date_time} {one.compress_type} {mode}\n")
            if not one.filename.endswith(".fmu"):
                parts.append(archive.read(one).decode().replace("\r\n", "\n").strip() + "\n")
    return "".join([*parts, in_fmpy(scene, Path("scene.ssp")), "\n"])


@pytest.mark.parametrize("make", [full, bare])
def test_a_package_word_for_word(make: Callable[[Path], Scene], tmp_path: Path) -> None:
    expected = (Path(__file__).parent / "packages" / f"{make.__name__}.txt").read_text()
    assert told(make(tmp_path), tmp_path) == expected


def test_it_comes_back(tmp_path: Path) -> None:
    scene = full(tmp_path)
    back = load_scene(write_ssp(scene, tmp_path / "scene.ssp"))
    for name in ("name", "description", "start_time", "stop_time", "step", "algorithm", "hold",
                 "record_every", "tolerance", "loop_tolerance", "order", "groups", "adaptive",
                 "needs", "variants"):  # fmt: skip
        found, given = getattr(back, name), getattr(scene, name)
        assert (list(found), name) == (list(given), name) if name == "order" else found == given
    known, mine = back.check(), scene.check()
    assert known.links == mine.links
    assert {n: c.start for n, c in known.nodes.items()} == {
        n: c.start for n, c in mine.nodes.items()
    }
    (port,) = known.signals
    assert port == ("one", "a")
    times = [0.0, 0.1, 0.149, 0.15, 0.25]
    assert [known.signals[port](t) for t in times] == pytest.approx(
        [mine.signals[port](t) for t in times], abs=1e-8
    )

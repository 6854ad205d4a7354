"""FMUs that are not as they should be: one line with file, place and remedy, status 2."""

from __future__ import annotations

import re
import zipfile
from pathlib import Path

import pytest

from curvebound.cli import main
from curvebound.cosim import Scene
from curvebound.errors import OutsideError

DESCRIPTION = "modelDescription.xml"
SCENE = """
from curvebound.cosim import Scene
scene = Scene("s", stop_time=0.1, step=0.01)
scene.add("a", "wrong.fmu")
"""


def scene_of(path: Path) -> Scene:
    scene = Scene("s", stop_time=0.1, step=0.01)
    scene.add("a", path)
    return scene


def rewritten(sound: Path, to: Path, pattern: str = "", new: str = "", **files: bytes) -> Path:
    """A copy with the first match in its description changed, and other files of the names."""
    with zipfile.ZipFile(sound) as archive, zipfile.ZipFile(to, "w") as copy:
        for item in archive.infolist():
            data = archive.read(item)
            if item.filename == DESCRIPTION and pattern:
                text, count = re.subn(pattern, new, data.decode(), count=1, flags=re.DOTALL)
                assert count == 1, pattern
                data = text.encode()
            for ending, content in files.items():
                if item.filename.endswith(f".{ending}"):
                    data = content
            copy.writestr(item.filename, data)
    return to


def said_of(path: Path, capsys: pytest.CaptureFixture[str]) -> str:
    """What `curvebound run` says of a scene of this FMU, which must be one line and status 2."""
    (path.parent / "scene.py").write_text(SCENE)
    assert main(["run", str(path.parent / "scene.py")]) == 2
    heard = capsys.readouterr().err
    assert "Traceback" not in heard
    assert path.name in heard
    return heard


@pytest.mark.parametrize(
    ("pattern", "new", "place"),
    [
        (".*", "hello", "is no XML"),
        (
            "<fmiModelDescription(.*)</fmiModelDescription>",
            r"<other\1</other>",
            "begins with other",
        ),
        (r'fmiVersion="2.0"', 'fmiVersion="9.9"', "it is of FMI 9.9; taken are FMUs of FMI 2.0"),
        (r'fmiVersion="2.0"', 'fmiVersion="1.0"', "it is of FMI 1.0; taken are FMUs of FMI 2.0"),
        (r'fmiVersion="2.0"', 'fmiVersion="3.0"', "it is of FMI 3.0; taken are FMUs of FMI 2.0"),
        (r'(<Outputs>\s*<Unknown index=)"\d+"', r'\1"9999"', "names variable 9999"),
        (r'(<Outputs>\s*<Unknown index=)"\d+"', r'\1"0"', "names variable 0"),
        (r'(<Outputs>\s*<Unknown index=)"\d+"', r'\1"abc"', "names variable abc"),
        (r'dependencies="\d[^"]*"', 'dependencies="9999"', "names variable 9999"),
        ('name="bead.vx"', 'name="bead.x"', "two variables bead.x"),
        ('name="bead.vx"', "", "has no name"),
        (r'valueReference="1"', "", "has no valueReference"),
        (r'valueReference="1"', 'valueReference="abc"', "abc"),
        (r'start="1.0"', 'start="zz"', "wire.radius: its start: 'zz'"),
        (r'start="1000000"', 'start="1e400"', "solver.max_steps: its start: '1e400'"),
        (r'stepSize="[^"]*"', 'stepSize="abc"', "stepSize"),
        (r'stopTime="[^"]*"', 'stopTime="abc"', "stopTime"),
        (r'(<Item name="[^"]*" value=)"1"', r'\1"q"', "'q'"),
        (r'declaredType="[^"]*"', 'declaredType="Nope"', "Nope"),
        (r'causality="output"', 'causality="ouput"', "causality of bead.x is 'ouput'"),
        (r'variability="fixed"', 'variability="fixd"', "variability"),
        (r' guid="[^"]*"', "", "no guid"),
        (r'modelIdentifier="[^"]*"', 'modelIdentifier="../../x"', "modelIdentifier"),
        (r'modelIdentifier="[^"]*"', "", "modelIdentifier"),
    ],
)
def test_a_description_that_is_wrong_names_the_place(
    pattern: str, new: str, place: str, interpreted_fmus: Path, tmp_path: Path, capsys
) -> None:
    sound = interpreted_fmus / "BeadOnWire.fmu"
    path = rewritten(sound, tmp_path / "wrong.fmu", pattern, new)
    assert place in " ".join(said_of(path, capsys).split())


@pytest.mark.parametrize("damage", ["no zip", "cut", "crc"])
def test_a_file_that_is_damaged(
    damage: str, interpreted_fmus: Path, tmp_path: Path, capsys
) -> None:
    data = bytearray((interpreted_fmus / "BeadOnWire.fmu").read_bytes())
    if damage == "no zip":
        data[:] = b"hello"
    elif damage == "cut":
        del data[len(data) // 2 :]
    else:
        data[len(data) // 2] ^= 0xFF
    (tmp_path / "wrong.fmu").write_bytes(data)
    said_of(tmp_path / "wrong.fmu", capsys)


@pytest.mark.parametrize(
    ("what", "remedy"),
    [
        ("guid", "another GUID"),
        ("binary", "damaged"),
        ("no binary", "no binary for this system"),
        ("noexec", "TMPDIR"),
    ],
)
def test_a_binary_that_does_not_load_says_what_helps(
    what: str, remedy: str, interpreted_fmus: Path, tmp_path: Path, monkeypatch
) -> None:
    sound = interpreted_fmus / "BeadOnWire.fmu"
    path = tmp_path / "wrong.fmu"
    if what == "guid":
        rewritten(sound, path, r'guid="[^"]*"', 'guid="{0}"')
    elif what == "binary":
        rewritten(sound, path, so=b"junk")
    elif what == "no binary":
        rewritten(sound, path, r'modelIdentifier="[^"]*"', 'modelIdentifier="Other"')
    else:
        rewritten(sound, path)

        def refuse(*_: object, **__: object) -> None:
            raise OSError("x.so: failed to map segment from shared object")

        monkeypatch.setattr("fmpy.fmi1.cdll.LoadLibrary", refuse)
    with pytest.raises(OutsideError, match=r"wrong\.fmu cannot be loaded here") as error:
        scene_of(path).run()
    assert remedy in str(error.value)

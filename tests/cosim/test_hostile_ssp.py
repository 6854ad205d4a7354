"""SSP packages that are not as they should be: one line with file, place and remedy, status 2."""

from __future__ import annotations

import re
import zipfile
from collections.abc import Callable
from pathlib import Path

import pytest

from curvebound.cli import main
from curvebound.cosim import load_scene
from curvebound.cosim.ssp import write_ssp
from curvebound.errors import OutsideError

SSD = "SystemStructure.ssd"
Change = Callable[[dict[str, bytes]], None]


@pytest.fixture(scope="module")
def files(tmp_path_factory: pytest.TempPathFactory) -> dict[str, bytes]:
    """What a sound package of ours holds."""
    scene = load_scene("swaying_parabola")
    scene.stop_time = 0.1
    path = write_ssp(scene, tmp_path_factory.mktemp("ssp") / "sound.ssp")
    with zipfile.ZipFile(path) as archive:
        return {name: archive.read(name) for name in archive.namelist()}


def text(name: str, pattern: str, new: str) -> Change:
    """A change of the first match of `pattern` in a file."""

    def change(files: dict[str, bytes]) -> None:
        changed, count = re.subn(pattern, new, files[name].decode(), count=1, flags=re.DOTALL)
        assert count == 1, (name, pattern)
        files[name] = changed.encode()

    return change


def annotation(content: str) -> Change:
    return text(SSD, r"(<cvb:Scene>).*?(</cvb:Scene>)", rf"\g<1>{content}\g<2>")


def circle(files: dict[str, bytes]) -> None:
    """Two connectors of the system that drive each other, and a parameter bound to one of them."""
    text(
        SSD,
        r"(<ssd:System [^>]*>)",
        r'\1<ssd:Connectors><ssd:Connector name="a" kind="inout"/><ssd:Connector name="b"'
        r' kind="inout"/></ssd:Connectors><ssd:ParameterBindings><ssd:ParameterBinding>'
        r'<ssd:ParameterValues><ssv:ParameterSet xmlns:ssv="http://ssp-standard.org/SSP1/'
        r'SystemStructureParameterValues" version="1.0" name="p"><ssv:Parameters>'
        r'<ssv:Parameter name="a"><ssv:Real value="1"/></ssv:Parameter></ssv:Parameters>'
        r"</ssv:ParameterSet></ssd:ParameterValues></ssd:ParameterBinding>"
        r"</ssd:ParameterBindings>",
    )(files)
    files[SSD] = files[SSD].replace(
        b"</ssd:Connections>",
        b'<ssd:Connection startConnector="a" endConnector="b"/></ssd:Connections>',
    )


@pytest.mark.parametrize(
    ("change", "place"),
    [
        (text(SSD, 'stopTime="[^"]*"', 'stopTime="abc"'), "stopTime of the DefaultExperiment"),
        (text(SSD, 'startTime="[^"]*"', 'startTime=""'), "startTime of the DefaultExperiment"),
        (text("resources/plant.ssv", r'(<ssv:Real value=)"[^"]*"', r'\1"zz0.5"'), "'zz0.5'"),
        (text("resources/plant.ssv", r"(<ssv:Real) value=", r"\1 valu="), "''"),
        (text("resources/plant.ssv", "<ssv:Parameters>", "<ssv:Parameters"), "is no XML"),
        (text(SSD, "<ssd:Elements>", "<ssd:Elements"), "SystemStructure.ssd"),
        (text(SSD, r"<ssd:System .*</ssd:System>", ""), "describes no system"),
        (text(SSD, r'<ssc:BaseUnit[^>]* m="1"', '<ssc:BaseUnit m="x"'), "exponent m of the unit"),
        (text(SSD, 'source="[^"]*"', 'source="resources/none.fmu"'), "no file resources/none.fmu"),
        (text(SSD, 'source="[^"]*"', 'source="../../x.fmu"'), "leaves the package"),
        (text(SSD, 'startConnector="[^"]*"', 'startConnector="nope"'), "no connector"),
        (
            text(
                "resources/plant.ssv",
                r"(<ssv:Parameter name)(.*?</ssv:Parameter>)",
                r'\1\2\1="slider.u_start"><ssv:Real value="7"/></ssv:Parameter>',
            ),
            "slider.u_start is 0.0 and 7.0 in one set",
        ),
        (annotation("hello"), "the annotation Scene: it is no JSON"),
        (annotation("[1]"), "the annotation Scene: it is"),
        (annotation('{"algorithm": 7}'), "algorithm is 7"),
        (annotation('{"step": "abc"}'), "step is 'abc'"),
        (annotation('{"step": true}'), "step is True"),
        (annotation('{"record_every": 1.5}'), "record_every is 1.5"),
        (annotation('{"order": 5}'), "order is 5"),
        (annotation('{"order": [5]}'), r"order\[0\] is 5"),
        (annotation('{"groups": [["drive"]]}'), "groups are two"),
        (annotation('{"variants": {"a": 3}}'), "variants.a is 3"),
        (annotation('{"needs": {"error": {}}}'), "needs has 'error'"),
        (annotation('{"needs": {"errors": {"x": "y"}}}'), "needs.errors.x is 'y'"),
        (annotation('{"adaptive": {"tol": 1}}'), "adaptive has 'tol'"),
        (annotation('{"adaptive": [1]}'), "adaptive is"),
        (annotation('{"feedthrough": {"plant": 5}}'), "feedthrough.plant is 5"),
        (annotation('{"feedthrough": {"plant": {"a": "b"}}}'), "feedthrough.plant.a is 'b'"),
        (annotation('{"nonsense": 1}'), "has 'nonsense'"),
        (lambda files: files.pop(SSD), "no SystemStructure.ssd"),
    ],
)
def test_a_package_that_is_wrong_names_the_place(
    change: Change, place: str, files: dict[str, bytes], tmp_path: Path, capsys
) -> None:
    own = dict(files)
    change(own)
    path = tmp_path / "wrong.ssp"
    with zipfile.ZipFile(path, "w") as archive:
        for name, data in own.items():
            archive.writestr(name, data)
    with pytest.raises(OutsideError, match=place) as error:
        load_scene(path).check()
    assert "\n" not in str(error.value).split("problem:\n- ")[-1]
    assert main(["run", str(path)]) == 2
    heard = capsys.readouterr().err
    assert "Traceback" not in heard
    assert "wrong.ssp" in heard


@pytest.mark.parametrize("damage", ["no zip", "cut", "crc", "folder"])
def test_a_file_that_is_damaged(damage: str, files: dict[str, bytes], tmp_path: Path) -> None:
    path = tmp_path / "wrong.ssp"
    if damage == "folder":
        path.mkdir()
    else:
        with zipfile.ZipFile(path, "w", zipfile.ZIP_STORED) as archive:
            for name, data in files.items():
                archive.writestr(name, data)
        data = path.read_bytes()
        at = data.index(b"DefaultExperiment")
        path.write_bytes(
            {
                "no zip": b"hello",
                "cut": data[: len(data) // 2],
                "crc": data[:at] + b"d" + data[at + 1 :],
            }[damage]
        )
    assert main(["run", str(path)]) in (1, 2)
    with pytest.raises(Exception, match=r"wrong\.ssp") as error:
        load_scene(path)
    assert type(error.value).__name__ in ("OutsideError", "CurveboundError")


def test_a_unit_that_is_described_nowhere_is_told(files: dict[str, bytes], tmp_path: Path) -> None:
    own = dict(files)
    text("resources/plant.ssv", r'(<ssv:Real value=)"[^"]*"', r'\1"5" unit="furlong"')(own)
    path = tmp_path / "units.ssp"
    with zipfile.ZipFile(path, "w") as archive:
        for name, data in own.items():
            archive.writestr(name, data)
    note = (
        "plant.slider.u_start = 5.0 is given in furlong, a unit that the package describes "
        "nowhere: taken as m."
    )
    assert note in load_scene(path).check().notes


def test_connections_in_a_circle_end(files: dict[str, bytes], tmp_path: Path) -> None:
    own = dict(files)
    circle(own)
    path = tmp_path / "wrong.ssp"
    with zipfile.ZipFile(path, "w") as archive:
        for name, data in own.items():
            archive.writestr(name, data)
    with pytest.raises(OutsideError, match=r"wrong\.ssp"):
        load_scene(path)

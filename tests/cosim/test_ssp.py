"""SSP packages: ours come back as they were, fit the schema and run elsewhere; others' are read."""

from __future__ import annotations

import os
import zipfile
from pathlib import Path

import fmpy.ssp
import numpy as np
import pytest
from benchmarks.ssp_peers import available, run_peer
from fmpy.ssp.ssd import read_ssd
from lxml import etree

from curvebound.cli import main
from curvebound.cosim import Adaptive, Needs, Scene, load_scene
from curvebound.cosim.ssp import in_fmpy, write_ssp
from curvebound.errors import CurveboundError

SCHEMAS = Path(fmpy.ssp.__file__).parent / "schema"


def validate(package):
    with zipfile.ZipFile(package) as archive:
        for name in archive.namelist():
            kind = {".ssd": "Description", ".ssv": "ParameterValues"}.get(Path(name).suffix)
            if kind is not None:
                schema = etree.XMLSchema(file=str(SCHEMAS / f"SystemStructure{kind}.xsd"))
                schema.assertValid(etree.fromstring(archive.read(name)))


@pytest.mark.parametrize("name", ["swaying_parabola", "inverted_balance", "two_wires"])
def test_scenes_come_back_and_run_alike(name, tmp_path):
    scene = load_scene(name)
    scene.stop_time = 2.0
    package = write_ssp(scene, tmp_path / "scene.ssp")
    validate(package)
    back = load_scene(package)
    assert back.name == name
    assert (back.stop_time, back.step, back.algorithm) == (2.0, scene.step, "gauss_seidel")
    assert back.needs.errors == scene.needs.errors
    here, there = scene.run(), back.run()
    assert set(here.names) <= set(there.names)
    for column in here.names:
        assert np.array_equal(here[column], there[column]), column


def test_the_same_scene_gives_the_same_bytes(tmp_path):
    scene = load_scene("active_damping")
    first = write_ssp(scene, tmp_path / "a.ssp").read_bytes()
    assert write_ssp(scene, tmp_path / "b.ssp").read_bytes() == first


def test_every_setting_comes_back(two_masses, tmp_path):
    scene = two_masses(
        (1.0, 2.0), 3.0, (1.0, 0.0), (0.0, 0.0), 2.0, 0.01,
        algorithm="strang", groups=(["two"], ["one"]), tolerance=1e-7, record_every=3,
        adaptive=Adaptive(tolerance=1e-2, scales={"one.v": 2.0}, largest=0.5),
    )  # fmt: skip
    scene.components["one"].feedthrough = {"x": ["other"]}
    scene.needs = Needs({"one.x": 1e-3}, budget=0.5, frame_rate=25.0)
    scene.variant("stiff", {"one.k": 9.0})
    back = load_scene(write_ssp(scene, tmp_path / "s.ssp"))
    assert back.adaptive == scene.adaptive
    assert back.needs == scene.needs
    assert back.variants == scene.variants
    assert [list(group) for group in back.groups] == [["two"], ["one"]]
    assert (back.algorithm, back.tolerance, back.record_every) == ("strang", 1e-7, 3)
    assert back.components["one"].feedthrough == {"x": ["other"]}
    assert np.array_equal(scene.run()["one.x"], back.run()["one.x"])


def test_transformations_and_types_come_back(gain_fmu, tmp_path):
    scene = Scene("mixed", stop_time=1.0, step=0.5)
    scene.add("a", gain_fmu, {"count_in": 3, "flag_in": True, "bias": 0.25}).add("b", gain_fmu)
    scene.connect("a.y", "b.u", 1000.0, 2.0).connect("a.count", "b.count_in")
    scene.record("b.y", "b.count", "b.flag")
    package = write_ssp(scene, tmp_path / "s.ssp")
    validate(package)
    result = load_scene(package).run()
    assert result["b.y"][-1] == 252.0
    assert result["b.count"][-1] == 5
    assert result["b.flag"][-1]


HEAD = (
    '<ssd:SystemStructureDescription version="1.0" name="foreign" '
    'xmlns:ssd="http://ssp-standard.org/SSP1/SystemStructureDescription" '
    'xmlns:ssc="http://ssp-standard.org/SSP1/SystemStructureCommon" '
    'xmlns:ssm="http://ssp-standard.org/SSP1/SystemStructureParameterMapping" '
    'xmlns:ssv="http://ssp-standard.org/SSP1/SystemStructureParameterValues">'
)

NESTED = (
    HEAD
    + """
<ssd:System name="top">
  <ssd:Connectors>
    <ssd:Connector name="offset" kind="parameter"><ssc:Real/></ssd:Connector>
  </ssd:Connectors>
  <ssd:ParameterBindings><ssd:ParameterBinding><ssd:ParameterValues>
    <ssv:ParameterSet version="1.0" name="outer"><ssv:Parameters>
      <ssv:Parameter name="offset"><ssv:Real value="0.5"/></ssv:Parameter>
      <ssv:Parameter name="inner.first.gain"><ssv:Real value="3"/></ssv:Parameter>
    </ssv:Parameters></ssv:ParameterSet>
  </ssd:ParameterValues></ssd:ParameterBinding></ssd:ParameterBindings>
  <ssd:Elements>
    <ssd:System name="inner">
      <ssd:Connectors>
        <ssd:Connector name="out" kind="output"><ssc:Real unit="km"/></ssd:Connector>
      </ssd:Connectors>
      <ssd:Elements>
        <ssd:Component name="first" source="resources/Gain%20Block.fmu">
          <ssd:Connectors><ssd:Connector name="y" kind="output"><ssc:Real/></ssd:Connector>
          </ssd:Connectors>
          <ssd:ParameterBindings><ssd:ParameterBinding source="resources/first.ssv">
            <ssd:ParameterMapping source="resources/first.ssm"/>
          </ssd:ParameterBinding></ssd:ParameterBindings>
        </ssd:Component>
      </ssd:Elements>
      <ssd:Connections>
        <ssd:Connection startElement="first" startConnector="y" endConnector="out">
          <ssc:LinearTransformation factor="2"/></ssd:Connection>
      </ssd:Connections>
    </ssd:System>
    <ssd:Component name="second" source="resources/Gain%20Block.fmu">
      <ssd:Connectors>
        <ssd:Connector name="u" kind="input"><ssc:Real/></ssd:Connector>
        <ssd:Connector name="y" kind="output"><ssc:Real/></ssd:Connector>
        <ssd:Connector name="bias" kind="parameter"><ssc:Real/></ssd:Connector>
      </ssd:Connectors>
    </ssd:Component>
  </ssd:Elements>
  <ssd:Connections>
    <ssd:Connection startElement="second" startConnector="u" endElement="inner"
      endConnector="out"/>
    <ssd:Connection startConnector="offset" endElement="second" endConnector="bias"/>
  </ssd:Connections>
</ssd:System>
<ssd:DefaultExperiment startTime="1.0" stopTime="3.0"/>
</ssd:SystemStructureDescription>"""
)
VALUES = """<ssv:ParameterSet version="1.0" name="p"
  xmlns:ssv="http://ssp-standard.org/SSP1/SystemStructureParameterValues"><ssv:Parameters>
  <ssv:Parameter name="strength"><ssv:Real value="7"/></ssv:Parameter>
  <ssv:Parameter name="shift"><ssv:Real value="1"/></ssv:Parameter>
  <ssv:Parameter name="unused"><ssv:Real value="1"/></ssv:Parameter>
</ssv:Parameters></ssv:ParameterSet>"""
MAPPING = """<ssm:ParameterMapping version="1.0"
  xmlns:ssm="http://ssp-standard.org/SSP1/SystemStructureParameterMapping"
  xmlns:ssc="http://ssp-standard.org/SSP1/SystemStructureCommon">
  <ssm:MappingEntry source="strength" target="gain"/>
  <ssm:MappingEntry source="shift" target="bias">
    <ssc:LinearTransformation factor="4" offset="1"/></ssm:MappingEntry>
</ssm:ParameterMapping>"""


def package_of(tmp_path, ssd, fmu, **files):
    path = tmp_path / "foreign.ssp"
    with zipfile.ZipFile(path, "w") as archive:
        archive.writestr("SystemStructure.ssd", ssd)
        archive.write(fmu, "resources/Gain Block.fmu")
        for name, text in files.items():
            archive.writestr("resources/" + name.replace("_", "."), text)
    return path


def test_a_foreign_package_with_systems_within_systems(gain_fmu, tmp_path):
    """first: y = 3 u + 5 (the outer set prevails); out = 2 y, km to m; second adds 0.5."""
    package = package_of(tmp_path, NESTED, gain_fmu, first_ssv=VALUES, first_ssm=MAPPING)
    validate(package)
    scene = load_scene(package)
    assert (scene.start_time, scene.stop_time) == (1.0, 3.0)
    assert list(scene.components) == ["inner_first", "second"]
    result = scene.run()
    assert result["inner_first.y"][0] == 5.0
    assert result["second.y"][0] == 2.0 * 5.0 * 1000.0 + 0.5
    assert read_ssd(str(package)).name == "foreign"


@pytest.mark.parametrize(
    ("change", "message"),
    [
        (("resources/Gain%20Block.fmu", "resources/absent.fmu"), "no file resources/absent.fmu"),
        (("resources/Gain%20Block.fmu", "../out.fmu"), "leaves the package"),
        (('startConnector="u" endE', 'startConnector="w" endE'), "second.w, which is no connector"),
        (("resources/first.ssv", "resources/none.ssv"), r"has no file resources/none\.ssv"),
        (("<ssd:System name=", "<ssd:Sys name="), "no XML"),
    ],
)
def test_what_cannot_be_read_is_named(gain_fmu, tmp_path, change, message):
    text = NESTED.replace(*change)
    assert text != NESTED
    package = package_of(tmp_path, text, gain_fmu, first_ssv=VALUES, first_ssm=MAPPING)
    with pytest.raises(CurveboundError, match=message):
        load_scene(package).run()


def test_values_that_no_variable_has_the_name_of_are_ignored_with_a_note(gain_fmu, tmp_path):
    text = NESTED.replace('name="inner.first.gain"', 'name="inner.third.gain"')
    package = package_of(tmp_path, text, gain_fmu, first_ssv=VALUES, first_ssm=MAPPING)
    notes = load_scene(package).run().notes
    assert any("The parameter inner.third.gain = 3.0" in n and "is ignored" in n for n in notes)


def test_no_package_at_all(tmp_path):
    with pytest.raises(CurveboundError, match="There is no SSP package"):
        load_scene(tmp_path / "absent.ssp")
    (tmp_path / "text.ssp").write_text("text")
    with pytest.raises(CurveboundError, match="cannot be read as an SSP package"):
        load_scene(tmp_path / "text.ssp")


def without_feedthrough(scene):
    """As other tools run it: an output is read after a step, with the inputs of that step."""
    scene = scene.copy()
    scene.algorithm = "jacobi"
    for component in scene.components.values():
        component.feedthrough = False
    return scene


@pytest.fixture
def importers(monkeypatch):
    """The Python packages that .ci/importers installs, beside this interpreter's own."""
    home = os.environ.get("CURVEBOUND_IMPORTERS") or Path.home() / ".cache/curvebound-importers"
    for packages in Path(home).glob("python/lib/python3*/site-packages"):
        monkeypatch.syspath_prepend(packages)
        monkeypatch.setenv("PYTHONPATH", str(packages), prepend=os.pathsep)


def peer(tool, *arguments):
    """What run_peer gives; skips where the tool is not there, or lacks a library of the system."""
    if not available(tool):
        pytest.skip(f"{tool} is not installed: run .ci/importers")
    try:
        return run_peer(tool, *arguments, timeout=120)[1]
    except CurveboundError as error:
        if "cannot open shared object" in str(error):
            pytest.skip(str(error))
        raise


@pytest.mark.slow
@pytest.mark.usefixtures("importers")
@pytest.mark.parametrize("tool", ["libcosim", "ecos"])
def test_other_tools_agree_with_jacobi(tool, tmp_path):
    scene = load_scene("active_damping")
    scene.stop_time = 5.0
    outputs = ["plant.slider.u", "plant.pendulum.angle", "plant.parabola.x", "plant.energy.total"]
    package = write_ssp(scene, tmp_path / "scene.ssp")
    values = peer(tool, package, scene.step, 500, outputs)
    result = without_feedthrough(scene).run()
    for name in outputs:
        assert np.max(np.abs(values[name] - result[name][1:])) < 1e-13, name


@pytest.mark.usefixtures("importers")
@pytest.mark.parametrize(
    "tool",
    ["simulate_ssp", *(pytest.param(t, marks=pytest.mark.slow) for t in ("libcosim", "ecos"))],
)
def test_masses_agree_in_every_tool(tool, two_masses, tmp_path):
    """At rest in the middle all connectors start at 0, as simulate_ssp assumes they do."""
    scene = two_masses(
        (10.0, 1000.0), 100.0, (0.0, 0.0), (100.0, -100.0), 0.3, 1e-3, algorithm="jacobi"
    )
    package = write_ssp(scene, tmp_path / "masses.ssp")
    outputs = ["one.x", "two.x", "one.v"]
    values = peer(tool, package, 1e-3, 300, outputs)
    result = scene.run()
    for name in outputs:
        assert np.max(np.abs(values[name] - result[name][1:])) < 1e-11, name


def test_the_command_writes_a_package(tmp_path, capsys):
    out = tmp_path / "sway.ssp"
    words = f"ssp swaying_parabola --out {out} --set plant.slider.u_start=0.25 --stop 3".split()
    assert main(words) == 0
    assert "parameter_set=parameters" in capsys.readouterr().out
    scene = load_scene(out)
    assert scene.stop_time == 3.0
    assert scene.components["plant"].start["slider.u_start"] == 0.25
    assert main(["run", str(out)]) == 0
    assert "3 s simulated" in capsys.readouterr().out


def test_what_the_command_prints_runs_it_in_fmpy_with_the_scenes_parameters(tmp_path, monkeypatch):
    """From another start, without which the plant would hang still."""
    scene = Scene("fall", stop_time=0.5, step=0.01, algorithm="jacobi")
    scene.add("bead", "BeadOnWire", {"bead.angle_start": 0.7, "model.formulation": "angle"})
    scene.record("bead.bead.angle")
    package = write_ssp(scene, tmp_path / "fall.ssp")
    names = {}
    exec(in_fmpy(scene, package), names)
    theirs = names["result"]["bead.bead.angle"]
    ours = scene.run()["bead.bead.angle"]
    assert theirs[:49] == pytest.approx(ours[1:50], abs=1e-12)


def test_inputs_that_the_scene_drives_are_named_for_fmpy(tmp_path):
    text = in_fmpy(load_scene("shaken_wire"), tmp_path / "x.ssp")
    assert "input=inputs" in text
    assert "bead.wire.ay" in text


def test_enumerations_are_declared(build_fmu, tmp_path):
    """As the schema and the standard want them: of the type of the FMU's variable."""
    switch = build_fmu("switch")
    scene = Scene("levels", stop_time=1.0, step=0.5).add("s", switch).add("t", switch)
    scene.connect("s.chosen", "t.mode").record("t.y")
    package = write_ssp(scene, tmp_path / "levels.ssp")
    validate(package)
    with zipfile.ZipFile(package) as archive:
        structure = archive.read("SystemStructure.ssd").decode()
    assert structure.count('ssc:Enumeration name="s.chosen"') == 3  # two uses, one definition
    assert read_ssd(str(package)).name == "levels"
    assert load_scene(package).run()["t.y"][-1] == scene.run()["t.y"][-1]

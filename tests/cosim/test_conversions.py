"""Connections between variables of different types, in scenes and in packages of other tools."""

from __future__ import annotations

import zipfile
from xml.etree import ElementTree

import pytest

from curvebound.cosim import Scene, load_scene
from curvebound.cosim.ssp import NAMESPACES, write_ssp
from curvebound.cosim.ssp_values import Transformation
from curvebound.errors import CurveboundError


@pytest.fixture(scope="module")
def switch_fmu(build_fmu):
    return build_fmu("switch")


@pytest.fixture
def scene(gain_fmu, switch_fmu):
    """An integer and a Boolean (a), an enumeration (s), and another of each to drive (b, t)."""
    scene = Scene("typed", stop_time=1.0, step=0.5)
    scene.add("a", gain_fmu, {"count_in": 2}).add("b", gain_fmu)
    return scene.add("s", switch_fmu, {"mode": "high"}).add("t", switch_fmu)


def last(scene, path):
    return scene.record(path).run()[path][-1]


def test_whole_numbers_reach_what_holds_them(scene):
    scene.connect("a.count", "t.mode")  # Integer 3 to an enumeration
    scene.connect("s.chosen", "b.count_in")  # and an enumeration to Integer
    assert last(scene, "t.y") == 3.0
    assert last(scene, "b.count") == 8


@pytest.mark.parametrize(
    ("source", "expected"), [("a.count", 3.0), ("s.chosen", 7.0), ("a.flag", 1.0)]
)
def test_and_all_of_them_real_inputs(scene, source, expected):
    scene.connect(source, "b.u", 10.0, 0.5)
    assert last(scene, "b.y") == 10.0 * expected + 0.5


def test_boolean_to_integer(scene):
    scene.connect("a.flag", "b.count_in")
    assert last(scene, "b.count") == 2


def test_several_types_into_one_component(scene):
    scene.connect("a.count", "b.u", 1.0).connect("s.chosen", "b.count_in")
    scene.connect("a.flag", "b.flag_in").record("b.y", "b.count", "b.flag")
    result = scene.run()
    assert (result["b.y"][-1], result["b.count"][-1], result["b.flag"][-1]) == (3.0, 8, False)


@pytest.mark.parametrize(
    ("source", "target"),
    [("a.y", "b.count_in"), ("a.y", "t.mode"), ("a.count", "b.flag_in"), ("s.chosen", "b.flag_in")],
)
def test_what_loses_values_is_refused(scene, source, target):
    scene.connect(source, target)
    with pytest.raises(CurveboundError, match="which not all values survive"):
        scene.check()


def test_a_mapping_makes_other_numbers_of_some(scene, tmp_path):
    scene.connect("a.count", "t.mode", mapping={3: 7, 5: 1})
    scene.connect("s.chosen", "b.count_in", mapping={3: 7}).record("t.y", "b.count")
    for one in (scene, load_scene(write_ssp(scene, tmp_path / "typed.ssp"))):
        result = one.run()
        assert (result["t.y"][-1], result["b.count"][-1]) == (7.0, 8)


def test_what_is_calculated_once_can_drive_an_input(scene):
    scene.set("s.scale", 1.5).connect("s.calibrated", "b.u", 1.0)
    assert last(scene, "b.y") == 3.0


SSD = """<ssd:SystemStructureDescription version="1.0" name="foreign"
    xmlns:ssd="http://ssp-standard.org/SSP1/SystemStructureDescription"
    xmlns:ssc="http://ssp-standard.org/SSP1/SystemStructureCommon"
    xmlns:ssv="http://ssp-standard.org/SSP1/SystemStructureParameterValues">
<ssd:System name="top">
  <ssd:Connectors>
    <ssd:Connector name="size" kind="parameter"><ssc:Real unit="km"/></ssd:Connector>
    <ssd:Connector name="level" kind="parameter"><ssc:Integer/></ssd:Connector>
  </ssd:Connectors>
  <ssd:ParameterBindings>
    <ssd:ParameterBinding prefix="a."><ssd:ParameterValues>
      <ssv:ParameterSet version="1.0" name="own"><ssv:Parameters>
        <ssv:Parameter name="count_in"><ssv:Integer value="2"/></ssv:Parameter>
        <ssv:Parameter name="nothing"><ssv:Real value="9"/></ssv:Parameter>
      </ssv:Parameters></ssv:ParameterSet></ssd:ParameterValues></ssd:ParameterBinding>
    <ssd:ParameterBinding><ssd:ParameterValues>
      <ssv:ParameterSet version="1.0" name="set"><ssv:Parameters>
        <ssv:Parameter name="size"><ssv:Real value="0.002"/></ssv:Parameter>
        <ssv:Parameter name="level"><ssv:Integer value="4"/></ssv:Parameter>
      </ssv:Parameters></ssv:ParameterSet></ssd:ParameterValues></ssd:ParameterBinding>
  </ssd:ParameterBindings>
  <ssd:Elements>
    <ssd:Component name="a" source="resources/gain.fmu"><ssd:Connectors>
      <ssd:Connector name="count" kind="output"><ssc:Integer/></ssd:Connector>
    </ssd:Connectors></ssd:Component>
    <ssd:Component name="t" source="resources/switch.fmu"><ssd:Connectors>
      <ssd:Connector name="mode" kind="input"><ssc:Enumeration name="Mode"/></ssd:Connector>
      <ssd:Connector name="scale" kind="parameter"><ssc:Real unit="m"/></ssd:Connector>
      <ssd:Connector name="y" kind="output"><ssc:Real/></ssd:Connector>
    </ssd:Connectors></ssd:Component>
    <ssd:Component name="s" source="resources/switch.fmu"><ssd:Connectors>
      <ssd:Connector name="mode" kind="input"><ssc:Enumeration name="Mode"/></ssd:Connector>
      <ssd:Connector name="y" kind="output"><ssc:Real/></ssd:Connector>
    </ssd:Connectors></ssd:Component>
  </ssd:Elements>
  <ssd:Connections>
    <ssd:Connection startElement="a" startConnector="count" endElement="t" endConnector="mode">
      CHANGE</ssd:Connection>
    <ssd:Connection startConnector="size" endElement="t" endConnector="scale">
      <ssc:LinearTransformation factor="10" offset="1"/></ssd:Connection>
    <ssd:Connection startConnector="level" endElement="s" endConnector="mode">
      <ssc:IntegerMappingTransformation><ssc:MapEntry source="4" target="7"/>
      </ssc:IntegerMappingTransformation></ssd:Connection>
  </ssd:Connections>
</ssd:System>
<ssd:Enumerations><ssc:Enumeration name="Mode"><ssc:Item name="off" value="1"/>
  <ssc:Item name="low" value="3"/><ssc:Item name="high" value="7"/></ssc:Enumeration>
</ssd:Enumerations>
<ssd:Units><ssc:Unit name="m"><ssc:BaseUnit m="1"/></ssc:Unit>
  <ssc:Unit name="km"><ssc:BaseUnit m="1" factor="1000"/></ssc:Unit></ssd:Units>
<ssd:DefaultExperiment startTime="0" stopTime="1"/>
</ssd:SystemStructureDescription>"""

MAP = (
    '<ssc:IntegerMappingTransformation><ssc:MapEntry source="3" target="7"/>'
    "</ssc:IntegerMappingTransformation>"
)


@pytest.mark.parametrize(("change", "level"), [("", 3.0), (MAP, 7.0)])
def test_a_package_with_types_parameters_units_and_tables(
    gain_fmu, switch_fmu, tmp_path, change, level
):
    """scale = 10 * 2 m + 1 m; what no variable is called is ignored with a note."""
    package = tmp_path / "foreign.ssp"
    with zipfile.ZipFile(package, "w") as archive:
        archive.writestr("SystemStructure.ssd", SSD.replace("CHANGE", change))
        archive.write(gain_fmu, "resources/gain.fmu")
        archive.write(switch_fmu, "resources/switch.fmu")
    scene = load_scene(package)
    assert scene.components["t"].start["scale"] == pytest.approx(21.0)
    result = scene.run()
    assert result["t.y"][-1] == pytest.approx(21.0 * level)
    assert result["s.y"][-1] == 7.0
    assert any("a.nothing = 9.0 of the system is ignored" in n or
               "nothing = 9.0 of a is ignored" in n for n in result.notes)  # fmt: skip


def test_a_value_that_nothing_changes_keeps_its_type():
    for value in ("true", "4", "off", True, 2.5):
        assert Transformation().applied(value) is value
    assert Transformation(1.05).applied("2") == 2.1
    assert Transformation(1.0, 0.5).applied(2) == 2.5
    table = Transformation(entries=(("true", "7"), ("4", "1")))
    assert [table.applied(value) for value in (True, "4", 4, False)] == ["7", "1", "1", False]


def test_a_package_writes_only_the_conversions_there_are(scene, tmp_path):
    """And no time: the same scene gives the same bytes."""
    scene.connect("a.count", "b.count_in").connect("a.y", "b.u", 1.05, 0.5)
    with zipfile.ZipFile(write_ssp(scene, tmp_path / "typed.ssp")) as archive:
        top = ElementTree.fromstring(archive.read("SystemStructure.ssd"))
        assert {one.date_time for one in archive.infolist()} == {(1980, 1, 1, 0, 0, 0)}
    plain, changed = (
        one for one in top.iter(f"{{{NAMESPACES['ssd']}}}Connection") if one.get("endElement")
    )
    assert (plain.get("endConnector"), list(plain)) == ("count_in", [])
    assert plain.get("suppressUnitConversion") is None
    assert changed.get("suppressUnitConversion") == "true"
    connectors = top.iter(f"{{{NAMESPACES['ssd']}}}Connector")
    units = {one.get("name"): typed.get("unit") for one in connectors for typed in one}
    assert (units["u"], units["count"]) == ("m", None)
    (linear,) = changed
    assert (linear.get("factor"), linear.get("offset")) == ("1.05", "0.5")

"""Descriptions of FMUs without a binary: one that gives all that there is, and a bare one."""

from __future__ import annotations

import zipfile
from pathlib import Path

from curvebound.cosim.fmu import Fmu, read_fmu

FULL = """<?xml version="1.0"?>
<fmiModelDescription fmiVersion="2.0" modelName="All" guid="{g}" description="All there is">
  <CoSimulation modelIdentifier="all" canGetAndSetFMUstate="true" canInterpolateInputs="true"
    canSerializeFMUstate="true" canHandleVariableCommunicationStepSize="true"
    maxOutputDerivativeOrder="1" providesDirectionalDerivative="true"
    canBeInstantiatedOnlyOncePerProcess="true"/>
  <UnitDefinitions>
    <Unit name="degC"><BaseUnit K="1" offset="273.15"/></Unit>
    <Unit name="km/h"><BaseUnit m="1" s="-1" factor="0.25"/></Unit>
    <Unit name="none"/>
  </UnitDefinitions>
  <TypeDefinitions>
    <SimpleType name="speed"><Real unit="km/h" min="-1" max="2" nominal="-30"/></SimpleType>
    <SimpleType name="mode"><Enumeration><Item name="on" value="3"/><Item name="off" value="-7"/>
      </Enumeration></SimpleType>
  </TypeDefinitions>
  <DefaultExperiment startTime="0.5" stopTime="2.5" stepSize="0.125" tolerance="1e-7"/>
  <ModelVariables>
    <ScalarVariable name="a" valueReference="7" causality="input" description="the first">
      <Real declaredType="speed" start="1.5"/></ScalarVariable>
    <ScalarVariable name="b" valueReference="3" causality="input">
      <Real declaredType="speed" unit="degC" min="-5" max="6" nominal="4" start="2"/>
      </ScalarVariable>
    <ScalarVariable name="p" valueReference="4" causality="parameter" variability="tunable">
      <Integer start="5" min="1" max="9"/></ScalarVariable>
    <ScalarVariable name="e" valueReference="4" causality="parameter" variability="fixed">
      <Enumeration declaredType="mode" start="3"/></ScalarVariable>
    <ScalarVariable name="x" valueReference="1" causality="output"><Real nominal="0"/>
      </ScalarVariable>
    <ScalarVariable name="y" valueReference="2" causality="output" initial="exact">
      <Real unit="none" start="0"/></ScalarVariable>
    <ScalarVariable name="z" valueReference="5" causality="output"><Boolean/></ScalarVariable>
    <ScalarVariable name="c" valueReference="6" causality="local" variability="constant">
      <Real start="8"/></ScalarVariable>
    <ScalarVariable name="q" valueReference="9"><String/></ScalarVariable>
    <ScalarVariable name="o" valueReference="8" causality="output">
      <Enumeration declaredType="mode"/></ScalarVariable>
    <ScalarVariable name="w" valueReference="10" causality="output"><Real unit="degC"/>
      </ScalarVariable>
    <ScalarVariable name="s" valueReference="11" causality="parameter" variability="fixed">
      <String start="k"/></ScalarVariable>
    <ScalarVariable name="f" valueReference="12" causality="parameter" variability="fixed">
      <Boolean start="true"/></ScalarVariable>
  </ModelVariables>
  <ModelStructure>
    <Outputs><Unknown index="5" dependencies="2 3"/><Unknown index="6" dependencies=""/>
      <Unknown index="7"/><Unknown index="10"/><Unknown index="11"/></Outputs>
    <InitialUnknowns><Unknown index="5" dependencies="1 4"/><Unknown index="6"/></InitialUnknowns>
  </ModelStructure>
</fmiModelDescription>"""

BARE = """<?xml version="1.0"?>
<fmiModelDescription fmiVersion="2.0" modelName="Bare" guid="0">
  <CoSimulation modelIdentifier="bare"/>
  <ModelVariables>
    <ScalarVariable name="u" valueReference="0" causality="input"><Real start="0"/>
      </ScalarVariable>
    <ScalarVariable name="y" valueReference="1" causality="output"><Real/></ScalarVariable>
  </ModelVariables>
  <ModelStructure><Outputs><Unknown index="2"/></Outputs></ModelStructure>
</fmiModelDescription>"""


def packed(text: str, path: Path) -> Fmu:
    with zipfile.ZipFile(path, "w") as archive:
        archive.writestr("modelDescription.xml", text)
    return read_fmu(path)

"""FMUs share a process without sharing code, folders or memory."""

from __future__ import annotations

import json
import os
import shutil
import subprocess
import sys
from pathlib import Path

import pytest
from driven import MODELS, drive
from harness import OK, Extracted, Instance

NAMES = ["BeadOnWire", "ParabolaPendulum", "ParabolaDrive"]


def test_two_versions_in_one_process_run_their_own_code(extracted, edited_bead) -> None:
    new = Extracted(edited_bead)
    old = extracted["BeadOnWire"]
    assert new.guid != old.guid
    with Instance(old) as a, Instance(new) as b, Instance(old) as c, Instance(new) as d:
        for instance in (a, b, c, d):
            instance.start(MODELS["projection"][1])
        for _ in range(20):
            for instance in (a, b, c, d):
                drive(instance, 1, 0.02)
            energies = [i["energy.kinetic"] for i in (a, b, c, d)]
            assert energies[0] == energies[2] != 0.0
            assert energies[1] == energies[3] == pytest.approx(1.002 * energies[0], rel=1e-12)
        # a saved state of the other version is not taken for one of ours
        data = a.serialized()
        bits = b.bits()
        status = b.status("deSerializeFMUstate", data)
        if status == OK:
            b.restore(data, b.time)
        assert len(b.errors) == 1
        assert b.bits() == bits
    shutil.rmtree(new.folder)


def test_a_state_or_code_of_one_fmu_does_not_reach_another(extracted, start) -> None:
    bead, drive_, pendulum = (start(n) for n in ("BeadOnWire", "ParabolaDrive", "ParabolaPendulum"))
    alone = start("ParabolaPendulum")
    for i in range(20):
        bead.step(0.01 * (i + 1))
        drive_.step(0.02)
        pendulum.step(0.1)
    for _ in range(20):
        alone.step(0.1)
    assert pendulum.bits() == alone.bits()


_DELETED = """
import pathlib, shutil, sys
from harness import Extracted, Instance
folder, *order = sys.argv[1:]
METHODS = ("explicit_euler", "semi_implicit_euler", "rk4", "adaptive", "implicit")
CHOICES = {
    "BeadOnWire": [{"solver.method": m, "model.formulation": f}
                   for m in METHODS for f in ("lagrange_multiplier", "angle")],
    "ParabolaPendulum": [{"solver.method": m, "model.fidelity": f}
                         for m in METHODS for f in ("linear", "nonlinear")]
                        + [{"solver.method": "exact", "model.fidelity": "linear"}],
    "ParabolaDrive": [{"waveform.kind": k} for k in ("sine", "chirp", "step")],
}
for name in [*order, *order]:
    fmu = Extracted(pathlib.Path(folder) / f"{name}.fmu")
    alive = Instance(fmu).start()
    shutil.rmtree(fmu.folder)
    # runs on in every way it can, though its folder is gone
    alive.step(10.0)
    print(name, *alive.reals()[:1])
    for choices in CHOICES[name]:
        alive.slave.reset()
        alive.start(choices)
        alive.step(0.1)
        alive.restore(alive.serialized(), 0.1)
        alive.step(0.1)
    assert not alive.errors
    alive.free()
"""

_MANY = """
import gc, json, os, shutil, sys
from contextlib import suppress
from pathlib import Path
from fmpy.fmi1 import FMICallException
from fmpy.fmi2 import FMU2Slave
from harness import OK, Extracted
from heap import heap

def memory():
    gc.collect()
    with open("/proc/self/statm") as file:
        return int(file.read().split()[1]) * os.sysconf("SC_PAGESIZE")

fmu = Extracted(Path(sys.argv[1]))
out = []
slave = FMU2Slave(guid=fmu.guid, unzipDirectory=str(fmu.folder),
                  modelIdentifier=fmu.name, instanceName="x")
def one():
    slave.instantiate()
    slave.setDebugLogging(True, ["logStatusError", "logStatusWarning"])
    slave.setupExperiment()
    slave.enterInitializationMode()
    slave.exitInitializationMode()
    slave.doStep(0.0, 0.01)
    slave.getReal([fmu.variables[n].valueReference for n in fmu.outputs])
    state = slave.getFMUstate()
    copy = slave.deSerializeFMUstate(slave.serializeFMUstate(state))
    with suppress(FMICallException):
        slave.doStep(0.01, -1.0)
    slave.setFMUstate(copy)
    slave.freeFMUstate(state)
    slave.freeFMUstate(copy)
    slave.fmi2FreeInstance(slave.component)
for _ in range(100):
    one()
before, paths, modules, malloced = memory(), len(sys.path), len(sys.modules), heap()
for _ in range(500):
    one()
print(json.dumps({"memory": (memory() - before) / 500, "heap": (heap() - malloced) / 500,
                  "paths": len(sys.path) - paths,
                  "modules": len(sys.modules) - modules,
                  "resources": sum(str(fmu.folder) in p for p in sys.path)}))
shutil.rmtree(fmu.folder)
"""


def run(script: str, *arguments: str) -> str:
    done = subprocess.run(
        [sys.executable, "-c", script, *arguments],
        env={**os.environ, "PYTHONPATH": str(Path(__file__).parent)},
        capture_output=True,
        text=True,
        timeout=300,
    )
    assert done.returncode == 0, done.stderr
    return done.stdout


@pytest.mark.parametrize(
    "first",
    ["BeadOnWire", *(pytest.param(name, marks=pytest.mark.slow) for name in NAMES[1:])],
)
def test_the_folder_of_an_fmu_may_be_deleted(fmus: Path, first: str) -> None:
    """Also when other FMUs of the same kernel run on modules that came from it."""
    at = NAMES.index(first)
    order = NAMES[at:] + NAMES[:at]
    lines = [line.split() for line in run(_DELETED, str(fmus), *order).splitlines()]
    assert [name for name, _ in lines] == order * 2
    for name, value in lines:
        if name == "BeadOnWire":
            assert float(value) == pytest.approx(0.275087462576117, abs=1e-9)
        elif name == "ParabolaPendulum":
            assert float(value) == pytest.approx(-0.112074121556804, abs=1e-10)


@pytest.mark.skipif(sys.platform != "linux", reason="memory is read from /proc")
@pytest.mark.parametrize(
    "name", [*(pytest.param(name, marks=pytest.mark.slow) for name in NAMES[::2]), NAMES[1]]
)
def test_hundreds_of_instances_leave_nothing(fmus: Path, name: str) -> None:
    found = json.loads(run(_MANY, str(fmus / f"{name}.fmu")).splitlines()[-1])
    assert found["paths"] == 0
    assert found["resources"] == 0
    assert found["modules"] == 0
    assert found["memory"] < 300.0, found
    assert found["heap"] < 8.0, found


def test_instances_are_independent(start) -> None:
    """One with its own parameters does not change another, whatever the order of their steps."""
    settings = [{"wire.radius": 0.5 + 0.1 * i, "bead.mass": 1.0 + i} for i in range(5)]
    alone = []
    for parameters in settings:
        instance = start("BeadOnWire", parameters)
        for i in range(10):
            drive(instance, 1, (i + 1) * 0.05 - i * 0.05)
            instance.time = (i + 1) * 0.05
        alone.append(instance.bits())
        instance.free()
    together = [start("BeadOnWire", parameters) for parameters in settings]
    for i in range(10):
        for instance in together:
            drive(instance, 1, (i + 1) * 0.05 - i * 0.05)
            instance.time = (i + 1) * 0.05
    assert [instance.bits() for instance in together] == alone

"""What FMUs declare that they cannot do is found before anything runs."""

from __future__ import annotations

import re
import zipfile
from pathlib import Path

import numpy as np
import pytest

from curvebound.cosim import Adaptive, Scene
from curvebound.errors import CurveboundError


@pytest.fixture(scope="module")
def limited(mass_fmu, tmp_path_factory):
    """A function that gives the mass's FMU with one capability changed in its description."""

    def make(flag: str, value: str) -> Path:
        path = tmp_path_factory.mktemp(flag) / "limited.fmu"
        with zipfile.ZipFile(mass_fmu) as old, zipfile.ZipFile(path, "w") as new:
            for name in old.namelist():
                content = old.read(name)
                if name == "modelDescription.xml":
                    text = re.sub(rf' {flag}="\w+"', "", content.decode())
                    text = text.replace("<CoSimulation", f'<CoSimulation {flag}="{value}"')
                    content = text.encode()
                new.writestr(name, content)
        return path

    return make


ONE_SIZE = "canHandleVariableCommunicationStepSize"


def test_an_fmu_of_one_step_size_needs_a_whole_number_of_steps(limited):
    scene = Scene("rigid", stop_time=1.0, step=0.3).add("one", limited(ONE_SIZE, "false"))
    with pytest.raises(CurveboundError, match=r"one: .* takes one step size only; make stop_time"):
        scene.check()
    scene.step = 0.1
    assert scene.run().time[-1] == 1.0
    scene.start_time, scene.step = 0.1, 0.3
    assert scene.run().time == pytest.approx([0.1, 0.4, 0.7, 1.0])


def test_an_fmu_of_any_step_size_takes_a_shorter_last_one(limited):
    scene = Scene("flexible", stop_time=1.0, step=0.3).add("one", limited(ONE_SIZE, "true"))
    assert scene.run().time == pytest.approx([0.0, 0.3, 0.6, 0.9, 1.0])


def test_an_fmu_of_one_step_size_takes_no_adaptive_steps(limited):
    scene = Scene("rigid", stop_time=1.0, step=0.1, adaptive=Adaptive())
    scene.add("one", limited(ONE_SIZE, "false"))
    with pytest.raises(CurveboundError, match=f"{ONE_SIZE} is false"):
        scene.check()


def test_an_fmu_that_there_can_be_only_once(limited):
    only = limited("canBeInstantiatedOnlyOncePerProcess", "true")
    scene = Scene("twins", stop_time=1.0, step=0.1).add("one", only).add("two", only)
    with pytest.raises(CurveboundError) as caught:
        scene.check()
    for name in ("one", "two"):
        assert f"component {name}: " in str(caught.value)
    assert "can be instantiated only once" in str(caught.value)
    alone = Scene("alone", stop_time=1.0, step=0.5).add("one", only)
    assert len(alone.run().time) == 3


def test_fmus_that_there_can_be_many_times(limited):
    often = limited("canBeInstantiatedOnlyOncePerProcess", "false")
    Scene("twins", stop_time=1.0, step=0.1).add("one", often).add("two", often).check()


@pytest.mark.parametrize("every", [1, 3, 5, 7, 100])
@pytest.mark.parametrize("components", [1, 2])
def test_every_nth_communication_point_is_recorded_and_the_last(mass_fmu, every, components):
    """One component is run by fmpy, two by the master."""
    names = ["one", "two"][:components]
    scene = Scene("thinned", stop_time=1.0, step=0.1)
    for name in names:
        scene.add(name, mass_fmu, {"x_start": 1.0})
        scene.record(f"{name}.x")
    if components == 2:
        scene.connect("one.x", "two.other")
    whole = scene.run()
    assert len(whole.data) == 11
    scene.record_every = every
    kept = sorted({*range(0, 11, every), 10})
    thinned = scene.run()
    assert np.array_equal(thinned.data, whole.data[kept])
    assert thinned.steps == whole.steps == 10

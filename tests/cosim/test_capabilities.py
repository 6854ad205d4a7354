"""What FMUs declare that they cannot do is found before anything runs."""

from __future__ import annotations

import os
import re
import subprocess
import sys
import zipfile
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest

from curvebound.cosim import Adaptive, Scene
from curvebound.cosim.fmu import read_fmu
from curvebound.errors import CurveboundError


@pytest.fixture(scope="module")
def limited(mass_fmu, tmp_path_factory):
    """A function that gives the mass's FMU with one capability changed in its description."""

    def make(flag: str, value: str) -> Path:
        def change(text: str) -> str:
            text = re.sub(rf' {flag}="\w+"', "", text)
            return text.replace("<CoSimulation", f'<CoSimulation {flag}="{value}"')

        return described(mass_fmu, tmp_path_factory.mktemp(flag) / "limited.fmu", change)

    return make


def described(fmu: Path, to: Path, change: Callable[[str], str]) -> Path:
    """An FMU with another description."""
    with zipfile.ZipFile(fmu) as old, zipfile.ZipFile(to, "w") as new:
        for name in old.namelist():
            content = old.read(name)
            if name == "modelDescription.xml":
                content = change(content.decode()).encode()
            new.writestr(name, content)
    return to


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


def test_an_output_without_declared_dependencies_has_all_inputs(mass_fmu, tmp_path):
    """FMI 2.0.3, section 2.2.8; declared as none it has none."""
    declared = read_fmu(mass_fmu)
    assert declared.dependencies == {"x": (), "v": ()}
    assert declared.undeclared == frozenset()
    silent = read_fmu(
        described(mass_fmu, tmp_path / "a.fmu", lambda text: text.replace(' dependencies=""', ""))
    )
    assert silent.dependencies == {"x": ("other",), "v": ("other",)}
    assert silent.undeclared == {"x", "v"}


def test_what_was_unpacked_is_removed_at_the_end_of_the_process(mass_fmu, tmp_path):
    script = (
        "import os, pathlib, sys; from curvebound.cosim.fmu import extracted, read_fmu;"
        "print(len(os.listdir(extracted(read_fmu(pathlib.Path(sys.argv[1]))))))"
    )
    done = subprocess.run(
        [sys.executable, "-c", script, str(mass_fmu)], capture_output=True, text=True, check=True,
        env={**os.environ, "TMPDIR": str(tmp_path)},
    )  # fmt: skip
    assert int(done.stdout) >= 3
    assert list(tmp_path.iterdir()) == []


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

"""What an FMU's DefaultExperiment says counts where the scene says nothing."""

from __future__ import annotations

import zipfile
from pathlib import Path

import numpy as np
import pytest

from curvebound.cosim import Scene


@pytest.fixture(scope="module")
def tolerant(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """BeadOnWire, whose DefaultExperiment has a tolerance of 1e-2."""
    scene = Scene("source", stop_time=1.0, step=0.1).add("bead", "BeadOnWire")
    source = scene.check().nodes["bead"].fmu.path
    path = tmp_path_factory.mktemp("tolerant") / "Tolerant.fmu"
    with zipfile.ZipFile(source) as old, zipfile.ZipFile(path, "w") as new:
        for info in old.infolist():
            content = old.read(info)
            if info.filename == "modelDescription.xml":
                changed = content.replace(
                    b"<DefaultExperiment ", b'<DefaultExperiment tolerance="1e-2" '
                )
                assert changed != content
                content = changed
            new.writestr(info, content)
    return path


def run(fmu: Path, tolerance: float | None, *, alone: bool) -> np.ndarray:
    scene = Scene("tolerance", stop_time=10.0, step=0.5, tolerance=tolerance)
    scene.add("bead", fmu, {"solver.method": "adaptive"})
    if not alone:
        scene.add("other", "BeadOnWire")
    scene.record("bead.bead.angle", "bead.solver.evaluations")
    return scene.run().data


@pytest.mark.parametrize("alone", [True, False])
def test_its_tolerance_counts_where_the_scene_gives_none(tolerant: Path, alone: bool) -> None:
    by_itself = run(tolerant, None, alone=alone)
    assert np.array_equal(by_itself, run(tolerant, 1e-2, alone=alone))
    finer = run(tolerant, 1e-9, alone=alone)
    assert finer["bead.solver.evaluations"][-1] > by_itself["bead.solver.evaluations"][-1]

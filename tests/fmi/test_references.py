"""References that others can reproduce: the cross-check folders, and those inside the FMUs."""

from __future__ import annotations

import re
import zipfile
from pathlib import Path

import fmpy
import numpy as np
import pytest

from curvebound.errors import CurveboundError
from curvebound.fmi.cross_check import _bounds, write_cross_check
from curvebound.fmi.declaration import Fmu
from curvebound.fmi.documentation import _experiment
from curvebound.fmi.folder import find
from curvebound.fmi.reference import ReferenceResult, reference_result

NAMES = ("BeadOnWire", "ParabolaDrive", "ParabolaPendulum")


@pytest.fixture(
    scope="module",
    params=[*NAMES[:2], pytest.param(NAMES[2], marks=pytest.mark.slow)],
)
def folder(request: pytest.FixtureRequest, tmp_path_factory: pytest.TempPathFactory) -> Path:
    return write_cross_check(request.param, tmp_path_factory.mktemp("cross"))


def simulated(fmu: Path, inputs: Path, options: dict[str, float]) -> np.ndarray:
    """As the folder's README says, and as anybody would without it."""
    return fmpy.simulate_fmu(
        str(fmu),
        start_time=options["StartTime"],
        stop_time=options["StopTime"],
        output_interval=options["StepSize"],
        input=fmpy.read_csv(str(inputs)),
    )


def options_of(folder: Path) -> dict[str, float]:
    lines = (folder / f"{folder.name}_ref.opt").read_text().splitlines()
    return {name: float(value) for name, value in (line.split(", ") for line in lines)}


def bounds_of(folder: Path) -> dict[str, float]:
    rows = (folder / f"{folder.name}_bounds.csv").read_text().splitlines()[1:]
    return {name.strip('"'): float(bound) for name, bound in (row.split(",") for row in rows)}


def check(result: np.ndarray, reference: np.ndarray, bounds: dict[str, float]) -> None:
    assert len(result) == len(reference)
    assert np.allclose(result["time"], reference["time"], rtol=0.0, atol=1e-9)
    for name, bound in bounds.items():
        assert np.max(np.abs(result[name] - reference[name])) <= bound, name


def test_fmpy_is_within_the_bounds_in_every_row(folder: Path) -> None:
    name = folder.name
    result = simulated(folder / f"{name}.fmu", folder / f"{name}_in.csv", options_of(folder))
    check(result, fmpy.read_csv(str(folder / f"{name}_ref.csv")), bounds_of(folder))


def test_the_reference_inside_the_fmu_is_the_same(folder: Path) -> None:
    name = folder.name
    with zipfile.ZipFile(folder / f"{name}.fmu") as archive:
        for inside, beside in (("reference", "ref"), ("reference_inputs", "in")):
            own = archive.read(f"documentation/{inside}.csv")
            assert own == (folder / f"{name}_{beside}.csv").read_bytes()


def test_the_references_show_something(folder: Path) -> None:
    """At default start values the drive does nothing: its tunable parameters are inputs then."""
    reference = fmpy.read_csv(str(folder / f"{folder.name}_ref.csv"))
    plotted = find(folder.name).fmu().plotted
    assert max(np.ptp(reference[name]) for name in plotted) > 0.1


def test_the_folder_states_the_order_and_how_to_run_it(folder: Path) -> None:
    text = (folder / "README.txt").read_text()
    assert "read the outputs, set" in text
    assert "Start values are the FMU's defaults" in text
    call = re.search(r"fmpy\.simulate_fmu\((.*)\)", text)
    assert call is not None


def test_a_bound_is_ten_times_the_error_of_the_usual_settings() -> None:
    """And no less than rounding of the largest value, which counts as 1 at least."""
    times = [0.0, 1.0]
    exact = {"time": times, "a": [1.0, -2.0], "b": [30.0, -400.0], "c": [1e-3, 0.0]}
    usual = {"time": [0.0, 9.0], "a": [1.5, -1.25], "b": [30.0, -400.0], "c": [1e-3, 0.0]}
    found = _bounds(ReferenceResult({}, exact, []), ReferenceResult({}, usual, []))
    assert found == {"a": 7.5, "b": pytest.approx(4e-10), "c": 1e-12}


def bead(**starts: float) -> Fmu:
    """For two seconds, from other start values, without inputs."""
    fmu = find("BeadOnWire").fmu()
    named = {f"bead.{name}": start for name, start in starts.items()}
    variables = tuple(v._replace(start=named.get(v.name, v.start)) for v in fmu.variables)
    return fmu._replace(variables=variables, reference_inputs={}, stop_time=2.0, step_size=0.1)


def test_a_start_that_magnifies_roundings_has_a_reference_and_the_page_says_so() -> None:
    upright, hanging = bead(angle_start=3.14159265), bead(angle_start=0.1)
    result = reference_result(upright)
    assert len(result.time) == 21
    stated = _experiment(upright, result)
    assert ". It is less exact than that: the motion up to time " in stated
    assert re.search(r"magnifies [a-z ]+ to [0-9.e-]+ of it[^;:]*\.$", stated)
    tame = reference_result(hanging)
    assert tame.doubts == []
    assert _experiment(hanging, tame).endswith("tolerance of 1e-13.")


def test_start_values_that_do_not_run_are_a_mistake_in_the_declaration() -> None:
    with pytest.raises(CurveboundError, match=r"fails at t = 0 s: bead\.mass = -1\.0 kg"):
        reference_result(bead(mass=-1.0))

"""References: against printed values, against each other, and against the FMUs."""

from __future__ import annotations

from pathlib import Path
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

from curvebound.cosim import Scene, load_scene
from curvebound.errors import CurveboundError
from curvebound.study.reference.collocation import NOISE
from curvebound.study.reference.equations import System, carried
from curvebound.study.reference.reference import refer
from curvebound.study.reference.reference_set import judge
from curvebound.study.settings import space_of

pytest.importorskip("mpmath")
needs_long_double = pytest.mark.skipif(NOISE > 1e-18, reason="long double is a double here")

# 45-digit Taylor series and closed forms, 15 digits kept
BEAD = {"bead.bead.x": 0.275087462576117, "bead.bead.y": -0.961419205099125,
        "bead.bead.vx": -4.17559810095173, "bead.bead.vy": -1.19474905456048}  # fmt: skip
NONLINEAR = {"plant.slider.u": -0.112074121556804, "plant.pendulum.angle": -0.295201431642521,
             "plant.slider.u_rate": 1.11389439174177,
             "plant.pendulum.angular_velocity": 1.11460636851215}  # fmt: skip
LINEAR = {"plant.slider.u": 0.187964711805705, "plant.pendulum.angle": 0.215396108598008,
          "plant.slider.u_rate": 0.527241555358503,
          "plant.pendulum.angular_velocity": 1.90816142341263}  # fmt: skip


def single(name: str, fmu: str, start: dict[str, Any], stop: float = 10.0) -> Scene:
    scene = Scene(name, stop_time=stop, step=0.01)
    return scene.add(name, fmu, start)


@pytest.mark.parametrize(
    ("scene", "values"),
    [
        (single("bead", "BeadOnWire", {}), BEAD),
        (single("plant", "ParabolaPendulum", {}), NONLINEAR),
        (single("plant", "ParabolaPendulum", {"model.fidelity": "linear"}), LINEAR),
    ],
    ids=["bead", "nonlinear", "linear"],
)
@needs_long_double
def test_reference_gives_the_printed_digits(scene: Scene, values: dict[str, float]) -> None:
    reference = refer(scene.check(), list(values))
    found = reference.values([10.0])
    for path, value in values.items():
        assert float(found[path][0, 0]) == pytest.approx(value, rel=1e-14)
        assert reference.uncertainty(path, [10.0])[0, 0] < 1e-14


def test_a_reference_is_compared_at_a_hundred_times() -> None:
    reference = refer(single("plant", "ParabolaPendulum", {}, 0.05).check(), ["plant.slider.u"])
    assert reference._checks == pytest.approx(np.linspace(0.0, 0.05, 101), rel=1e-14)


@needs_long_double
def test_the_bead_that_turns_over_is_a_closed_form_too() -> None:
    scene = single("bead", "BeadOnWire", {"bead.angular_velocity_start": -9.0,
                                          "gravity.x": 2.0}, stop=3.0)  # fmt: skip
    reference = refer(scene.check(), ["bead.bead.angle"])
    assert "elliptic" in reference.how
    assert reference.uncertainty("bead.bead.angle", [3.0])[0, 0] < 1e-15
    assert float(reference.values([3.0])["bead.bead.angle"][0, 0]) < -15.0


@needs_long_double
def test_all_outputs_agree_with_an_fmu_run_finely_with_everything_on() -> None:
    """Drive, forces, damping, changing coefficient: no output's formula goes untested."""
    scene = single(
        "plant", "ParabolaPendulum",
        {"slider.damping": 0.3, "pendulum.damping": 0.2, "parabola.coefficient_rate_start": 0.05,
         "gravity.x": 0.7, "slider.mass": 2.0, "pendulum.length": 0.8,
         "solver.method": "adaptive", "solver.tolerance": 1e-13},
        stop=0.5,
    )  # fmt: skip
    for name, size in {"parabola.ax": 2.0, "parabola.ay": -1.5, "slider.fx": 1.0,
                       "slider.fy": 0.5, "pendulum.fx": -0.8, "pendulum.fy": 0.6,
                       "parabola.coefficient_acceleration": 0.1}.items():  # fmt: skip
        scene.input(f"plant.{name}", lambda t, size=size: size * np.cos(3.0 * t + size))
    for fidelity in ("nonlinear", "linear"):
        scene.set("plant.model.fidelity", fidelity)
        scene.recorded = ["*.*"]
        result = scene.run()
        skipped = ("solver.", "energy.residual", "acceleration_error")
        paths = [p for p in result.names if not any(word in p for word in skipped)]
        reference = refer(scene.check(), paths)
        exact = reference.values(result.time)
        for path in paths:
            size = max(1.0, float(np.abs(exact[path]).max()))
            difference = np.abs(result[path] - exact[path][:, 0]).max()
            assert float(difference) < 1e-12 * size, (fidelity, path)
            assert reference.uncertainty(path, [0.5])[0, 0] < 1e-14 * size, (fidelity, path)


@needs_long_double
def test_an_input_function_of_doubles_does_not_ask_for_endless_steps() -> None:
    scene = load_scene("shaken_wire")
    scene.stop_time = 2.0
    paths = ["bead.bead.angle"]
    reference = refer(scene.check(), paths, continuous=True)
    assert len(reference._trajectory.arrays()["times"]) < 300
    assert reference.uncertainty(paths[0], [2.0])[0, 0] < 1e-14


@needs_long_double
def test_a_sampled_loop_is_reproduced() -> None:
    scene = load_scene("sampled_feedback")
    scene.stop_time = 0.5
    scene.set("plant.solver.method", "adaptive").set("plant.solver.tolerance", 1e-13)
    paths = ["plant.slider.u", "plant.pendulum.angle", "drive.parabola.ax"]
    scene.recorded = list(paths)
    result = scene.run()
    exact = refer(scene.check(), paths).values(result.time)
    for path in paths:
        assert float(np.abs(result[path] - exact[path][:, 0]).max()) < 1e-11


def test_a_wrong_formula_shows_as_uncertainty(
    monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    from curvebound.study.reference.equations.mechanical import Mechanical

    right = Mechanical.accelerations

    def wrong(self: Mechanical, state: Any, inputs: Any) -> Any:
        a, b = right(self, state, inputs)
        return [a, b * (1 + 1e-9)]

    monkeypatch.setattr(Mechanical, "accelerations", wrong)
    system = single("plant", "ParabolaPendulum", {}, stop=1.0).check()
    monkeypatch.setenv("CURVEBOUND_CACHE", str(tmp_path))  # neither found nor left on disk
    reference = refer(system, ["plant.slider.u"])
    assert reference.uncertainty("plant.slider.u", [1.0])[0, 0] > 1e-11


def test_judge_needs_a_reference_a_hundred_times_surer() -> None:
    times = np.linspace(0.0, 1.0, 11)
    error = np.full(11, 1e-6)
    assert judge(times, error, np.full(11, 1e-8)).judged
    assert not judge(times, error, np.full(11, 2e-8)).judged
    growing = np.where(times <= 0.55, 1e-9, 1e-3)  # a chaotic motion's uncertainty
    verdict = judge(times, error, growing)
    assert verdict.judged
    assert verdict.until == pytest.approx(0.5)


@pytest.mark.parametrize("texts", [{}, {"reference": "MAIN = ()"}], ids=len)
def test_an_fmu_that_carries_no_equations_is_named(
    texts: dict[str, str], monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(carried, "stated_in", lambda fmu: texts)
    fmu: Any = SimpleNamespace(model_name="Odd", guid="{odd}", path=Path("odd.fmu"))
    with pytest.raises(CurveboundError, match=r"no reference for the FMU Odd: .*EQUATIONS"):
        carried.system_of(fmu)


def test_choices_that_nothing_has_together_are_refused(monkeypatch: pytest.MonkeyPatch) -> None:
    system = single("bead", "BeadOnWire", {}).check()
    structures = ({"a": "one", "b": "one"}, {"a": "two", "b": "two"})
    known = System("BeadOnWire", equations=None, structures=structures)  # type: ignore[arg-type]
    monkeypatch.setattr("curvebound.study.settings.system_of", lambda fmu: known)
    kept = space_of(system, {"bead.a": "two"}).structures
    assert kept == [(("bead.a", "two"), ("bead.b", "two"))]
    with pytest.raises(CurveboundError, match=r"has all of bead\.a=one, bead\.b=two"):
        space_of(system, {"bead.a": "one", "bead.b": "two"})
    with pytest.raises(CurveboundError, match=r"no choice bead\.a=three to keep; it has bead\.a="):
        space_of(system, {"bead.a": "three"})

"""Ten seconds of violent motion from the default start: a light slider, a needle of a parabola."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path

import numpy as np
import pytest

from curvebound.cosim.prepared import Prepared
from curvebound.cosim.scene import Scene

CASES = {
    "heavy bob": {"pendulum.mass": 1e6},
    "light slider": {"slider.mass": 1e-6},
    "needle": {"parabola.coefficient_start": 500.0},
    "spike, bob above": {"parabola.coefficient_start": -500.0, "slider.u_start": 1e-3},
    "light slider on a needle": {"slider.mass": 1e-6, "parabola.coefficient_start": 500.0},
}
#: a light slider is a heavy bob in other units
EVERY_DAY = [
    pytest.param(case, marks=pytest.mark.slow) if case == "light slider" else case for case in CASES
]


@pytest.fixture(scope="module")
def pendulum() -> Iterator[Prepared]:
    scene = Scene("violent", stop_time=10.0, step=0.1)
    scene.add("plant", "ParabolaPendulum", {})
    scene.record(
        *(
            f"plant.{name}"
            for name in (
                "energy.kinetic",
                "energy.potential",
                "energy.residual",
                "slider.u",
                "pendulum.angle",
                "solver.steps",
                "solver.evaluations",
            )
        )
    )
    with scene.prepare() as prepared:
        yield prepared


def run(prepared: Prepared, **values: object) -> np.ndarray:
    return prepared.run({f"plant.{name}": value for name, value in values.items()})


def imbalance(result: np.ndarray) -> float:
    """The largest residual over the largest kinetic energy."""
    residual = np.abs(result["plant.energy.residual"]).max()
    return float(residual / np.abs(result["plant.energy.kinetic"]).max())


@pytest.mark.parametrize("case", EVERY_DAY)
def test_adaptive_holds(pendulum: Prepared, case: str) -> None:
    """At the default tolerance; a hundred times finer ones agree with each other."""
    found = {}
    for tolerance in (1e-6, 1e-8, 1e-10):
        values = {**CASES[case], "solver.method": "adaptive", "solver.tolerance": tolerance}
        result = run(pendulum, **values)
        assert imbalance(result) < 1e-6
        assert result["plant.solver.evaluations"][-1] < 4e6
        found[tolerance] = result["plant.slider.u"][:30]
    assert np.abs(found[1e-8] - found[1e-10]).max() < 1e-6


@pytest.mark.parametrize("case", EVERY_DAY)
@pytest.mark.parametrize("step", [1e-3, 1e-2])
def test_implicit_holds(pendulum: Prepared, case: str, step: float) -> None:
    """At the default step, and at ten times as much: halved where the balance asks for it."""
    result = run(pendulum, **CASES[case], **{"solver.method": "implicit", "solver.step": step})
    assert imbalance(result) < 1e-6
    assert result["plant.solver.evaluations"][-1] < 2e6


def test_tame_motion_keeps_the_step_that_was_chosen(pendulum: Prepared) -> None:
    """Though its error of energy is far above what violent motion is held to."""
    result = run(pendulum, **{"solver.method": "implicit", "solver.step": 0.05})
    assert result["plant.solver.steps"][-1] == 200
    assert 1e-8 < imbalance(result) < 1e-2


def test_implicit_takes_no_solution_far_off():
    """On a nearly flat parabola that runs away from it; the kinetic energy came to 5e13 J."""
    scene = Scene("runaway", stop_time=1.3591409, step=0.27182818)
    scene.add(
        "plant",
        "ParabolaPendulum",
        {
            "gravity.x": -1.0,
            "gravity.y": -2.718281828459045,
            "parabola.coefficient_start": -0.0024787521766663585,
            "slider.u_start": -1.0,
            "slider.u_rate_start": -29.22392466744349,
            "pendulum.angular_velocity_start": -0.36787944117144233,
            "parabola.ax": 403.4287934927351,
            "parabola.ay": 3.4903429574618414,
            "slider.fx": -1.0,
            "slider.fy": -1.0,
            "pendulum.fx": -1.0,
            "solver.method": "implicit",
            "solver.step": 0.0543656365691809,
        },
    )
    scene.record("plant.energy.residual", "plant.energy.kinetic")
    result = scene.run()
    assert result["plant.energy.kinetic"].max() < 1e6
    assert abs(result["plant.energy.residual"]).max() < 0.5 * result["plant.energy.kinetic"].max()


def test_implicit_halves_no_step_of_linear_motion():
    scene = Scene("linear", stop_time=1.0, step=0.1)
    start = {"pendulum.mass": 1e3, "slider.u_start": 0.5, "pendulum.angle_start": 1.0}
    settings = {"model.fidelity": "linear", "solver.method": "implicit", "solver.step": 1e-3}
    scene.add("plant", "ParabolaPendulum", {**start, **settings})
    scene.record("plant.solver.steps")
    assert scene.run()["plant.solver.steps"][-1] == 1000


def test_what_the_readme_says(pendulum: Prepared) -> None:
    """The largest residual over the largest kinetic energy, at most twice."""
    readme = (Path(__file__).parents[2] / "README.md").read_text()
    adaptive = {"solver.method": "adaptive", "solver.tolerance": 1e-9}
    implicit = {"solver.method": "implicit", "solver.step": 1e-3}
    said = {"heavy bob": ("m2/m1 = 1e6", 4e-13, 1e-7), "needle": ("a = 500 1/m", 1e-14, 2e-8)}
    for case, (words, *figures) in said.items():
        assert f"{words}: {figures[0]:.0e}, {figures[1]:.0e}".replace("e-0", "e-") in readme
        for method, figure in zip((adaptive, implicit), figures, strict=True):
            assert imbalance(run(pendulum, **CASES[case], **method)) < 2.0 * figure

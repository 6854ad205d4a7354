"""Accuracy at 10 s and 2000 s against the solutions, through fmpy.simulate_fmu."""

from __future__ import annotations

import numpy as np
import pytest
from harness import Extracted, Value, final, simulated
from solutions import (
    ANGLE,
    BEAD_AT_2000,
    LINEAR,
    NONLINEAR,
    PROJECTION,
    SOLUTIONS,
    UNSTABILISED,
    Solution,
)

COUNTS = ("solver.steps", "solver.evaluations")


def errors_at_10(
    extracted: dict[str, Extracted],
    solution: Solution,
    parameters: dict[str, Value],
    **settings: float,
) -> tuple[float, float, list[int]]:
    """Largest errors of positions and of velocities at 10 s, steps and evaluations."""
    result = simulated(
        extracted[solution.fmu],
        {**solution.parameters, **parameters},
        [*solution.names, *COUNTS],
        **settings,
    )
    assert result["time"][-1] == pytest.approx(10.0, abs=1e-12)
    found = final(result, solution.names)
    errors = np.abs(np.subtract(found, solution.at_10))
    return max(errors[:2]), max(errors[2:]), [int(n) for n in final(result, COUNTS)]


# Velocities have bounds of their own: RK4's truncation error, the same in any implementation, is
# larger in them by the rates of the motion (2.4e-10 in the pendulum's angular velocity, 3.5e-8
# in the vertical velocity of the unstabilised bead).
@pytest.mark.parametrize(
    ("solution", "position", "velocity"),
    [
        pytest.param(ANGLE, 1e-10, 1e-10, id="angle"),
        pytest.param(PROJECTION, 1e-9, 1e-9, id="projection"),
        pytest.param(UNSTABILISED, 2e-8, 5e-8, id="none"),
        pytest.param(NONLINEAR, 1e-10, 4e-10, id="nonlinear"),
        pytest.param(LINEAR, 1e-10, 4e-10, id="linear"),
    ],
)
def test_rk4_with_steps_of_a_millisecond(extracted, solution, position, velocity) -> None:
    x, v, counts = errors_at_10(extracted, solution, {})  # rk4, 1e-3 s: the defaults
    assert x < position
    assert v < velocity
    assert counts == [10000, 40000]


@pytest.mark.parametrize("interval", [0.01, 1.0, 10.0])
def test_exact_at_any_communication_step(extracted, interval) -> None:
    x, v, counts = errors_at_10(extracted, LINEAR, {"solver.method": "exact"}, interval=interval)
    assert max(x, v) < 1e-12
    assert counts[0] == round(10.0 / interval)


# The evaluations bound the work beside the error: RK4 needs ten times as many.
@pytest.mark.parametrize(
    ("tolerance", "bound", "evaluations"), [(1e-10, 1e-8, 3500), (1e-13, 1e-11, 6700)]
)
@pytest.mark.parametrize("way", ["parameter", "fmi2SetupExperiment"])
@pytest.mark.parametrize("label", ["angle", "projection", "none", "nonlinear", "linear"])
def test_adaptive_meets_its_tolerance(extracted, label, way, tolerance, bound, evaluations) -> None:
    parameters: dict[str, Value] = {"solver.method": "adaptive"}
    settings = {"interval": 10.0}
    if way == "parameter":
        parameters["solver.tolerance"] = tolerance
    else:
        # overrides the parameter
        parameters["solver.tolerance"] = 1e-3
        settings["relative_tolerance"] = tolerance
    x, v, counts = errors_at_10(extracted, SOLUTIONS[label], parameters, **settings)
    assert x < bound
    # the rates of the motion multiply what the unstabilised bead has drifted
    assert v < (3.0 * bound if label == "none" else bound)
    assert counts[1] < evaluations


def test_adaptive_takes_the_tolerance_of_setup_experiment_bit_for_bit(extracted) -> None:
    def run(parameter: float, tolerance: float | None) -> tuple[float, float, list[int]]:
        return errors_at_10(
            extracted,
            NONLINEAR,
            {"solver.method": "adaptive", "solver.tolerance": parameter},
            interval=10.0,
            relative_tolerance=tolerance,
        )

    assert run(1e-10, None) == run(1e-3, 1e-10) == run(1e-13, 1e-10)
    coarse, fine = run(1e-10, None), run(1e-13, None)
    assert fine[2][1] > 1.5 * coarse[2][1]
    assert run(1e-13, 1e-3)[2][1] < coarse[2][1]


@pytest.mark.parametrize(
    "parameters",
    [
        pytest.param({"solver.method": "adaptive", "solver.tolerance": 1e-13}, id="cartesian"),
        pytest.param(
            {
                "solver.method": "adaptive",
                "solver.tolerance": 1e-13,
                "model.formulation": "angle",
            },
            id="angle",
        ),
        pytest.param(
            {
                "solver.method": "implicit",
                "solver.step": 2e-3,
                "model.formulation": "angle",
                "solver.max_steps": 2000000,
            },
            id="implicit",
            marks=pytest.mark.slow,
        ),
    ],
)
def test_bead_at_2000_s(extracted, parameters) -> None:
    result = simulated(
        extracted["BeadOnWire"],
        parameters,
        ["bead.x", "bead.y", "energy.residual", "constraint.drift", *COUNTS],
        stop_time=2000.0,
        interval=2000.0,
    )
    assert np.abs(np.subtract(final(result, ["bead.x", "bead.y"]), BEAD_AT_2000)).max() < 1e-6
    residual, drift, steps, evaluations = final(
        result, ["energy.residual", "constraint.drift", *COUNTS]
    )
    assert abs(residual) < 1e-8
    assert abs(drift) < 1e-14
    assert steps <= 1000000
    assert evaluations < 4e6

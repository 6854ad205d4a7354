"""The C code that the benchmark compares with solves the equations it claims to solve."""

from __future__ import annotations

import ctypes
import shutil
from pathlib import Path

import fmpy
import numpy as np
import pytest
from benchmarks import native
from benchmarks.cfmu import PLANTS, build_c_fmu
from benchmarks.ours import STATES, Loaded, interpreted_kernel
from benchmarks.references import REFERENCES, error_of, on_wire
from fmpy.fmi1 import FMICallException
from fmpy.validation import validate_fmu

from curvebound.errors import CurveboundError

pytestmark = pytest.mark.skipif(
    not any(map(shutil.which, ("gcc", "cc"))), reason="needs a C compiler"
)

SYSTEMS = {"BeadOnWire": "bead", "ParabolaPendulum": "pendulum"}


@pytest.fixture(scope="module")
def library() -> ctypes.CDLL:
    return native.kernel()


@pytest.fixture(scope="module")
def c_fmus(tmp_path_factory: pytest.TempPathFactory) -> dict[str, Loaded]:
    folder = tmp_path_factory.mktemp("c-fmus")
    return {
        name: Loaded.extract(name, build_c_fmu(name, folder), folder / f"{name}-extracted")
        for name in PLANTS
    }


def after_ten_seconds(library: ctypes.CDLL, case: str, count: int) -> tuple[float, ...]:
    bead, pendulum, linear = (ctypes.byref(system) for system in native.kernel_systems())
    start = {"angle": "angle", "nonlinear": "pendulum", "linear": "pendulum"}.get(case, "cartesian")
    state = native.State(*native.STARTS[start])
    steps = (10.0 / count, count, ctypes.byref(state))
    if case == "angle":
        library.run_bead_angle(bead, *steps)
        return on_wire(state.q0, state.v0)
    if case == "nonlinear":
        library.run_pendulum_nonlinear(pendulum, *steps)
    elif case == "linear":
        library.run_pendulum_linear(linear, *steps)
    else:
        library.run_bead_cartesian(bead, case == "projected", *steps)
    return (state.q0, state.q1, state.v0, state.v1)


@pytest.mark.parametrize(
    ("case", "system", "bound"),
    [
        ("cartesian", "bead", 4e-8),
        ("projected", "bead", 6e-10),
        ("angle", "bead", 8e-11),
        ("nonlinear", "pendulum", 3e-10),
        ("linear", "linear", 9e-11),
    ],
)
def test_kernel_meets_the_references_at_order_4(
    library: ctypes.CDLL, case: str, system: str, bound: float
) -> None:
    fine = error_of(system, after_ten_seconds(library, case, 10_000))
    coarse = error_of(system, after_ten_seconds(library, case, 5_000))
    assert 1e-15 < fine < bound
    assert np.log2(coarse / fine) == pytest.approx(4.0, abs=0.15)


def test_projection_keeps_the_bead_on_the_wire(library: ctypes.CDLL) -> None:
    x, y, vx, vy = after_ten_seconds(library, "projected", 1_000)
    assert abs(np.hypot(x, y) - 1.0) < 4e-16
    assert abs(x * vx + y * vy) < 4e-15
    x, y, _, _ = after_ten_seconds(library, "cartesian", 1_000)
    assert abs(np.hypot(x, y) - 1.0) > 1e-6


@pytest.mark.parametrize("name", PLANTS)
def test_c_fmu_is_valid_and_meets_the_references(c_fmus: dict[str, Loaded], name: str) -> None:
    loaded = c_fmus[name]
    assert validate_fmu(str(loaded.folder)) == []
    result = fmpy.simulate_fmu(
        str(loaded.folder), stop_time=10.0, output_interval=0.01, output=STATES[name]
    )
    final = tuple(float(result[-1][variable]) for variable in STATES[name])
    assert error_of(SYSTEMS[name], final) < 2e-9


@pytest.mark.parametrize("name", PLANTS)
def test_c_fmu_divides_steps_as_ours_do(c_fmus: dict[str, Loaded], name: str) -> None:
    loaded = c_fmus[name]
    read = [loaded.references[variable] for variable in STATES[name]]
    fine = loaded.slave({"solver.step": 1e-3})
    coarse = loaded.slave({"solver.step": 1e-3})
    for i in range(20):
        fine.doStep(i * 1e-3, 1e-3)
    coarse.doStep(0.0, 20e-3)
    assert coarse.getReal(read) == pytest.approx(fine.getReal(read), rel=0, abs=1e-15)
    whole = loaded.slave({"solver.step": 20e-3})
    whole.doStep(0.0, 20e-3)
    assert whole.getReal(read) != pytest.approx(fine.getReal(read), rel=0, abs=1e-15)


DRIVEN = {
    "BeadOnWire": (
        {
            "gravity.x": 1.5,
            "wire.radius": 0.7,
            "bead.mass": 2.0,
            "bead.damping": 0.3,
            "bead.angle_start": 0.4,
            "bead.angular_velocity_start": 9.0,
        },
        {"wire.ax": 3.0, "wire.ay": -2.0, "bead.fx": 1.2, "bead.fy": 0.8},
    ),
    "ParabolaPendulum": (
        {
            "gravity.x": 0.7,
            "parabola.coefficient_start": 0.8,
            "parabola.coefficient_rate_start": 0.1,
            "slider.mass": 1.7,
            "pendulum.mass": 0.6,
            "pendulum.length": 0.8,
            "slider.damping": 0.2,
            "pendulum.damping": 0.1,
            "slider.u_rate_start": 0.4,
            "pendulum.angular_velocity_start": -1.0,
        },
        {
            "parabola.ax": 2.0,
            "parabola.ay": 1.0,
            "parabola.coefficient_acceleration": 0.3,
            "slider.fx": 0.5,
            "slider.fy": -0.4,
            "pendulum.fx": 0.9,
            "pendulum.fy": 0.6,
        },
    ),
}


@pytest.mark.parametrize("name", PLANTS)
def test_c_fmu_has_the_same_driven_damped_physics(c_fmus: dict[str, Loaded], name: str) -> None:
    """All its outputs are those of our model under the same parameters, inputs and steps."""
    parameters, inputs = DRIVEN[name]
    kernel = interpreted_kernel()
    model = kernel.system(name, {**parameters, "model.fidelity": 2})
    method = kernel.method(3)
    model.set_inputs([inputs[key] for key in model.INPUTS], 0)
    loaded = c_fmus[name]
    slave = loaded.slave({**parameters, "solver.step": 2e-3})
    slave.setReal([loaded.references[key] for key in inputs], list(inputs.values()))
    for i in range(40):
        slave.doStep(i * 0.02, 0.02)
        model.keep()
        assert method.advance(model, 0.02, 10, 1e-6, 10**6) == 0
        model.advance_frame(0.02)
    expected = [0.0] * len(model.OUTPUTS)
    for group in set(model.OUTPUTS.values()):
        model.observe(group, expected, 0)
    outputs = [v.name for v in loaded.description.modelVariables if v.causality == "output"]
    assert len(outputs) >= 10
    names = list(model.OUTPUTS)
    measured = slave.getReal([loaded.references[key] for key in outputs])
    # the stages treat the drag along the radius differently, which is below the error of the method
    wanted = [expected[names.index(key)] for key in outputs]
    assert measured == pytest.approx(wanted, rel=0, abs=5e-10)


def test_c_fmu_counts_turns(c_fmus: dict[str, Loaded]) -> None:
    loaded = c_fmus["BeadOnWire"]
    for direction in (1.0, -1.0):
        slave = loaded.slave(
            {"bead.angle_start": 7.0 * direction, "bead.angular_velocity_start": 20.0 * direction}
        )
        angle = loaded.references["bead.angle"]
        before = 7.0
        for i in range(200):
            slave.doStep(i * 0.01, 0.01)
            now = direction * slave.getReal([angle])[0]
            assert 0.0 < now - before < 0.3
            before = now
        assert now > 7.0 + 4 * np.pi


@pytest.mark.parametrize("name", PLANTS)
def test_c_fmu_refuses_what_it_cannot_do(c_fmus: dict[str, Loaded], name: str) -> None:
    loaded = c_fmus[name]
    slave = loaded.slave()
    slave.doStep(0.0, 0.01)
    for point, size in ((0.01, 0.0), (0.01, -0.01), (0.5, 0.01), (0.01, float("nan"))):
        with pytest.raises(FMICallException):
            slave.doStep(point, size)
    with pytest.raises(FMICallException):
        slave.getReal([1000])
    with pytest.raises(FMICallException):
        slave.setReal([loaded.references["gravity.y"]], [float("nan")])
    slave.doStep(0.01, 0.01)
    with pytest.raises(FMICallException):
        loaded.slave({"solver.step": 0.0})


def test_unknown_c_fmu_and_missing_compiler_are_explained(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    with pytest.raises(CurveboundError, match="no C FMU ParabolaDrive"):
        build_c_fmu("ParabolaDrive", tmp_path)
    monkeypatch.setenv("PATH", "")
    monkeypatch.delenv("CC", raising=False)
    with pytest.raises(CurveboundError, match="install gcc"):
        native.compiler()


def test_references_are_those_of_the_closed_form() -> None:
    """The bead by elliptic functions: sin(angle/2) = k sn, with k = sin(pi/4)."""
    mpmath = pytest.importorskip("mpmath")
    omega = mpmath.sqrt(mpmath.mpf("9.81"))
    modulus = mpmath.mpf(1) / 2
    quarter = mpmath.ellipk(modulus)
    sn = mpmath.ellipfun("sn", quarter + omega * 10, m=modulus)
    angle = 2 * mpmath.asin(mpmath.sqrt(modulus) * sn)
    x, y, _, _ = REFERENCES["bead"]
    assert float(mpmath.sin(angle)) == pytest.approx(x, abs=1e-14)
    assert float(-mpmath.cos(angle)) == pytest.approx(y, abs=1e-14)

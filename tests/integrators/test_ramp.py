"""Inputs linear in time: every model and method against the equations of systems.md by scipy."""

from __future__ import annotations

import math
import random
from functools import cache
from typing import Any

import numpy as np
import pytest
from kernel_module import kernel_module
from scipy.integrate import solve_ivp

from curvebound.fmi.folder import find
from curvebound.kernel.base import Model
from curvebound.kernel.method import DONE
from curvebound.kernel.methods import METHODS, create
from curvebound.kernel.ramp import Ramp

DURATION = 0.4

MODELS = {
    "angle": ("BeadOnWire", {"model.formulation": 2, "constraint.stabilization": 1}),
    "projection": ("BeadOnWire", {"model.formulation": 1, "constraint.stabilization": 3}),
    "baumgarte": ("BeadOnWire", {"model.formulation": 1, "constraint.stabilization": 2}),
    "nonlinear": ("ParabolaPendulum", {"model.fidelity": 2}),
    "linear": ("ParabolaPendulum", {"model.fidelity": 1}),
}
#: kernels by hand and those derived from mechanics.py
KERNELS = [*MODELS, *(f"derived-{name}" for name in MODELS)]

PARAMETERS = {
    "BeadOnWire": {
        "gravity.x": 0.4,
        "gravity.y": -9.81,
        "wire.radius": 1.3,
        "bead.mass": 0.7,
        "bead.damping": 0.2,
        "bead.angle_start": 1.1,
        "bead.angular_velocity_start": -0.3,
        "constraint.stiffness": 100.0,
        "constraint.damping": 20.0,
    },
    "ParabolaPendulum": {
        "gravity.x": 0.4,
        "gravity.y": -9.81,
        "parabola.coefficient_start": 0.5,
        "parabola.coefficient_rate_start": 0.1,
        "slider.mass": 1.2,
        "pendulum.mass": 0.8,
        "pendulum.length": 0.9,
        "slider.damping": 0.3,
        "pendulum.damping": 0.1,
        "slider.u_start": 0.3,
        "slider.u_rate_start": 0.2,
        "pendulum.angle_start": 0.4,
        "pendulum.angular_velocity_start": -0.5,
    },
}

#: of all inputs, and of those which leave the coefficients of the linear equations alone
SIZES = {
    "BeadOnWire": ([2.0, 1.5, 0.7, -0.5], [-3.0, 2.0, 1.1, 4.0]),
    "ParabolaPendulum": (
        [2.0, 1.5, 0.2, 0.7, -0.5, 0.3, -0.4],
        [-3.0, 2.0, 1.5, 1.1, 4.0, -2.0, 2.5],
    ),
}
HORIZONTAL = [1.0, 0.0, 0.0, 1.0, 0.0, 1.0, 0.0]


@cache
def derived(fmu: str) -> Any:
    return kernel_module(find(fmu).derived())


#: nothing that moves or forces without an input
CALM = ("parabola.coefficient_rate_start", "bead.damping", "slider.damping", "pendulum.damping")


def started(
    kernel: str, *, steady: bool = False, calm: bool = False
) -> tuple[Any, dict[str, float]]:
    of, _, name = kernel.rpartition("-")
    fmu, choices = MODELS[name]
    parameters = dict(PARAMETERS[fmu])
    if steady:
        parameters["parabola.coefficient_rate_start"] = 0.0
    if calm:
        parameters |= {name: 0.0 for name in CALM if name in parameters}
    model = (derived(fmu) if of else find(fmu).module("kernel")).model(choices)
    model.start(parameters, choices)
    return model, parameters


def advanced(
    method: int, model: Model, first: list[float], slopes: list[float], duration: float, count: int
) -> None:
    """One communication step as the FMU makes it."""
    model.set_inputs(first, 0)
    model.keep()
    made = create(method)
    if made.MOVES:
        model.begin_rise(slopes)
        assert made.advance(model, duration, count, 1e-12, 100_000) == DONE
        model.end_rise(duration)
        return
    ramp = Ramp()
    ramp.begin(model, slopes, duration)
    assert made.advance(ramp, duration, count, 1e-12, 100_000) == DONE
    ramp.end()


def bead(p: dict[str, float], z: Any, u: Any) -> list[float]:
    """Rates of angle and angular velocity."""
    ax, ay, fx, fy = u
    m, r, d = p["bead.mass"], p["wire.radius"], p["bead.damping"]
    ex, ey = p["gravity.x"] + fx / m - ax, p["gravity.y"] + fy / m - ay
    return [z[1], (ex * math.cos(z[0]) + ey * math.sin(z[0])) / r - d / m * z[1]]


def pendulum(p: dict[str, float], z: Any, u: Any, a: float, rate: float) -> Any:
    """Rates of u, angle and theirs, by M q'' = b."""
    ax, ay, bend, f1x, f1y, f2x, f2y = u
    x, th, dx, dth = z
    m1, m2, r = p["slider.mass"], p["pendulum.mass"], p["pendulum.length"]
    m, s, c, q = m1 + m2, math.sin(th), math.cos(th), 2 * a * x
    sway, lift = ax - p["gravity.x"], ay - p["gravity.y"]
    mass = [[m * (1 + q * q), m2 * r * (c + q * s)], [m2 * r * (c + q * s), m2 * r * r]]
    path = 2 * a * dx * dx + x * x * bend + 4 * x * dx * rate
    b = [
        -m * (sway + q * (lift + path)) - m2 * r * dth * dth * (q * c - s),
        -m2 * r * (sway * c + s * (lift + path)),
    ]
    b[0] += f1x + f2x + q * (f1y + f2y) - p["slider.damping"] * dx * (1 + q * q)
    b[1] += r * (f2x * c + f2y * s) - p["pendulum.damping"] * dth
    return [dx, dth, *np.linalg.solve(mass, b)]


def small(p: dict[str, float], z: Any, u: Any, a: float) -> Any:
    """The same to first order in u and angle."""
    ax, ay, _, f1x, f1y, f2x, f2y = u
    x, th, dx, dth = z
    m1, m2, r = p["slider.mass"], p["pendulum.mass"], p["pendulum.length"]
    m, q = m1 + m2, 2 * a * x
    sway, lift = ax - p["gravity.x"], ay - p["gravity.y"]
    b = [
        -m * (sway + q * lift) + f1x + f2x + q * (f1y + f2y) - p["slider.damping"] * dx,
        -m2 * r * (sway + th * lift) + r * (f2x + th * f2y) - p["pendulum.damping"] * dth,
    ]
    return [dx, dth, *np.linalg.solve([[m, m2 * r], [m2 * r, m2 * r * r]], b)]


def given(name: str, *, steady: bool) -> tuple[list[float], list[float]]:
    """Inputs and their slopes; those that `exact` can follow."""
    first, slopes = SIZES[MODELS[name][0]]
    if steady:
        first = [first[0], first[1], 0.0, *first[3:]]
        slopes = [s * on for s, on in zip(slopes, HORIZONTAL, strict=True)]
    return first, slopes


@cache
def reference(name: str, *, steady: bool) -> list[float]:
    """The state after DURATION."""
    _, p = started(name, steady=steady)
    return solved(name, p, *given(name, steady=steady))


def solved(name: str, p: dict[str, float], first: list[float], slopes: list[float]) -> list[float]:
    """The state after DURATION by the equations of systems.md."""

    def inputs(t: float) -> Any:
        return np.array(first) + t * np.array(slopes)

    if MODELS[name][0] == "BeadOnWire":
        start = [p["bead.angle_start"], p["bead.angular_velocity_start"]]
        found = solve_ivp(
            lambda t, z: bead(p, z, inputs(t)), (0, DURATION), start, "DOP853", rtol=1e-13,
            atol=1e-13,
        )  # fmt: skip
        return list(found.y[:, -1])

    def rates(t: float, z: Any) -> Any:
        a0, rate, bend, jerk = (
            p["parabola.coefficient_start"], p["parabola.coefficient_rate_start"],
            first[2], slopes[2],
        )  # fmt: skip
        a = a0 + t * (rate + t * (bend / 2 + t * jerk / 6))
        rate += t * (bend + t * jerk / 2)
        u = inputs(t)
        return small(p, z, u, a) if name == "linear" else pendulum(p, z, u, a, rate)

    start = [p[f"{n}_start"] for n in (
        "slider.u", "pendulum.angle", "slider.u_rate", "pendulum.angular_velocity")]  # fmt: skip
    found = solve_ivp(rates, (0, DURATION), start, "DOP853", rtol=1e-13, atol=1e-13)
    return list(found.y[:, -1])


def state_of(model: Any) -> list[float]:
    values = [0.0] * len(model.OUTPUTS)
    model.observe(0, values, 0)
    at = dict(zip(model.OUTPUTS, values, strict=True))
    if "bead.angle" in at:
        return [at["bead.angle"], at["bead.angular_velocity"]]
    return [
        at[n] for n in ("slider.u", "pendulum.angle", "slider.u_rate", "pendulum.angular_velocity")
    ]


def residual(model: Any) -> float:
    values = [0.0] * len(model.OUTPUTS)
    model.observe(model.OUTPUTS["energy.residual"], values, 0)
    return values[list(model.OUTPUTS).index("energy.residual")]


#: method -> internal steps, error allowed
ALLOWED = {
    "explicit_euler": (4_000, 2e-3),
    "semi_implicit_euler": (4_000, 2e-3),
    "rk4": (400, 1e-9),
    "adaptive": (1, 1e-10),
    "implicit": (400, 1e-9),
    "exact": (1, 1e-12),
}


@pytest.mark.parametrize("kernel", KERNELS)
@pytest.mark.parametrize("method", METHODS)
def test_motion_and_work(kernel: str, method: str) -> None:
    of, _, name = kernel.rpartition("-")
    if (method == "exact" and name != "linear") or (of and "euler" in method):
        return
    fmu = MODELS[name][0]
    steady = method == "exact"
    first, slopes = given(name, steady=steady)
    model, parameters = started(kernel, steady=steady)
    count, allowed = ALLOWED[method]
    advanced(METHODS.index(method) + 1, model, first, slopes, DURATION, count)
    true = reference(name, steady=steady)
    assert np.allclose(state_of(model), true, rtol=0, atol=allowed)
    assert abs(residual(model)) <= 20 * allowed
    t = DURATION
    assert model.vx == pytest.approx(t * (first[0] + t * slopes[0] / 2), rel=1e-14)
    assert model.y == pytest.approx(t * t * (first[1] / 2 + t * slopes[1] / 6), rel=1e-14)
    assert model.ax == first[0] + t * slopes[0]
    if fmu == "ParabolaPendulum":
        rate = parameters["parabola.coefficient_rate_start"]
        a = 0.5 + t * (rate + t * (first[2] / 2 + t * slopes[2] / 6))
        assert model.a == pytest.approx(a, rel=1e-14)


@cache
def alone(name: str, number: int, share: float) -> list[float]:
    """The state after DURATION with one input, which is zero after a share of it."""
    _, p = started(name, calm=True)
    return solved(name, p, *one_alone(name, number, share))


def one_alone(name: str, number: int, share: float) -> tuple[list[float], list[float]]:
    """Inputs and their slopes."""
    slopes = [0.0] * len(SIZES[MODELS[name][0]][0])
    first = [*slopes]
    slopes[number] = 2.0
    first[number] = -2.0 * share * DURATION
    return first, slopes


@pytest.mark.parametrize("share", [0.0, 0.5, 1.0])
@pytest.mark.parametrize("kernel", KERNELS)
def test_a_term_that_is_off_once_counts_before_and_after(kernel: str, share: float) -> None:
    name = kernel.rpartition("-")[2]
    for number in range(len(SIZES[MODELS[name][0]][0])):
        first, slopes = one_alone(name, number, share)
        for method, count in ((3, 400), (4, 1)):
            model, _ = started(kernel, calm=True)
            advanced(method, model, first, slopes, DURATION, count)
            true = alone(name, number, share)
            assert np.allclose(state_of(model), true, rtol=0, atol=1e-9)
            assert abs(residual(model)) <= 2e-8
            # and then it is as if it had been set
            other, _ = started(kernel, calm=True)
            other.set_state(model.get_state())
            other.set_inputs(model.inputs[: model.input_count], 0)
            for flag in ("works", "moving", "plain", "forced", "pushed", "reshapes", "is_constant"):
                assert getattr(model, flag, None) == getattr(other, flag, None)


class Pushed(Model):
    """A mass of 0.5 kg under a force; whether there is one is all derived in refresh()."""

    INPUTS = ("force",)

    def __init__(self) -> None:
        super().__init__()
        self.force = self.push = 0.0

    def take_inputs(self, t: float) -> None:
        self.force = self.inputs[0] + t * self.slopes[0]

    def refresh(self) -> None:
        self.works = self.force != 0.0
        self.push = 2.0 * self.force

    def acceleration(self, t: float, q0: float, q1: float, v0: float, v1: float) -> None:
        self.a0 = self.push if self.works else 0.0

    def power(
        self, t: float, q0: float, q1: float, v0: float, v1: float, a0: float, a1: float
    ) -> float:
        return self.force * v0

    def keep(self) -> None:
        """It is not undone."""


@pytest.mark.parametrize("method", [3, 4])
def test_a_kernel_need_not_tell_values_from_terms(method: int) -> None:
    for first in (0.0, -3.0, 1.0):
        model = Pushed()
        advanced(method, model, [first], [3.0], 1.0, 2)
        assert model.q0 == pytest.approx(first + 1.0, rel=1e-14, abs=1e-14)
        assert model.v0 == pytest.approx(2.0 * first + 3.0, rel=1e-14)
        assert model.work == pytest.approx(0.25 * model.v0**2, rel=1e-13)
        assert (model.inputs[0], model.slopes[0], model.rises) == (first + 3.0, 0.0, False)


def test_inputs_end_where_their_slopes_lead() -> None:
    """To the bit: an FMU of a saved state has them so."""
    for name in MODELS:
        first, slopes = SIZES[MODELS[name][0]]
        model, _ = started(name)
        for method, count in ((3, 3), (3, 7), (4, 1)):
            advanced(method, model, first, slopes, 0.1, count)
            assert model.inputs[: len(first)] == [
                x + 0.1 * slope for x, slope in zip(first, slopes, strict=True)
            ]


@pytest.mark.parametrize("name", MODELS)
def test_cut_anywhere_it_is_the_same_motion(name: str) -> None:
    first, slopes = SIZES[MODELS[name][0]]
    whole, _ = started(name)
    advanced(4, whole, first, slopes, DURATION, 1)
    cut, _ = started(name)
    rng = random.Random(5)
    t = 0.0
    while t < DURATION:
        h = min(rng.uniform(0.01, 0.2), DURATION - t)
        now = [u + t * s for u, s in zip(first, slopes, strict=True)]
        advanced(4, cut, now, slopes, h, 1)
        t += h
    assert np.allclose(state_of(cut), state_of(whole), rtol=0, atol=2e-10)
    assert cut.work == pytest.approx(whole.work, abs=2e-9)
    assert (cut.x, cut.y) == pytest.approx((whole.x, whole.y), rel=1e-13)


def test_exact_tells_which_slopes_it_cannot_follow() -> None:
    model, _ = started("linear", steady=True)
    model.set_inputs([0.0] * 7, 0)
    model.keep()
    ramp = Ramp()
    ramp.begin(model, [1.0, 0.0, 0.0, 1.0, 0.0, 1.0, 0.0], 0.1)
    assert not ramp.varies()
    for i in (1, 2, 4, 6):
        slopes = [1.0 if k in (0, i) else 0.0 for k in range(7)]
        ramp.begin(model, slopes, 0.1)
        assert ramp.varies()
        assert ramp.variation() == f"{model.INPUTS[i]} with its slope of 1.0 per s"
        model.undo()

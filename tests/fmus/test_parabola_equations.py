"""The pendulum on the parabola against sympy's derivation and Newton's law, at random states."""

from __future__ import annotations

import math
import random
from typing import Any

import mpmath
import pytest

from curvebound.fmi.folder import find
from curvebound.kernel.base import acceleration_of, jacobian_of

ParabolaNonlinear = find("ParabolaPendulum").module("kernel").ParabolaNonlinear
parabola_pendulum = find("ParabolaPendulum").module("kernel").model

NONLINEAR = {"model.fidelity": 2}
LINEAR = {"model.fidelity": 1}

#: what may be on: drive of the vertex, shape, forces, damping; upright: gravity has no x
TERMS = [
    (),
    ("upright",),
    ("vertex",),
    ("shape",),
    ("forces",),
    ("damping",),
    ("vertex", "shape", "forces", "damping"),
]


def case(rng: random.Random, terms: tuple[str, ...], **fixed: float) -> tuple[Any, ...]:
    """Parameters, inputs, frame velocity, time in the step and state, with all `terms` random."""

    def pick(on: bool = True, size: float = 3.0) -> float:
        return rng.uniform(-size, size) if on else 0.0

    vertex, shape, forces, damping = (n in terms for n in ("vertex", "shape", "forces", "damping"))
    parameters = {
        "gravity.x": pick("upright" not in terms),
        "gravity.y": -9.81 + pick(),
        "parabola.coefficient_start": pick(),
        "parabola.coefficient_rate_start": pick(shape),
        "slider.mass": math.exp(pick()),
        "pendulum.mass": math.exp(pick()),
        "pendulum.length": math.exp(pick(size=1.0)),
        "slider.damping": abs(pick(damping)),
        "pendulum.damping": abs(pick(damping)),
        "slider.u_start": pick(),
        "slider.u_rate_start": pick(),
        "pendulum.angle_start": pick(),
        "pendulum.angular_velocity_start": pick(),
    }
    parameters.update(fixed)
    inputs = [pick(vertex), pick(vertex), pick(shape), *(pick(forces, 20.0) for _ in range(4))]
    return parameters, inputs, (pick(vertex), pick(vertex)), abs(pick())


def started(choices: dict[str, int], made: tuple[Any, ...]) -> Any:
    parameters, inputs, (vx, vy), _ = made
    model = parabola_pendulum(choices)
    model.start(parameters, choices)
    model.vx, model.vy = vx, vy
    model.set_inputs(inputs, 0)
    return model


def by_symbol(made: tuple[Any, ...], t: float) -> dict[str, Any]:
    """The same case for the derived equations, t seconds into the communication step."""
    p, inputs, (vx, vy), _ = made
    with mpmath.workdps(60):
        ax, ay, a_2, *forces = map(mpmath.mpf, inputs)
        t = mpmath.mpf(t)
        a, a_1 = p["parabola.coefficient_start"], p["parabola.coefficient_rate_start"]
        values = {
            "X_1": vx + t * ax,
            "Y_1": vy + t * ay,
            "X_2": ax,
            "Y_2": ay,
            "a_0": a + t * (a_1 + t * a_2 / 2),
            "a_1": a_1 + t * a_2,
            "a_2": a_2,
            "X_0": 0.0,
            "Y_0": 0.0,
        }
    values.update(zip(("f1x", "f1y", "f2x", "f2y"), forces, strict=True))
    for symbol, name in {
        "m1": "slider.mass",
        "m2": "pendulum.mass",
        "r": "pendulum.length",
        "c1": "slider.damping",
        "c2": "pendulum.damping",
        "gx": "gravity.x",
        "gy": "gravity.y",
        "u_0": "slider.u_start",
        "u_1": "slider.u_rate_start",
        "th_0": "pendulum.angle_start",
        "th_1": "pendulum.angular_velocity_start",
    }.items():
        values[symbol] = p[name]
    return values


def state(model: Any) -> tuple[float, float, float, float]:
    return model.q0, model.q1, model.v0, model.v1


def close(got: Any, true: Any, size: Any, tolerance: float = 1e-12) -> None:
    assert abs(mpmath.mpf(got) - true) <= tolerance * abs(size), (got, true, size)


@pytest.mark.parametrize("terms", TERMS, ids=lambda t: "+".join(t) or "free")
@pytest.mark.parametrize("fidelity", ["nonlinear", "linear"])
def test_acceleration_is_that_of_the_lagrangian(
    fidelity: str, terms: tuple[str, ...], rng: random.Random, request: pytest.FixtureRequest
) -> None:
    name = "parabola_mechanics" if fidelity == "nonlinear" else "linear_mechanics"
    mechanics = request.getfixturevalue(name)
    for _ in range(8):
        made = case(rng, terms)
        t = made[3] if "shape" in terms else 0.0
        model = started(NONLINEAR if fidelity == "nonlinear" else LINEAR, made)
        a0, a1 = acceleration_of(model, t, *state(model))
        true0, true1 = mechanics.acceleration(by_symbol(made, t))
        # relative to the vector: one component may vanish by chance
        r = made[0]["pendulum.length"]
        size = mpmath.hypot(true0, r * true1)
        close(a0, true0, size)
        close(r * a1, r * true1, size)


@pytest.mark.parametrize(
    "fixed",
    [
        {"slider.mass": 1e-12, "pendulum.mass": 1.0},
        {"slider.mass": 1e12, "pendulum.mass": 1.0},
        {"slider.mass": 1e-6, "pendulum.mass": 1e6},
        {"parabola.coefficient_start": 1e4},
        {"parabola.coefficient_start": -1e4},
        {"parabola.coefficient_start": 1e4, "slider.mass": 1e-12, "pendulum.mass": 1.0},
        {"parabola.coefficient_start": 1e-8},
    ],
    ids=lambda f: ",".join(f"{k.split('.')[1]}={v:g}" for k, v in f.items()),
)
@pytest.mark.parametrize("terms", [(), TERMS[-1]], ids=["free", "all"])
def test_no_cancellation_at_the_extremes(
    fixed: dict[str, float], terms: tuple[str, ...], rng: random.Random, parabola_mechanics: Any
) -> None:
    for _ in range(8):
        made = case(rng, terms, **fixed)
        t = made[3] if "shape" in terms else 0.0
        model = started(NONLINEAR, made)
        got = acceleration_of(model, t, *state(model))
        for g, true in zip(got, parabola_mechanics.acceleration(by_symbol(made, t)), strict=True):
            close(g, true, true)


def test_rod_along_the_tangent_of_a_light_slider(
    rng: random.Random, parabola_mechanics: Any
) -> None:
    """The determinant of the mass matrix all but vanishes: m1/m2 = 1e-12."""
    for _ in range(8):
        made = case(rng, (), **{"slider.mass": 1e-12, "pendulum.mass": 1.0})
        p = made[0]
        slope = 2.0 * p["parabola.coefficient_start"] * p["slider.u_start"]
        p["pendulum.angle_start"] = math.atan(slope) + 1e-5
        model = started(NONLINEAR, made)
        a0, a1 = acceleration_of(model, 0.0, *state(model))
        true0, true1 = parabola_mechanics.acceleration(by_symbol(made, 0.0))
        # a rounding of the angle alone changes k, and with it these, by about 1e-11
        close(a0, true0, true0, 1e-9)
        close(a1, true1, true1, 1e-9)


@pytest.mark.parametrize("fidelity", ["nonlinear", "linear"])
@pytest.mark.parametrize("terms", TERMS, ids=lambda t: "+".join(t) or "free")
def test_jacobian(
    fidelity: str, terms: tuple[str, ...], rng: random.Random, request: pytest.FixtureRequest
) -> None:
    name = "parabola_mechanics" if fidelity == "nonlinear" else "linear_mechanics"
    mechanics = request.getfixturevalue(name)
    for _ in range(4):
        made = case(rng, terms)
        t = made[3]
        model = started(NONLINEAR if fidelity == "nonlinear" else LINEAR, made)
        got = jacobian_of(model, t, *state(model))
        (uu, uth, up, uo), (tu, tth, tp, to) = mechanics.derivatives(by_symbol(made, t))
        true = (uu, uth, tu, tth, up, uo, tp, to)
        size = max(map(abs, true))
        for g, x in zip(got, true, strict=True):
            close(g, x, size, 1e-11)


def bodies(made: tuple[Any, ...], values: dict[str, Any]) -> tuple[Any, ...]:
    """Accelerations of slider and bob in the world, in 60 digits, from q'' in `values`."""
    u, th, du, dth, ddu, ddth = (values[n] for n in ("u_0", "th_0", "u_1", "th_1", "u_2", "th_2"))
    a, da, dda = values["a_0"], values["a_1"], values["a_2"]
    r = values["r"]
    s, c = mpmath.sin(th), mpmath.cos(th)
    x = values["X_2"] + ddu
    y = values["Y_2"] + dda * u * u + 4 * da * u * du + 2 * a * (du * du + u * ddu)
    bx = x + r * (ddth * c - dth * dth * s)
    by = y + r * (ddth * s + dth * dth * c)
    return x, y, bx, by, s, c


@pytest.mark.parametrize("fixed", [{}, {"slider.mass": 1e-12}], ids=["usual", "light slider"])
@pytest.mark.parametrize("terms", TERMS, ids=lambda t: "+".join(t) or "free")
def test_forces_obey_newtons_law(
    terms: tuple[str, ...],
    fixed: dict[str, float],
    rng: random.Random,
    parabola_mechanics: Any,
    outputs: Any,
) -> None:
    for _ in range(6):
        made = case(rng, terms, **fixed)
        model = started(NONLINEAR, made)
        got = outputs(model)
        with mpmath.workdps(60):
            v = parabola_mechanics.with_acceleration(by_symbol(made, 0.0))
            x, y, bx, by, s, c = bodies(made, v)
            m1, m2, gx, gy = (mpmath.mpf(v[n]) for n in ("m1", "m2", "gx", "gy"))
            # the whole: gravity, inputs and the parabola's force move the centre of mass
            rx = m1 * (x - gx) + m2 * (bx - gx) - v["f1x"] - v["f2x"]
            ry = m1 * (y - gy) + m2 * (by - gy) - v["f1y"] - v["f2y"]
            # the bob: its part along the rod
            tension = -(m2 * (bx - gx) - v["f2x"]) * s + (m2 * (by - gy) - v["f2y"]) * c
            q = 2 * v["a_0"] * v["u_0"]
            normal = (ry - q * rx) / mpmath.sqrt(1 + q * q)
            size = abs(rx) + abs(ry) + abs(tension) + m2 * abs(gy)
            close(got["parabola.fx"], -rx, size)
            close(got["parabola.fy"], -ry, size)
            close(got["pendulum.tension"], tension, size)
            close(got["constraint.normal_force"], normal, size)
            # friction is what is left along the parabola
            along = (rx + q * ry) / (1 + q * q)
            close(-v["c1"] * v["u_1"], along, size)


@pytest.mark.parametrize("terms", TERMS, ids=lambda t: "+".join(t) or "free")
def test_linear_forces_obey_newtons_law_for_the_linear_motion(
    terms: tuple[str, ...], rng: random.Random, linear_mechanics: Any, outputs: Any
) -> None:
    for _ in range(6):
        made = case(rng, terms)
        got = outputs(started(LINEAR, made))
        v = linear_mechanics.with_acceleration(by_symbol(made, 0.0))
        x, y, bx, by, s, c = bodies(made, v)
        rx = v["m1"] * (x - v["gx"]) + v["m2"] * (bx - v["gx"]) - v["f1x"] - v["f2x"]
        ry = v["m1"] * (y - v["gy"]) + v["m2"] * (by - v["gy"]) - v["f1y"] - v["f2y"]
        tension = -(v["m2"] * (bx - v["gx"]) - v["f2x"]) * s
        tension += (v["m2"] * (by - v["gy"]) - v["f2y"]) * c
        size = abs(rx) + abs(ry) + abs(tension)
        q = 2 * v["a_0"] * v["u_0"]
        close(got["parabola.fx"], -rx, size)
        close(got["parabola.fy"], -ry, size)
        close(got["pendulum.tension"], tension, size)
        close(got["constraint.normal_force"], (ry - q * rx) / mpmath.sqrt(1 + q * q), size)


@pytest.mark.parametrize("fidelity", ["nonlinear", "linear"])
@pytest.mark.parametrize("terms", TERMS, ids=lambda t: "+".join(t) or "free")
def test_energy_changes_by_power(
    fidelity: str,
    terms: tuple[str, ...],
    rng: random.Random,
    outputs: Any,
    request: pytest.FixtureRequest,
) -> None:
    name = "parabola_mechanics" if fidelity == "nonlinear" else "linear_mechanics"
    mechanics = request.getfixturevalue(name)
    for _ in range(6):
        made = case(rng, terms)
        model = started(NONLINEAR if fidelity == "nonlinear" else LINEAR, made)
        now = mechanics.arguments(by_symbol(made, 0.0))
        energy = mechanics.energy(*now)
        out = outputs(model)
        close(out["energy.total"], energy, abs(energy) + out["energy.kinetic"])
        assert out["energy.total"] == out["energy.kinetic"] + out["energy.potential"]

        t = made[3]
        v = mechanics.with_acceleration(by_symbol(made, t))
        rate = mechanics.energy_rate(*mechanics.arguments(v))
        q = state(model)
        power = model.power(t, *q, *acceleration_of(model, t, *q))
        size = abs(rate) + out["energy.kinetic"] + 1.0
        # several large powers may nearly balance
        close(power, rate, size, 1e-11)
        if not model.works:
            assert power == 0.0
            close(0.0, rate, size, 1e-11)
        assert model.works == (terms not in ((), ("upright",)))


def test_linear_system_and_power_form(rng: random.Random) -> None:
    for terms in TERMS:
        if "shape" in terms:
            continue
        made = case(rng, terms)
        model = started(LINEAR, made)
        assert model.is_linear
        assert model.is_constant
        z = (*state(model), 1.0)
        a = acceleration_of(model, 0.0, *z[:4])
        matrix = model.linear_system()
        rates = [sum(m * x for m, x in zip(row, z, strict=True)) for row in matrix]
        assert rates[:2] == [model.v0, model.v1]
        assert rates[2:4] == pytest.approx(a, rel=1e-12, abs=1e-12)
        assert rates[4] == 0.0
        form = model.power_form()
        assert all(form[i][j] == form[j][i] for i in range(5) for j in range(5))
        power = sum(z[i] * form[i][j] * z[j] for i in range(5) for j in range(5))
        assert power == pytest.approx(model.power(0.0, *z[:4], *a), rel=1e-12, abs=1e-11)


def test_linearity_is_told(parabola_defaults: dict[str, float]) -> None:
    model = parabola_pendulum(LINEAR)
    model.start({**parabola_defaults, "parabola.coefficient_rate_start": 0.1}, LINEAR)
    assert model.is_linear
    assert not model.is_constant
    model.start(parabola_defaults, LINEAR)
    assert model.is_constant
    model.set_inputs([0.0, 0.0, 0.5, 0.0, 0.0, 0.0, 0.0], 0)
    assert not model.is_constant
    assert not parabola_pendulum(NONLINEAR).is_linear


def test_acceleration_error_is_of_second_order(
    parabola_defaults: dict[str, float], outputs: Any
) -> None:
    errors = []
    for size in (0.1, 0.05):
        start = {"slider.u_start": size, "pendulum.angle_start": -size}
        model = parabola_pendulum(LINEAR)
        model.start({**parabola_defaults, **start}, LINEAR)
        error = outputs(model)["model.acceleration_error"]
        exact = ParabolaNonlinear()
        exact.start({**parabola_defaults, **start}, NONLINEAR)
        assert outputs(exact)["model.acceleration_error"] == 0.0
        a = acceleration_of(model, 0.0, *state(model))
        b = acceleration_of(exact, 0.0, *state(exact))
        difference = math.hypot(a[0] - b[0], a[1] - b[1])
        assert error == pytest.approx(difference / max(math.hypot(*a), math.hypot(*b)))
        errors.append(error)
    assert errors[0] / errors[1] == pytest.approx(4.0, rel=0.05)
    at_rest = {"slider.u_start": 0.0, "pendulum.angle_start": 0.0}
    model = parabola_pendulum(LINEAR)
    model.start({**parabola_defaults, **at_rest}, LINEAR)
    assert outputs(model)["model.acceleration_error"] == 0.0


def test_unknown_fidelity_is_refused() -> None:
    with pytest.raises(ValueError, match=r"model\.fidelity is 3: choose 1 .* or 2"):
        parabola_pendulum({"model.fidelity": 3})

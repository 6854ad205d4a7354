"""The linear pendulum in coordinates that part its modes: the same system, and all its digits."""

from __future__ import annotations

import random
from typing import Any

import mpmath as mp
import pytest

from curvebound.fmi.folder import find
from curvebound.kernel.method import DONE
from curvebound.kernel.methods import create

parabola_pendulum = find("ParabolaPendulum").module("kernel").model

LINEAR = {"model.fidelity": 1}


def pendulum(inputs: dict[str, float] | None = None, **changes: float) -> Any:
    model = parabola_pendulum(LINEAR)
    values = dict.fromkeys(model.PARAMETERS, 0.0)
    values |= {"gravity.y": -9.81, "parabola.coefficient_start": 0.5, "slider.mass": 1.0}
    values |= {"pendulum.mass": 1.0, "pendulum.length": 1.0, "slider.u_start": 0.5}
    values |= {"pendulum.angle_start": 0.5, **changes}
    model.start(values, LINEAR)
    model.set_inputs([(inputs or {}).get(name, 0.0) for name in model.INPUTS], 0)
    return model


def matrix(rows: list[list[float]]) -> mp.matrix:
    return mp.matrix([[mp.mpf(x) for x in row] for row in rows])


def test_the_separated_system_is_the_system() -> None:
    rng = random.Random(4)
    for _ in range(50):
        changes = {
            "parabola.coefficient_start": rng.uniform(-0.4, 2.0),
            "slider.mass": 10 ** rng.uniform(-2, 2),
            "pendulum.mass": 10 ** rng.uniform(-2, 2),
            "pendulum.length": 10 ** rng.uniform(-1, 0),
            "slider.damping": rng.uniform(0, 2),
            "pendulum.damping": rng.uniform(0, 2),
            "gravity.x": rng.uniform(-5, 5),
        }
        names = parabola_pendulum(LINEAR).INPUTS
        inputs = {n: rng.uniform(-3, 3) for n in names if "coefficient" not in n}
        model = pendulum(inputs, **changes)
        separated, ahead, back = model.separation()
        with mp.workdps(40):
            unit = matrix(ahead) * matrix(back)
            assert max(abs(unit[i, j] - (i == j)) for i in range(5) for j in range(5)) < 1e-15
            own = matrix(ahead) * matrix(model.linear_system()) * matrix(back)
            size = max(abs(x) for x in own)
            difference = own - matrix(separated)
            assert max(abs(x) for x in difference) < 1e-12 * size


def truth(model: Any, t: float) -> list[mp.mpf]:
    """The state after t s without damping and inputs, from the equations in 60 digits."""
    with mp.workdps(60):
        m1, m2, r, a, g = (mp.mpf(x) for x in (model.m1, model.m2, model.r, model.a, -model.gy))
        k = (m1 + m2) / m1
        system = mp.matrix(4, 4)
        system[0, 2] = system[1, 3] = 1
        system[2, 0], system[2, 1] = -k * 2 * g * a, m2 / m1 * g
        system[3, 0], system[3, 1] = k / r * 2 * g * a, -k / r * g
        start = mp.matrix([model.q0, model.q1, model.v0, model.v1])
        return list(mp.expm(system * mp.mpf(t)) * start)


@pytest.mark.parametrize("coefficient", [0.5, 0.0, -0.3, 20.0])
@pytest.mark.parametrize("ratio", [1e-8, 1e-4, 1.0, 1e4, 1e8])
def test_no_mass_ratio_takes_digits_from_the_slow_mode(ratio: float, coefficient: float) -> None:
    """From a start in which the slow mode prevails; of the fast one rounding is what there is."""
    model = pendulum(
        **{
            "slider.mass": ratio,
            "parabola.coefficient_start": coefficient,
            "pendulum.angle_start": 2 * coefficient * 0.5,
        }
    )
    expected = truth(model, 3.0)
    for pieces in (1, 30):
        again = pendulum(
            **{
                "slider.mass": ratio,
                "parabola.coefficient_start": coefficient,
                "pendulum.angle_start": 2 * coefficient * 0.5,
            }
        )
        method = create(6)
        for _ in range(pieces):
            assert method.advance(again, 3.0 / pieces, 1, 1e-6, 1) == DONE
        u, th = float(expected[0]), float(expected[1])
        assert again.q0 == pytest.approx(u, rel=2e-12, abs=1e-13)
        assert again.q1 == pytest.approx(th, rel=2e-12, abs=1e-13)


def test_near_the_coefficient_where_the_coordinates_are_alike() -> None:
    """1 + 2 a r m2/(m1+m2) = 0: there the model's own coordinates serve."""
    for coefficient in (-1.0, -0.999, -1.001):
        model = pendulum(**{"parabola.coefficient_start": coefficient})
        assert model.separation() == ([], [], [])
        expected = truth(model, 1.0)
        assert create(6).advance(model, 1.0, 1, 1e-6, 1) == DONE
        assert model.q0 == pytest.approx(float(expected[0]), rel=1e-13)
        assert model.q1 == pytest.approx(float(expected[1]), rel=1e-13)


@pytest.mark.parametrize("ratio", [1e-6, 1.0, 1e6])
def test_work_of_inputs_and_damping(ratio: float) -> None:
    """The energy balance closes in the separated coordinates too."""
    model = pendulum(
        {"slider.fx": 2.0, "pendulum.fx": -1.0, "parabola.ay": 0.5},
        **{"slider.mass": ratio, "slider.damping": 0.3, "pendulum.damping": 0.2},
    )
    before = sum(model.energies())
    method = create(6)
    for _ in range(10):
        model.keep()
        assert method.advance(model, 0.3, 1, 1e-6, 1) == DONE
        model.advance_frame(0.3)
        moved = abs(model.work) + abs(sum(model.energies())) + abs(before)
        assert abs(sum(model.energies()) - before - model.work) < 1e-9 * moved

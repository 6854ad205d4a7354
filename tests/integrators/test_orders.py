"""Order of convergence, error and work of every fixed-step method, in one test."""

from __future__ import annotations

import math

import pytest
from small_models import Oscillator, Pendulum, Sliding, march

from curvebound.fmi.common import SOLVER_METHOD
from curvebound.kernel.method import DONE, TOO_MANY_STEPS
from curvebound.kernel.methods import METHODS, create
from curvebound.study.settings import STEP_ORDERS
from curvebound.study.stability.stability_map import MAPPED

# method, order, steps over 10 s, evaluations per step (at most), error allowed at the finest
CASES = {
    "explicit_euler": (1, (20_000, 40_000, 80_000), 1.0, 0.6),
    "semi_implicit_euler": (1, (5_000, 10_000, 20_000), 1.0, 2e-2),
    "rk4": (4, (2_000, 4_000, 8_000), 4.0, 1e-9),
    "implicit": (4, (500, 1_000, 2_000), 5.0, 5e-8),
}
MODELS = {"oscillator": Oscillator, "pendulum": Pendulum, "sliding": Sliding}


def slope(steps: tuple[int, ...], errors: list[float]) -> float:
    """Least-squares slope of log error over log step size."""
    x = [-math.log(n) for n in steps]
    y = [math.log(e) for e in errors]
    mx, my = sum(x) / len(x), sum(y) / len(y)
    dot = sum((a - mx) * (b - my) for a, b in zip(x, y, strict=True))
    return dot / sum((a - mx) ** 2 for a in x)


@pytest.mark.parametrize("system", MODELS)
@pytest.mark.parametrize("name", CASES)
def test_order_error_and_work(name: str, system: str) -> None:
    order, steps, per_step, allowed = CASES[name]
    errors = []
    for n in steps:
        method = create(METHODS.index(name) + 1)
        model = MODELS[system]()
        march(method, model, count=n)
        errors.append(model.error(10.0))
        assert method.steps == n
        assert method.evaluations <= per_step * n + 1
    assert order == method.ORDER
    assert errors[-1] < allowed
    assert slope(steps, errors) == pytest.approx(order, abs=0.15)


def test_table_follows_the_enumeration() -> None:
    assert [name for name, _ in SOLVER_METHOD.items] == list(METHODS)
    assert set(CASES) == set(STEP_ORDERS), "each method of given step has its row"
    assert set(MAPPED) == set(METHODS) - {"exact"}, "each method is mapped"
    kinds = [type(create(item)).__name__.lower() for item in range(1, len(METHODS) + 1)]
    assert kinds == [name.replace("_", "") for name in METHODS]
    for item in (0, len(METHODS) + 1, -1):
        with pytest.raises(IndexError, match=str(item)):
            create(item)


@pytest.mark.parametrize("name", CASES)
def test_no_more_steps_than_allowed(name: str) -> None:
    method = create(METHODS.index(name) + 1)
    model = Oscillator()
    assert method.advance(model, 1.0, 101, 1e-6, 100) == TOO_MANY_STEPS
    assert method.reached == pytest.approx(1 / 101)
    assert (method.steps, method.evaluations, model.q0) == (0, 0, 1.0)
    assert method.advance(model, 1.0, 100, 1e-6, 100) == DONE
    assert method.steps == 100


@pytest.mark.parametrize("name", CASES)
def test_cutting_a_run_changes_nothing_but_rounding(name: str) -> None:
    whole, cut = Sliding(), Sliding()
    march(create(METHODS.index(name) + 1), whole, 1.0, count=200)
    march(create(METHODS.index(name) + 1), cut, 1.0, pieces=20, count=10)
    assert cut.q0 == pytest.approx(whole.q0, abs=1e-12)
    assert cut.v1 == pytest.approx(whole.v1, abs=1e-12)


class Counting(Oscillator):
    """Counts calls and what they ask for."""

    def __init__(self, *, works: bool, settles: bool) -> None:
        super().__init__(damping=0.1, push=1.0)
        self.works = works
        self.settles = settles
        self.calls = {"acceleration": 0, "power": 0, "settle": 0}
        self.settled = 0.0

    def acceleration(self, t: float, q0: float, q1: float, v0: float, v1: float) -> None:
        self.calls["acceleration"] += 1
        super().acceleration(t, q0, q1, v0, v1)

    def power(
        self, t: float, q0: float, q1: float, v0: float, v1: float, a0: float, a1: float
    ) -> float:
        self.calls["power"] += 1
        return super().power(t, q0, q1, v0, v1, a0, a1)

    def settle(self, h: float) -> None:
        self.calls["settle"] += 1
        self.settled += h


@pytest.mark.parametrize("name", METHODS)
def test_what_is_off_is_never_asked_for(name: str) -> None:
    method = create(METHODS.index(name) + 1)
    model = Counting(works=False, settles=False)
    march(method, model, 1.0, count=20)
    assert model.calls["power"] == model.calls["settle"] == 0
    assert model.work == 0.0
    if name != "exact":
        assert model.calls["acceleration"] == method.evaluations


@pytest.mark.parametrize("name", METHODS)
def test_settle_follows_every_step_with_its_size(name: str) -> None:
    method = create(METHODS.index(name) + 1)
    model = Counting(works=True, settles=True)
    march(method, model, 1.0, pieces=2, count=10)
    assert model.calls["settle"] == method.steps
    assert model.settled == pytest.approx(1.0)

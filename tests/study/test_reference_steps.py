"""The parts of references: their steps, their times of checking, and how points go to workers."""

from __future__ import annotations

import math
from collections import deque
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

from curvebound.errors import CurveboundError
from curvebound.study.reference import collocation, radau
from curvebound.study.reference.reference import _thinned
from curvebound.study.sweep import local

Number = np.longdouble


def turning(times: Any, states: Any) -> Any:
    """A rotation, and the integral of t: (cos t, -sin t, t^2 / 2)."""
    grown = times + 0 * states[2]
    return np.stack([states[1], -states[0], grown])


def test_collocation_follows_a_rotation() -> None:
    start = np.array([[1.0], [0.0], [0.5]], dtype=Number)
    found = collocation.Trajectory(1.0, start)
    size = collocation.collocate(turning, 1.0, 3.0, found, nodes=12, size=0.3)
    size = collocation.collocate(turning, 3.0, 3.5, found, nodes=12, size=size)
    times = [1.0, 1.25, 2.0, 2.999, 3.0, 3.2, 3.5]
    states = found.states(times)[:, :, 0]
    for k, t in enumerate(times):
        exact = [math.cos(t - 1.0), -math.sin(t - 1.0), t * t / 2]
        assert states[:, k].astype(float).tolist() == pytest.approx(exact, abs=1e-15)
    assert (found.begin, found.end, len(found._times)) == (1.0, 3.5, 10)
    assert size == pytest.approx(0.25, rel=0.5)
    back = collocation.Trajectory.of_arrays(found.arrays())
    assert np.array_equal(back.states(times), found.states(times))
    assert back.end == 3.5


@pytest.mark.filterwarnings("ignore::RuntimeWarning")
def test_collocation_stops_at_a_singularity() -> None:
    found = collocation.Trajectory(0.0, np.array([[1.0]], dtype=Number))
    with pytest.raises(CurveboundError, match=r"beyond t = 1 s"):
        collocation.collocate(lambda t, y: y**2, 0.0, 2.0, found, nodes=8, size=0.1, dense=1e-6)


@pytest.mark.parametrize(
    ("events", "spacing", "expected"),
    [
        ([1.0, 2.0, 3.0], 1.0, [1.0, 2.0, 3.0]),
        ([0.5, 1.0, 1.5, 2.0, 2.5], 1.0, [1.0, 2.0, 2.5]),
        ([0.1, 0.2], 1.0, [0.2]),
        ([0.3, 0.6, 0.9, 1.2], 0.6, [0.6, 1.2]),
        ([0.3, 0.6, 0.9, 1.2], 0.7, [0.9, 1.2]),
    ],
)
def test_checks_are_about_as_far_apart_as_wished(
    events: list[float], spacing: float, expected: list[float]
) -> None:
    assert _thinned(events, 0.0, spacing) == expected


def test_stiff_reference_of_damped_oscillations() -> None:
    """q0 on its own, q1 critically damped: closed forms."""

    def accelerations(t: Any, q: Any, v: Any) -> Any:
        return np.stack([-4.0 * q[0], -q[1] - 2.0 * v[1]])

    def slopes(t: Any, q: Any, v: Any) -> Any:
        found = np.zeros((2, 2, 2, np.size(t)))
        found[0, 0, 0], found[0, 1, 1], found[1, 1, 1] = -4.0, -1.0, -2.0
        return found

    done = radau.solve(
        accelerations, slopes, (1.0, 1.0, 0.0, 0.0), until=lambda _: math.inf, longest=2.0,
        length=1.0,
    )  # fmt: skip
    assert done.end == 2.0
    times = [0.0, 0.3, 1.1, 2.0]
    states = done.trajectory.states(times)[:, :, 0].astype(float)
    for k, t in enumerate(times):
        damped = math.exp(-t)
        exact = [math.cos(2 * t), (1 + t) * damped, -2 * math.sin(2 * t), -t * damped]
        assert states[:, k].tolist() == pytest.approx(exact, abs=1e-13)


class Pipe:
    def __init__(self, *answers: Any) -> None:
        self.answers = list(answers)
        self.sent: list[Any] = []

    def recv(self) -> Any:
        return self.answers.pop(0)

    def send(self, what: Any) -> None:
        self.sent.append(list(what))


def test_workers_get_more_points_the_quicker_they_are(monkeypatch: pytest.MonkeyPatch) -> None:
    now = [0.0]
    clock = SimpleNamespace(perf_counter=lambda: now[0])
    monkeypatch.setattr(local, "clock", clock)
    pool = object.__new__(local._Pool)
    worker = local._Worker(None, Pipe(["a"], ["b"], ["c", "d"], ["e"] * 4))  # type: ignore[arg-type]
    pool.workers, pool.size = [worker], 1
    pool.waiting, pool.alone = deque(range(100)), deque([200, 201])  # type: ignore[arg-type]
    sizes = []
    for _ in range(4):
        pool._feed(worker)
        sizes.append(len(worker.busy))
        assert worker.pipe.sent[-1] == worker.busy  # type: ignore[attr-defined]
        now[0] += 1e-3
        pool._hear(worker)
        assert worker.busy == []
    assert sizes == [1, 1, 2, 4]
    pool.waiting.clear()
    pool._feed(worker)
    assert worker.busy == [200]
    pool.waiting, pool.size, pool.workers = deque(range(7)), 1000, [worker, worker]
    pool._feed(worker)
    assert worker.busy == [0]
    now[0] += 10.0 * local._CHUNK
    worker.pipe = Pipe(["x"])  # type: ignore[assignment]
    pool._hear(worker)
    assert pool.size == 1
    worker.pipe = Pipe("it cannot be")  # type: ignore[assignment]
    with pytest.raises(CurveboundError, match="it cannot be"):
        pool._hear(worker)


def polynomial(factor: float) -> Any:
    """y' = factor t^2: of one step from 0 the last Legendre coefficients are 1/2 and 1/6 of it."""
    return lambda times, states: factor * times**2 + 0 * states


@pytest.mark.parametrize(
    ("error", "first", "ratio"),
    [
        (1e-6, 1.0, 1.5),  # never more than that at once
        (0.3, 1.0, 0.9 * (1 / 0.3) ** (1 / 3)),
        (3.0, 1.0, 0.9 * (1 / 3.0) ** (1 / 3)),
        (9.0, 1.0, 0.5),  # nor less, where the step is good enough
        (11.0, 0.7, 0.9 * (1 / (11.0 * 0.7**3)) ** (1 / 3)),
        (100.0, 0.9 * 0.1 ** (1 / 3), None),
        (2000.0, 0.2 * 0.7, None),
    ],
)
def test_collocation_chooses_steps_by_the_order(
    error: float, first: float, ratio: float | None
) -> None:
    """error: of a step of the wished size, 1/16 s, in units of what is allowed."""
    h, dense = 0.0625, 1e-9
    end = 4 * h if ratio else 1.5 * h
    found = collocation.Trajectory(0.0, np.array([[1e3]], dtype=Number))
    factor = error * dense * (1e3 + 1e-3) / (0.5 * h**2) / h
    collocation.collocate(polynomial(factor), 0.0, end, found, nodes=3, size=h, dense=dense)
    sizes = [float(size) / h for size in found._sizes]
    assert sizes[0] == pytest.approx(first, rel=1e-9)
    if ratio is not None:
        assert sizes[1] / sizes[0] == pytest.approx(ratio, rel=1e-9)
    assert found.final[0, 0] == pytest.approx(1e3 + factor * end**3 / 3, rel=1e-15)


@pytest.mark.parametrize(("size", "sizes"), [(0.71, [1.0]), (0.69, [0.69, 0.31])])
def test_collocation_leaves_no_short_rest(size: float, sizes: list[float]) -> None:
    found = collocation.Trajectory(0.0, np.array([[1.0]], dtype=Number))
    collocation.collocate(polynomial(1e-3), 0.0, 1.0, found, nodes=6, size=size)
    assert [float(x) for x in found._sizes] == pytest.approx(sizes, rel=1e-12)


def test_collocation_takes_a_quarter_of_a_step_that_does_not_converge(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    tried = []
    step = collocation._step

    def failing(rates: Any, time: Any, h: Any, *rest: Any) -> Any:
        tried.append(float(h))
        return None if len(tried) < 3 else step(rates, time, h, *rest)

    monkeypatch.setattr(collocation, "_step", failing)
    found = collocation.Trajectory(0.0, np.array([[1.0]], dtype=Number))
    collocation.collocate(polynomial(1e-3), 0.0, 1.0, found, nodes=6, size=0.5)
    assert tried[:3] == [0.5, 0.125, 0.03125]


@pytest.mark.parametrize(
    ("rate", "h", "scale"),
    [(2.0, 0.5, 3.001), (8.0, 0.5, 4.001), (-8.0, 0.5, 4.001), (8.0, 0.25, 3.001)],
)
def test_errors_are_judged_by_state_or_change(rate: float, h: float, scale: float) -> None:
    state = np.array([[-3.0]], dtype=Number)
    rates = np.array([[[0.0], [rate], [1.0]]], dtype=Number)
    assert float(collocation._scale(state, rates, Number(h))[0, 0]) == pytest.approx(scale)


def test_accelerations_count_by_what_the_step_makes_of_them() -> None:
    k = np.array([[0.25, -0.5], [0.0, 0.0]])
    for state, units in (
        ([0.0, 0.0, 0.0, 0.0], [0.5, 1.0]),  # what rests has no size of its own
        ([0.0, 0.0, 0.5, -0.125], [1.0, 0.25]),
        ([1e6, -1e5, 0.0, 0.0], [4.0, 0.4]),
    ):
        assert radau._units(k, np.array(state), 0.5) == pytest.approx(units, rel=1e-15)

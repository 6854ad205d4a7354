"""The propagator of linear models against closed forms and mpmath."""

from __future__ import annotations

import random

import mpmath
import pytest
from small_models import Oscillator, march

from curvebound.kernel import exact
from curvebound.kernel.method import NOT_FINITE
from curvebound.kernel.methods import create

Matrix = list[list[float]]


def propagator(a: Matrix, c: Matrix, h: float) -> tuple[Matrix, Matrix]:
    """E and S, by lists of rows; as many as `a` has, which the time may be missing in."""
    n = len(a)
    e, s, flat_a, flat_c = ([0.0] * 36 for _ in range(4))
    exact.copied(a, flat_a)
    exact.copied(c, flat_c)
    exact.propagator(n, flat_a, flat_c, h, e, s)
    return [e[i : i + n] for i in range(0, 6 * n, 6)], [s[i : i + n] for i in range(0, 6 * n, 6)]


def pendulum_on_parabola(
    m1: float = 1.0,
    m2: float = 1.0,
    a: float = 0.5,
    g: float = 9.81,
    c1: float = 0.0,
    c2: float = 0.0,
    sway: float = 0.0,
) -> Matrix:
    """The linear fidelity's A for unit length: small oscillations, damping, a swaying vertex."""
    k = (m1 + m2) / m1
    return [
        [0.0, 0.0, 1.0, 0.0, 0.0],
        [0.0, 0.0, 0.0, 1.0, 0.0],
        [-2 * k * a * g, m2 / m1 * g, -c1 / m1, c2 / m1, -sway],
        [2 * k * a * g, -k * g, c1 / m1, -k * c2 / m2, 0.0],
        [0.0] * 5,
    ]


def form() -> Matrix:
    rng = random.Random(3)
    c = [[0.0] * 5 for _ in range(5)]
    for i in range(5):
        for j in range(i + 1):
            c[i][j] = c[j][i] = rng.uniform(-1, 1)
    return c


def exponential(a: mpmath.matrix) -> mpmath.matrix:
    """exp(a) by series and squaring in many digits."""
    n = a.rows
    k = max(0, int(mpmath.log(max(abs(x) for x in a) + 1, 2))) + 6
    x = a / mpmath.mpf(2) ** k
    term = total = mpmath.eye(n)
    for i in range(1, 12):
        term = term * x / i
        total = total + term
    for _ in range(k):
        total = total * total
    return total


CASES = {
    "default": {},
    "swayed": {"sway": 3.0},
    "damped": {"c1": 0.5, "c2": 0.3},
    "stiff slider": {"c1": 1e6, "c2": 0.3, "sway": 1.0},
    "stiff joint": {"c1": 0.1, "c2": 1e6},
    "flat": {"a": 0.0},
    "arched": {"a": -0.5, "sway": 1.0},
    "upward gravity": {"g": -9.81},
    "no gravity": {"g": 0.0, "sway": 2.0},
    "heavy slider": {"m1": 1e8},
    "heavy bob": {"m1": 1e-4, "c1": 0.2},
    "steep": {"a": 500.0},
}


@pytest.mark.parametrize("h", [1e-3, 1.0, pytest.param(10.0, marks=pytest.mark.slow)])
@pytest.mark.parametrize("case", CASES)
def test_exponential_and_work_against_mpmath(case: str, h: float) -> None:
    a, c = pendulum_on_parabola(**CASES[case]), form()
    e, s = propagator(a, c, h)
    digits = mpmath.mp.dps
    try:
        mpmath.mp.dps = 100
        x = mpmath.matrix(a) * h
        truth = exponential(x) - mpmath.eye(5)
        largest = max(abs(y) for y in truth)
        error = max(abs(truth[i, j] - e[i][j]) for i in range(5) for j in range(5))
        # Rounding of A enters through the phase of the fastest mode, and as a fraction of its
        # stiffness through that of the slowest.
        stiffness = max(abs(y) for row in a[2:4] for y in row[:2])
        rounding = 3e-15 * (1 + h * stiffness**0.5) + 1e-16 * h * stiffness
        assert error / largest < rounding
        if max(abs(y) for y in x) < 300:
            # Van Loan 1978: the upper right block of exp of [[-A', C], [0, A]]
            double = mpmath.zeros(10)
            for i in range(5):
                for j in range(5):
                    double[i, j] = -x[j, i]
                    double[i, 5 + j] = mpmath.mpf(c[i][j]) * h
                    double[5 + i, 5 + j] = x[i, j]
            work = (mpmath.eye(5) + truth).T * exponential(double)[0:5, 5:10]
            largest = max(abs(y) for y in work)
            error = max(abs(work[i, j] - s[i][j]) for i in range(5) for j in range(5))
            assert error / largest < 4 * rounding
    finally:
        mpmath.mp.dps = digits


def test_slow_modes_keep_their_digits_beside_fast_ones() -> None:
    a = pendulum_on_parabola(c1=1e6, c2=1e6)
    e, _ = propagator(a, form(), 1.0)
    with mpmath.workdps(60):
        truth = exponential(mpmath.matrix(a)) - mpmath.eye(5)
    # the slider's creep within a second, 2e-5 of its displacement
    assert e[0][0] == pytest.approx(float(truth[0, 0]), rel=1e-14)
    assert -2.1e-5 < e[0][0] < -1.9e-5


@pytest.mark.parametrize("pieces", [1, 10, 1000])
@pytest.mark.parametrize("damping", [0.0, 0.7])
def test_closed_form_at_any_step(pieces: int, damping: float) -> None:
    model = Oscillator(w0=2.39719939786409, w1=5.78735129803610, damping=damping, push=1.5)
    method = create(6)
    march(method, model, pieces=pieces)
    assert model.error(10.0) < 1e-12
    assert method.steps == method.evaluations == pieces


def test_changes_between_steps_are_noticed() -> None:
    """Stiffness, input, work and step size in turn: the same as with a new method each time."""
    kept, fresh = Oscillator(damping=0.2, push=1.0), Oscillator(damping=0.2, push=1.0)
    method = create(6)
    changes = ((4.0, 1.0, 0.0, 0.5), (6.0, 1.0, 0.0, 0.5), (6.0, 5.0, 0.0, 0.5))
    for k, f, outer, h in (*changes, (6.0, 5.0, 1.0, 0.5), (6.0, 5.0, 1.0, 0.7)):
        for model in (kept, fresh):
            model.k0, model.f, model.outer = k, f, outer
        march(method, kept, h)
        march(create(6), fresh, h)
        assert (kept.q0, kept.v1, kept.work) == (fresh.q0, fresh.v1, fresh.work)


def test_growth_beyond_the_finite_numbers_is_reported() -> None:
    model = Oscillator()
    model.k0 = -1e6
    assert create(6).advance(model, 0.1, 1, 1e-6, 10) == 0
    try:
        outcome = create(6).advance(model, 10.0, 1, 1e-6, 10)
    except OverflowError:
        outcome = NOT_FINITE
    assert outcome == NOT_FINITE


def test_matrices_differ_where_any_element_does() -> None:
    size = exact.N * exact.N
    same = [float(i) for i in range(size)]
    assert not exact.differs(same, list(same))
    for i in range(size):
        other = list(same)
        other[i] += 1.0
        assert exact.differs(same, other)

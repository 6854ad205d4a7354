"""Gauss-Legendre: constants, symmetry, symplecticity, stiffness and honest non-convergence."""

from __future__ import annotations

import math

import pytest
from small_models import Oscillator, Pendulum, Sliding, march, set_jacobian

from curvebound.kernel import implicit
from curvebound.kernel.method import DONE, NOT_CONVERGED, TOO_MANY_STEPS
from curvebound.kernel.methods import create


def test_constants() -> None:
    root = math.sqrt(3.0)
    a = (implicit.A[:2], implicit.A[2:])
    c = implicit.C
    assert c == pytest.approx((0.5 - root / 6, 0.5 + root / 6), abs=1e-16)
    assert pytest.approx(1 / (c[1] - c[0]), abs=4e-16) == implicit.SPREAD
    for i in range(2):
        # row sums, and C(2): sum_j a_ij c_j = c_i^2 / 2
        assert sum(a[i]) == pytest.approx(c[i], abs=1e-16)
        assert a[i][0] * c[0] + a[i][1] * c[1] == pytest.approx(c[i] ** 2 / 2, abs=1e-16)
        for j in range(2):
            # symplectic: b_i a_ij + b_j a_ji = b_i b_j (Sanz-Serna 1988)
            assert 0.5 * a[i][j] + 0.5 * a[j][i] == pytest.approx(0.25, abs=1e-16)
    for k in range(1, 5):
        assert 0.5 * (c[0] ** (k - 1) + c[1] ** (k - 1)) == pytest.approx(1 / k, abs=1e-16)
    square = [[sum(a[i][k] * a[k][j] for k in range(2)) for j in range(2)] for i in range(2)]
    names = (implicit.B[:2], implicit.B[2:])
    for i in range(2):
        assert names[i] == pytest.approx(square[i], abs=1e-16)
    weights = [0.5 * (a[0][j] + a[1][j]) for j in range(2)]
    assert pytest.approx(weights, abs=1e-16) == (implicit.W1, implicit.W2)


@pytest.mark.parametrize("system", [Pendulum, Sliding, Oscillator])
def test_time_reversal(system: type[Oscillator]) -> None:
    """Symmetric: back with reversed velocities, one arrives where one started."""
    model = system()
    start = (model.q0, model.q1, model.v0, model.v1)
    march(create(5), model, 4.0, count=80)
    model.v0, model.v1 = -model.v0, -model.v1
    march(create(5), model, 4.0, count=80)
    assert (model.q0, model.q1, -model.v0, -model.v1) == pytest.approx(start, abs=1e-12)


def test_explicit_methods_are_not_reversible() -> None:
    """The test above can fail: what it finds for rk4 is its truncation error."""
    model = Pendulum()
    march(create(3), model, 4.0, count=80)
    model.v0 = -model.v0
    march(create(3), model, 4.0, count=80)
    assert abs(model.q0 - math.pi / 2) > 1e-9


def test_quadratic_energy_is_kept_at_any_step() -> None:
    model = Oscillator()
    for _ in range(200):
        march(create(5), model, 3.0)
    assert model.energy() == pytest.approx(model.start_energy, rel=1e-12)


def test_energy_does_not_drift() -> None:
    """Symplectic: over 150 swings the energy error stays within that of the first ones."""
    drift = {}
    for item in (3, 5):
        model = Pendulum()
        method = create(item)
        worst = []
        for _ in range(10):
            peak = 0.0
            for _ in range(15):
                march(method, model, 2.0, count=30)
                peak = max(peak, abs(model.energy()))
            worst.append(peak)
        drift[item] = worst[-1] / worst[0]
    assert drift[5] < 1.05
    assert drift[3] > 5.0


def test_stiff_damping_and_stiff_springs() -> None:
    """A-stable: steps a million times longer than the fastest time constant, at unchanged work."""
    slow = Oscillator(w0=2.0, w1=2.0, damping=1e6)
    method = create(5)
    march(method, slow, 10.0, count=100)
    assert method.evaluations <= 4 * 100 + 1
    # q decays as exp(-w^2 t / d); the initial velocity is spent within a microsecond
    assert slow.q0 == pytest.approx((1 + 0.5e-6) * math.exp(-4e-5), abs=1e-6)
    stiff = Oscillator(w0=1e6, w1=1.0)
    march(create(5), stiff, 10.0, count=100)
    assert stiff.energy() == pytest.approx(stiff.start_energy, rel=1e-9)
    assert stiff.q1 == pytest.approx(stiff.exact(10.0)[1], abs=1e-6)


def test_work_of_the_newton_iteration() -> None:
    """A guess extrapolated from the step before leaves little to do for small steps."""
    for system, until, count, most in (
        (Pendulum, 10.0, 1_000, 4.0),
        (Sliding, 10.0, 1_000, 4.2),
        (Pendulum, 2.0, 2_000, 2.1),
        (Sliding, 2.0, 2_000, 2.7),
    ):
        method = create(5)
        march(method, system(), until, count=count)
        assert method.evaluations <= most * count


def test_a_singular_block_of_the_newton_matrix_is_not_the_pivot() -> None:
    """Growth at the rate at which 1 - h^2 B_11 dK/dq vanishes: solved in one step."""
    h = 0.1
    model = Oscillator(w1=0.1)
    model.k0 = -24.0 / (h * h)
    method = create(5)
    march(method, model, h)
    assert method.steps == 1
    # the method's growth is the Pade approximation (2, 2) of the exponential
    z = math.sqrt(24.0)
    up = (1 + z / 2 + z * z / 12) / (1 - z / 2 + z * z / 12)
    truth = 0.5 * (up + 1 / up) + 0.5 * 0.5 * h / z * (up - 1 / up)
    assert model.q0 == pytest.approx(truth, rel=1e-12)


def test_large_steps_are_halved_where_the_iteration_fails() -> None:
    """A pendulum at 10 s a step: from no guess does the iteration converge, on parts it does."""
    model = Pendulum()
    method = create(5)
    march(method, model, 20.0, count=2)
    assert 2 < method.steps < 500
    assert math.isfinite(model.q0)


class Torn(Pendulum):
    """The acceleration jumps where the motion is bound to stay, so that no stage can be solved."""

    def __init__(self) -> None:
        super().__init__()
        self.q0 = 0.5

    def acceleration(self, t: float, q0: float, q1: float, v0: float, v1: float) -> None:
        self.a0, self.a1 = (-1e9 if q0 >= 0.5 else 1e9), 0.0

    def jacobian(self, t: float, q0: float, q1: float, v0: float, v1: float) -> None:
        self.acceleration(t, q0, q1, v0, v1)
        set_jacobian(self, ((0.0,) * 8))


def test_what_does_not_converge_is_reported() -> None:
    method = create(5)
    model = Torn()
    before = method.get_state()
    method.keep()
    assert method.advance(model, 1.0, 1, 1e-6, 1_000_000) == NOT_CONVERGED
    assert 0 < method.reached <= 1e-5
    method.undo()
    assert method.get_state() == before
    assert method.evaluations < 10_000


def test_memory_survives_a_failure() -> None:
    class Tearing(Torn):
        """Torn once it has passed 0.75."""

        def acceleration(self, t: float, q0: float, q1: float, v0: float, v1: float) -> None:
            self.a0, self.a1 = (0.0 if q0 < 0.75 else -1e15), 0.0

    method, model = create(5), Tearing()
    model.v0 = 1.0
    march(method, model, 0.1, count=2)
    before = method.get_state()
    assert before[4] == pytest.approx(0.05)
    method.keep()
    assert method.advance(model, 1.0, 40, 1e-6, 1_000_000) == NOT_CONVERGED
    method.undo()
    assert method.get_state() == before


def test_halved_steps_count_towards_the_limit() -> None:
    method = create(5)
    assert method.advance(Torn(), 1.0, 1, 1e-6, 5) == TOO_MANY_STEPS
    assert method.reached == pytest.approx(1 / 32)


def test_a_domain_error_of_an_iterate_is_a_failed_iteration() -> None:
    class Walled(Pendulum):
        def acceleration(self, t: float, q0: float, q1: float, v0: float, v1: float) -> None:
            self.a0, self.a1 = -math.sqrt(10.0 + q0), 0.0

        def jacobian(self, t: float, q0: float, q1: float, v0: float, v1: float) -> None:
            self.acceleration(t, q0, q1, v0, v1)
            set_jacobian(self, (-0.5 / math.sqrt(10.0 + q0), *(0.0,) * 7))

    model = Walled()
    assert create(5).advance(model, 1.0, 1, 1e-6, 1_000_000) == DONE
    fallen = Walled()
    fallen.q0, fallen.v0 = -9.0, -5.0
    outcome = create(5).advance(fallen, 1.0, 1, 1e-6, 1_000_000)
    assert outcome == NOT_CONVERGED


def test_state_restores_the_guess_bit_for_bit() -> None:
    method, model = create(5), Sliding()
    march(method, model, 1.0, count=20)
    saved = method.get_state(), (model.q0, model.q1, model.v0, model.v1)
    march(method, model, 1.0, count=20)
    other, again = create(5), Sliding()
    other.set_state(saved[0])
    again.q0, again.q1, again.v0, again.v1 = saved[1]
    march(other, again, 1.0, count=20)
    assert (again.q0, again.q1, again.v0, again.v1) == (model.q0, model.q1, model.v0, model.v1)
    assert other.get_state() == method.get_state()
    method.reset()
    assert method.get_state() == create(5).get_state()
    assert method.steps == method.evaluations == 0

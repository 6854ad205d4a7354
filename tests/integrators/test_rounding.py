"""What rounding makes of the accelerations: rests it can just resolve, and what is said of it."""

from __future__ import annotations

import math
import random
from typing import Any

import pytest
from benchmarks.ours import interpreted_kernel

# test modules are imported without packages (importmode=importlib); their helpers live here
from small_models import Oscillator

from curvebound.kernel.adaptive import Adaptive
from curvebound.kernel.base import Model
from curvebound.kernel.method import DONE
from curvebound.kernel.rounding import Rounding

KERNEL = interpreted_kernel()


def run(model: Any, until: float, step: float, tolerance: float) -> Adaptive:
    """Advance by communication steps of `step` s, with at most 2000 internal steps in each."""
    method = Adaptive()
    for _ in range(round(until / step)):
        assert method.advance(model, step, 1, tolerance, 2000) == DONE
        model.advance_frame(step)
    return method


@pytest.mark.parametrize(
    ("mass", "tolerance"),
    [
        (1e2, 1e-10),
        pytest.param(1e3, 1e-8, marks=pytest.mark.slow),
        pytest.param(1e3, 1e-6, marks=pytest.mark.slow),
        pytest.param(1e5, 1e-6, marks=pytest.mark.slow),
    ],
)
@pytest.mark.parametrize(
    ("a", "off"), [(0.0, 0.0), (0.0, 1e-13), (-0.5, 1e-13), (0.5, 1e-13), (-0.5, 1e-6), (0.5, 1e-6)]
)
def test_near_the_inverted_rest(a: float, off: float, mass: float, tolerance: float) -> None:
    """These took up to half a million steps, or failed; what rounding decides is said."""
    model = KERNEL.system(
        "ParabolaPendulum",
        {
            "parabola.coefficient_start": a,
            "slider.u_start": 0.0,
            "pendulum.angle_start": math.pi - off,
            "pendulum.mass": mass,
        },
    )
    method = run(model, 5.0, 0.1, tolerance)
    assert method.steps < 1500
    if off < 1e-6 and a <= 0.0:
        assert method.doubt() > tolerance


@pytest.mark.parametrize("damping", [0.5, 1.0, 5.0])
@pytest.mark.parametrize(
    ("fmu", "name"), [("BeadOnWire", "bead"), ("ParabolaPendulum", "pendulum")]
)
def test_a_motion_lost_in_the_last_digit_of_the_angle_is_told(
    fmu: str, name: str, damping: float
) -> None:
    """The float pi is 1.2e-16 off the top: the rate settles where a step no longer moves the angle.

    The exact motion falls down within these 20 s (pendulum: leaves, at least).
    """
    values: dict[str, float] = {f"{name}.angle_start": math.pi, f"{name}.damping": damping}
    if name == "bead":
        values["model.formulation"] = 2
    model = KERNEL.system(fmu, values | ({} if name == "bead" else {"slider.u_start": 0.0}))
    method = run(model, 20.0, 1.0, 1e-6)
    assert max(method.doubt(), method.loss()) > 1e-6


@pytest.mark.parametrize("damping", [1.0, 5.0])
def test_what_rests_where_rest_is_stable_is_not_doubted(damping: float) -> None:
    """Settled at the bottom until its rate no longer moves the angle."""
    values: dict[str, float] = {"bead.angle_start": 0.1, "bead.damping": damping}
    model = KERNEL.system("BeadOnWire", values | {"model.formulation": 2, "gravity.x": 1.0})
    method = run(model, 200.0, 10.0, 1e-9)
    assert math.tan(model.q0) == pytest.approx(1.0 / 9.81, rel=1e-9)
    assert max(method.doubt(), method.loss()) < 1e-9


@pytest.mark.parametrize(
    "damping",
    [
        pytest.param((10.0, 0.1), marks=pytest.mark.slow),
        pytest.param((0.1, 10.0), marks=pytest.mark.slow),
        (10.0, 10.0),
    ],
)
def test_settled_upside_down(damping: tuple[float, float]) -> None:
    """In gravity that points up: 11.5 million steps for the 1000 s."""
    model = KERNEL.system(
        "ParabolaPendulum",
        {
            "gravity.y": 9.81,
            "parabola.coefficient_start": 0.0,
            "pendulum.mass": 100.0,
            "slider.damping": damping[0],
            "pendulum.damping": damping[1],
        },
    )
    assert run(model, 1000.0, 100.0, 1e-10).steps < 1500
    assert model.q1 == pytest.approx(math.pi, abs=1e-6)


def test_settled_aside() -> None:
    """Damping has brought it to rest at an angle other than 0."""
    model = KERNEL.system(
        "ParabolaPendulum",
        {
            "gravity.x": -1.0,
            "parabola.coefficient_start": 0.1,
            "pendulum.length": 0.3,
            "slider.damping": 5.0,
            "pendulum.damping": 1.0,
            "pendulum.angle_start": 2.0,
        },
    )
    method = run(model, 1000.0, 10.0, 1e-12)
    assert method.steps < 3000
    assert model.q1 == pytest.approx(-math.atan(1.0 / 9.81), abs=1e-12)


@pytest.mark.parametrize("radius", [3847.0, 1000.0, 1.0])
@pytest.mark.parametrize("formulation", [1, 2])
def test_a_rate_that_damping_enslaves(radius: float, formulation: int) -> None:
    """From rest against strong damping: force over damping, to the tolerance; 22 % were off."""
    model = KERNEL.system(
        "BeadOnWire",
        {
            "wire.radius": radius,
            "bead.damping": 1e5,
            "bead.angle_start": -1.161,
            "model.formulation": formulation,
        },
    )
    run(model, 20 * 0.26e-3, 0.26e-3, 1e-4)
    _, rate, _ = model.rotation()
    assert rate == pytest.approx(9.81 * math.sin(1.161) / (1e5 * radius), rel=1e-4)


@pytest.mark.parametrize("rate", [1e5, 1e6, 1e7])
def test_a_rod_that_damping_enslaves(rate: float) -> None:
    """Hung from a heavy slider: weight over damping."""
    model = KERNEL.system(
        "ParabolaPendulum",
        {
            "parabola.coefficient_start": 0.0,
            "slider.mass": 1e12,
            "pendulum.damping": rate,
            "pendulum.angle_start": 2.0,
        },
    )
    run(model, 2.0, 0.1, 1e-6)
    assert model.v1 == pytest.approx(-9.81 * math.sin(model.q1) / rate, rel=1e-6)


def arithmetic_geometric_mean(x: float, y: float) -> float:
    """By Gauss's iteration."""
    while abs(x - y) > 1e-15 * x:
        x, y = 0.5 * (x + y), math.sqrt(x * y)
    return x


@pytest.mark.parametrize("tolerance", [1e-4, 1e-6, 1e-8])
@pytest.mark.parametrize("formulation", [1, 2])
@pytest.mark.parametrize("off", [1e-2, 1e-4])
def test_what_comes_near_an_unstable_rest_again(
    off: float, formulation: int, tolerance: float
) -> None:
    """Off the top by an angle known to all digits, over to the other side, and back to the bottom.

    Errors made on the way grow by the square of what the start's do: up to 0.7, in silence.
    """
    model = KERNEL.system(
        "BeadOnWire",
        {"gravity.y": 9.81, "bead.angle_start": off, "model.formulation": formulation},
    )
    quarter = 0.5 * math.pi / arithmetic_geometric_mean(1.0, math.sin(0.5 * off)) / math.sqrt(9.81)
    method = run(model, 3.0 * quarter, 3.0 * quarter / 20, tolerance)
    angle, rate, _ = model.rotation()
    turn = 2.0 * math.pi
    most = 2.0 * math.sqrt(9.81) * math.cos(0.5 * off)
    allowed = max(10.0 * tolerance, method.doubt())
    assert math.remainder(angle - math.pi, turn) == pytest.approx(0.0, abs=turn * allowed)
    assert rate == pytest.approx(-most, rel=allowed)
    assert method.doubt() < 1e-6


@pytest.mark.parametrize("tolerance", [3.9e-11, 1e-7])
def test_roundings_that_grow_on_the_way_are_said(tolerance: float) -> None:
    """Past an inverted rest that is passed once more: 3.8e-3 off, and 0.9, in silence."""
    model = KERNEL.system(
        "ParabolaPendulum",
        {
            "gravity.y": -29.21638188962496,
            "parabola.coefficient_start": 0.0,
            "slider.mass": 741.3932633223537,
            "pendulum.mass": 741.3932633223537,
            "pendulum.length": 21.42872706780331,
            "slider.u_start": -0.9948565252026759,
            "slider.u_rate_start": 3.682176362730475,
            "pendulum.angle_start": 3.141581578783577,
        },
    )
    method = run(model, 20 * 1.322487115119501, 1.322487115119501, tolerance)
    assert method.doubt() > tolerance
    assert model.q0 == pytest.approx(86.3019939015, rel=1e-5)
    assert model.q1 == pytest.approx(1.91222972993, rel=1e-5)


@pytest.mark.parametrize("hinted", [True, False])
def test_a_hint_left_out_is_not_wrong_in_silence(hinted: bool) -> None:
    """A slider 2e7 times lighter than its bob: 1.4e-5 off without what the model says of it."""
    model = KERNEL.system(
        "ParabolaPendulum",
        {
            "slider.mass": 32.999794564187425,
            "pendulum.mass": 600548559.2953955,
            "pendulum.length": 1.6060647501267953,
            "parabola.coefficient_start": 0.02304846427302404,
            "slider.u_start": 0.0,
            "slider.damping": 0.00019841847621192388,
            "pendulum.angle_start": 1.2218491563527305,
            "gravity.x": -13.690228478373848,
            "gravity.y": 44.93101496750965,
        },
    )
    inputs = [0.0] * len(model.INPUTS)
    inputs[model.INPUTS.index("pendulum.fy")] = 11852790.198928421
    method = Adaptive()
    step = 0.3109446999195388 / 20
    for _ in range(20):
        model.set_inputs(inputs, 0)
        if not hinted:
            model.magnification = 1.0
        assert method.advance(model, step, 1, 1e-8, 2000) == DONE
        model.advance_frame(step)
    off = abs(model.v0 - 58713.785065877513) / 58713.785065877513
    assert (method.loss() > 1e-8) is not hinted
    assert off < (1e-8 if hinted else 1e-4)


def test_a_violent_moment_is_not_the_size_of_what_follows() -> None:
    """Past the top with 1e15 m/s2: its rounding excused any step that followed."""
    model = KERNEL.system(
        "ParabolaPendulum",
        {
            "gravity.y": 9.81,
            "slider.mass": 21.77502307326711,
            "pendulum.mass": 64865788940.80708,
            "pendulum.length": 64.20445272828498,
            "slider.damping": 577.6807759401901,
            "slider.u_start": 6.753210538527953,
            "slider.u_rate_start": 0.5579642822287277,
            "pendulum.angle_start": 1.3572861295681922e-07,
            "parabola.coefficient_start": 0.0,
        },
    )
    pushes = (
        (-0.33240790520840097, -0.17885211817494878, -65099223.04136012, -961963479.1422068),
        (-0.16860586431073016, 0.21023978993012618, 1711646548.4498084, -94775760.18822582),
        (-0.3057571234591957, 0.6382491682918547, -808020469.5303559, 1154882565.6661851),
        (-0.33103504679253226, -0.2707325828056825, -1400308076.0306203, -1344574622.0358863),
        (-0.25559418640177645, -0.3091968535447626, 1786297472.4273891, 1916811595.038298),
    )
    method = Adaptive()
    for push in pushes:
        model.set_inputs([0.0, 0.0, 0.0, *push], 0)
        assert method.advance(model, 2.8626417190352864, 1, 5.592072033549895e-10, 2000) == DONE
        model.advance_frame(2.8626417190352864)
    assert model.q0 == pytest.approx(76.77722744236743, rel=1e-7)
    assert model.q1 == pytest.approx(4.4336096118977135, rel=1e-7)


class Bowl(Model):
    """A bead on the parabola y = a x^2, by the textbook and with nothing else."""

    def __init__(self, a: float, x: float, v: float) -> None:
        super().__init__()
        self.a = a
        self.q0, self.v0 = x, v

    def acceleration(self, t: float, q0: float, q1: float, v0: float, v1: float) -> None:
        a = self.a
        lean = 1.0 + 4.0 * a * a * q0 * q0
        self.a0 = -(2.0 * a * q0) * (9.81 + 2.0 * a * v0 * v0) / lean
        self.a1 = 0.0

    def jacobian(self, t: float, q0: float, q1: float, v0: float, v1: float) -> None:
        self.acceleration(t, q0, q1, v0, v1)
        a = self.a
        lean = 1.0 + 4.0 * a * a * q0 * q0
        g = 9.81 + 2.0 * a * v0 * v0
        self.a0_q0 = -2.0 * a * g * (1.0 - 4.0 * a * a * q0 * q0) / (lean * lean)
        self.a0_v0 = -8.0 * a * a * q0 * v0 / lean

    def energy(self) -> float:
        """Per mass."""
        slope = 2.0 * self.a * self.q0
        return 0.5 * (1.0 + slope * slope) * self.v0 * self.v0 + 9.81 * self.a * self.q0 * self.q0


@pytest.mark.parametrize("count", [12, pytest.param(300, marks=pytest.mark.slow)])
def test_a_textbook_model_without_any_hint(count: int) -> None:
    """Random ones: heights agree with a run at a thousandth of the tolerance, and energy."""
    for number in range(count):
        rng = random.Random(number)
        a = 10.0 ** rng.uniform(-3, 3)
        x = 10.0 ** rng.uniform(-3, 2)
        slope = 2.0 * a * x
        v = rng.choice((0.0, rng.uniform(-5.0, 5.0) / math.hypot(1.0, slope)))
        high = max(x, abs(v) * math.hypot(1.0, slope) / math.sqrt(19.62 * a))
        until = 2.0 * math.sqrt(2.0 * a * high * high / 9.81 + 1.0 / (19.62 * a))
        model, finer = Bowl(a, x, v), Bowl(a, x, v)
        method = run(model, until, until / 20, 1e-8)
        run(finer, until, until / 20, 1e-11)
        # an error of time counts by the slope
        steep = max(1.0, 2.0 * a * high)
        assert abs(model.q0 - finer.q0) <= 1e-7 * steep * high, number
        assert abs(model.energy() - Bowl(a, x, v).energy()) <= 1e-6 * model.energy(), number
        assert method.steps < 2000, number


def test_damping_explains_short_steps_that_rounding_shortens_further() -> None:
    """A large wire's bead all but at rest on top, in Cartesian form: 77 441 steps for the first."""
    model = KERNEL.system(
        "BeadOnWire",
        {
            "gravity.y": -0.48028177576279246,
            "wire.radius": 4169.302924842597,
            "bead.mass": 3300455.3138775495,
            "bead.damping": 943872687.6961222,
            "bead.angle_start": 3.1415926535896763,
            "solver.method": 4,
        },
    )
    assert run(model, 400.0, 100.0, 1.3e-08).steps < 300


@pytest.mark.parametrize("coordinate", [0, 1])
@pytest.mark.parametrize(
    ("stiffness", "noise", "scatter", "doubt"),
    [
        (4.0, 2e-3, 0.0, 0.0),
        (-4.0, 2e-3, 0.0, 2e-3),
        (4.0, 5e-4, 0.0, 5e-4 / 2.0),
        (4.0, 5e-4, 4e-4, 4e-4),
        (0.25, 5e-4, 0.0, 5e-4),
        (-4.0, 5e-4, 0.0, 5e-4),
    ],
)
def test_a_rest_that_trembles_is_one_where_nothing_grows(
    coordinate: int, stiffness: float, noise: float, scatter: float, doubt: float
) -> None:
    """Of rates up to 1, a step of 1 s: from 1e-3 on they are rounding, at a stable rest.

    Nor does it act for longer there than the coordinate takes for a radian, of 2 rad/s, however
    fast the other is, but for what scatters besides.
    """
    model = Oscillator(1e3, 1e3)
    setattr(model, f"k{coordinate}", stiffness)
    rounding = Rounding()
    for name, value in (("fast", 1.0), ("size", 1.0), ("noise", noise), ("scatter", scatter)):
        setattr(rounding, f"{name}{coordinate}", value)
    rounding.note_noise(model, 0.0, 1.0)
    assert rounding.doubt == doubt

"""A body that is free in the plane: what each statement does to it, by Newton's second law.

No curve couples its coordinates, so that all can be written down without the derivation.
"""

from __future__ import annotations

import random
from types import SimpleNamespace
from typing import Any

import pytest
from kernel_module import kernel_module

from curvebound.mechanics.derive import derive_text
from curvebound.mechanics.derived import Derived
from curvebound.mechanics.numeric import double

TEXT = """
from curvebound.mechanics import Mechanics, drag, input_, length, mass, parameter, shape
x, y = length("body.u"), length("body.w")
end, stiffness = shape("spring.end"), parameter("spring.stiffness")
body = mass("body", x, y)
MECHANICS = Mechanics(
    [x, y], [body], frame="cart", damping=[drag("air", body), drag("rail", y)],
    potential=stiffness * (x - end) ** 2 / 2, couples={y: input_("lift")},
    forces={body: (input_("push"), -FACTOR * x.rate)},
    observed={"pull": stiffness * (x - end), "held": body.reaction[0]},
)
"""
#: a force that is there without any input, and one that is not
FACTORS = {"always": 'parameter("swirl")', "by an input": 'input_("swirl")'}
T = 0.3


@pytest.fixture(params=FACTORS)
def body(request: pytest.FixtureRequest) -> Derived:
    return derive_text(TEXT.replace("FACTOR", FACTORS[request.param]), "free", "here")


def started(derived: Derived, **more: float) -> tuple[Any, Any, dict[str, float]]:
    """Its model, moving at random, all values at the start by short names, and by their own."""
    rng = random.Random(7)
    model = kernel_module(derived).model({})
    given = {n: rng.uniform(0.5, 2.0) for n in (*model.PARAMETERS, *model.INPUTS)} | more
    model.start(given, {})
    model.x, model.y, model.vx, model.vy = (rng.uniform(0.5, 2.0) for _ in range(4))
    model.set_inputs([given[n] for n in model.INPUTS], 0)
    s = SimpleNamespace(**{n.replace(".", "_"): x for n, x in given.items()})
    s.x, s.y, s.u, s.w = model.x, model.y, s.body_u_start, s.body_w_start
    s.vx, s.vy, s.u_rate, s.w_rate = (
        model.vx, model.vy, s.body_u_rate_start, s.body_w_rate_start
    )  # fmt: skip
    s.end, s.end_rate = s.spring_end_start, s.spring_end_rate_start
    return model, s, given


def moved(s: Any, t: float) -> Any:
    """The same with frame and spring t s later."""
    m = SimpleNamespace(**vars(s))
    m.x, m.vx = s.x + t * s.vx + t * t * s.cart_ax / 2, s.vx + t * s.cart_ax
    m.y, m.vy = s.y + t * s.vy + t * t * s.cart_ay / 2, s.vy + t * s.cart_ay
    push = s.spring_end_acceleration
    m.end, m.end_rate = s.end + t * s.end_rate + t * t * push / 2, s.end_rate + t * push
    return m


def held(s: Any) -> tuple[float, float]:
    """Forces on the body but gravity and external ones."""
    x = -s.spring_stiffness * (s.u - s.end) - s.air * s.u_rate
    return x, s.lift - (s.air + s.rail) * s.w_rate


def external(s: Any) -> tuple[float, float]:
    return s.body_fx + s.push, s.body_fy - s.swirl * s.u_rate


def acceleration(s: Any) -> list[float]:
    """Relative to the frame."""
    (hx, hy), (fx, fy) = held(s), external(s)
    return [
        (hx + fx) / s.body_mass + s.gravity_x - s.cart_ax,
        (hy + fy) / s.body_mass + s.gravity_y - s.cart_ay,
    ]


def energies(s: Any) -> tuple[float, float]:
    m = s.body_mass
    kinetic = m * ((s.u_rate + s.vx) ** 2 + (s.w_rate + s.vy) ** 2) / 2
    high = s.gravity_x * (s.u + s.x) + s.gravity_y * (s.w + s.y)
    return kinetic, s.spring_stiffness * (s.u - s.end) ** 2 / 2 - m * high


def power(s: Any) -> float:
    """Of all but gravity and spring: by Newton's law for the body, and by the moved end."""
    (hx, hy), (fx, fy) = held(s), external(s)
    pull = s.spring_stiffness * (s.u - s.end)
    found = (hx + fx) * (s.u_rate + s.vx) + (hy + fy) * (s.w_rate + s.vy)
    return found + pull * (s.u_rate - s.end_rate)


@pytest.mark.parametrize(
    "off",
    [(), ("air", "rail"), ("body.fx", "body.fy", "lift", "push", "swirl"),
     ("spring.end_rate_start", "spring.end_acceleration")],
    ids=str,
)  # fmt: skip
def test_accelerations_power_and_energies(body: Derived, off: tuple[str, ...]) -> None:
    model, s, _ = started(body, **dict.fromkeys(off, 0.0))
    now = moved(s, T)
    model.acceleration(T, s.u, s.w, s.u_rate, s.w_rate)
    assert [model.a0, model.a1] == pytest.approx(acceleration(now), rel=1e-13)
    model.jacobian(T, s.u, s.w, s.u_rate, s.w_rate)
    m = s.body_mass
    slopes = [model.a0_q0, model.a0_v0, model.a1_v0, model.a1_v1]
    true = [-s.spring_stiffness / m, -s.air / m, -s.swirl / m, -(s.air + s.rail) / m]
    assert slopes == pytest.approx(true, rel=1e-13)
    assert [model.a0_q1, model.a0_v1, model.a1_q0, model.a1_q1] == [0.0] * 4
    got = model.power(T, s.u, s.w, s.u_rate, s.w_rate, model.a0, model.a1)
    assert got == pytest.approx(power(now), rel=1e-12)
    model.energies_at(T)
    assert (model.kinetic, model.potential) == pytest.approx(energies(now), rel=1e-13)


def test_outputs(body: Derived) -> None:
    model, s, given = started(body)
    values = [0.0] * len(model.OUTPUTS)
    for group in set(model.OUTPUTS.values()):
        model.observe(group, values, 0)
    found = dict(zip(model.OUTPUTS, values, strict=True))
    hx, hy = held(s)
    kinetic, potential = energies(s)
    true = {
        "body.u": s.u, "body.u_rate": s.u_rate, "body.w": s.w, "body.w_rate": s.w_rate,
        "body.x": s.x + s.u, "body.y": s.y + s.w,
        "body.vx": s.vx + s.u_rate, "body.vy": s.vy + s.w_rate,
        "cart.x": s.x, "cart.y": s.y, "cart.vx": s.vx, "cart.vy": s.vy,
        "spring.end": s.end, "spring.end_rate": s.end_rate,
        "energy.kinetic": kinetic, "energy.potential": potential,
        "energy.total": kinetic + potential,
        "energy.residual": kinetic + potential - model.initial_energy,
        "cart.fx": -hx, "cart.fy": -hy, "pull": s.spring_stiffness * (s.u - s.end), "held": hx,
    }  # fmt: skip
    assert found == pytest.approx(true, rel=1e-13)
    # the same equations with other numbers
    symbols = body.at(double, given, 0.0)
    symbols |= {"frame.x": s.x, "frame.y": s.y, "frame.vx": s.vx, "frame.vy": s.vy}
    for name in ("places", "energies", "reactions"):
        for output, x in body.function(name)(double, symbols).items():
            assert x == pytest.approx(true[output], rel=1e-13), output
    assert body.function("accelerations")(double, symbols) == pytest.approx(acceleration(s))
    done = sum(body.function("fed")(double, symbols))
    forces = body.function("held")(double, symbols)
    done += sum(f * v for f, v in zip(forces, (s.vx, s.vy, s.end_rate), strict=True))
    assert done == pytest.approx(power(s), rel=1e-13)


def test_frame_and_shape_move_by_cubic_polynomials_and_return(body: Derived) -> None:
    """Accelerations that are linear in time."""
    model, s, given = started(body)
    before = model.get_state()
    model.keep()
    slopes = {"cart.ax": 0.5, "cart.ay": -0.7, "spring.end_acceleration": 0.9}
    for name, slope in slopes.items():
        model.inputs[model.INPUTS.index(name)] = given[name]
        model.slopes[model.INPUTS.index(name)] = slope
    model.take_inputs(T)
    model.advance_frame(T)
    now = moved(s, T)
    places = {"x": now.x, "y": now.y, "end": now.end}
    rates = {"vx": now.vx, "vy": now.vy, "end_rate": now.end_rate}
    found = {n: getattr(model, n) for n in (*places, *rates)}
    for (name, x), slope in zip(places.items(), slopes.values(), strict=True):
        assert found[name] == pytest.approx(x + slope * T**3 / 6, rel=1e-14), name
    for (name, x), slope in zip(rates.items(), slopes.values(), strict=True):
        assert found[name] == pytest.approx(x + slope * T**2 / 2, rel=1e-14), name
    after = model.get_state()
    assert after != before
    model.undo()
    assert model.get_state() == before
    other, *_ = started(body)
    other.set_state(after)
    assert other.get_state() == after
    assert (other.end, other.end_rate) == (found["end"], found["end_rate"])


def test_what_is_on_is_known(body: Derived) -> None:
    quiet = dict.fromkeys((*body.damping, *body.forces), 0.0)
    quiet |= {"spring.end_rate_start": 0.0, "spring.end_acceleration": 0.0}
    always = "swirl" not in body.forces
    assert set(body.forces) == {"body.fx", "body.fy", "push", "lift"} | (
        set() if always else {"swirl"}
    )
    found = {}
    for name in ("", *quiet):
        model, *_ = started(body, **quiet | ({name: 1.0} if name else {}))
        found[name] = [model.pushed, model.damped, model.reshapes]
        assert model.plain == (not any(found[name]))
        assert model.is_constant == (not model.reshapes)
        assert model.uses_rates == (not model.plain)
    pushed = [True, False, False]
    shaped = [always, False, True]
    true = {n: [always, True, False] for n in body.damping} | dict.fromkeys(body.forces, pushed)
    true |= {"": [always, False, False], "spring.end_rate_start": shaped}
    assert found == true | {"spring.end_acceleration": shaped}


def test_damping_of_a_length_has_the_unit_of_that_of_a_mass(body: Derived) -> None:
    units = {v.name: v.unit for v in body.variables}
    assert (units["air"], units["rail"]) == ("N.s/m", "N.s/m")

"""What must hold between the derived functions of any system, in 80 digits at random states."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import mpmath
import pytest

from curvebound.mechanics.derived import Derived

STEP = mpmath.mpf(10) ** -25
CLOSE = mpmath.mpf(10) ** -35
Draw = Callable[..., dict[str, Any]]


def moved(system: Derived, s: dict[str, Any], a: list[Any], h: Any) -> dict[str, Any]:
    """The symbols h s later, to second order, of a motion with accelerations a."""
    t = dict(s)
    for name, rate, x in zip(system.coordinates, system.rates, a, strict=True):
        t[name] = s[name] + h * (s[rate] + h * x / 2)
        t[rate] = s[rate] + h * x
    for name in system.shapes:
        push = s[f"{name}_acceleration"]
        t[name] = s[name] + h * (s[f"{name}_rate"] + h * push / 2)
        t[f"{name}_rate"] = s[f"{name}_rate"] + h * push
    for n in "xy":
        t[f"frame.{n}"] = s[f"frame.{n}"] + h * (s[f"frame.v{n}"] + h * s[f"frame.a{n}"] / 2)
        t[f"frame.v{n}"] = s[f"frame.v{n}"] + h * s[f"frame.a{n}"]
    return t


def rate(f: Callable[[dict[str, Any]], Any], system: Derived, s: Any, a: list[Any]) -> Any:
    """Time derivative of f(symbols) along the motion."""
    ahead, back = f(moved(system, s, a, STEP)), f(moved(system, s, a, -STEP))
    return (ahead - back) / (2 * STEP)


def close(got: Any, true: Any, size: Any = 0) -> None:
    scale = max(abs(true), abs(size), mpmath.mpf(10) ** -12)
    assert abs(got - true) <= CLOSE * scale, (mpmath.nstr(got, 20), mpmath.nstr(true, 20))


@pytest.mark.parametrize("prefix", ["", "linear_"])
def test_hamilton_and_cauchy_binet_agree(
    system: Derived, drawn: Draw, many: Any, prefix: str
) -> None:
    if prefix and not system.has_linear:
        return
    momenta, velocities, pushes = (
        system.function(prefix + name) for name in ("momenta", "velocities", "pushes")
    )
    for _ in range(4):
        s = drawn(system, 0.3)
        a = system.function(prefix + "accelerations")(many, s)
        p = momenta(many, s)
        s |= {f"momentum.{i}": x for i, x in enumerate(p)}
        size = sum(abs(x) for x in p)
        for got, name in zip(velocities(many, s), system.rates, strict=True):
            close(got, s[name], 1)
        for i, got in enumerate(pushes(many, s)):
            true = rate(lambda x, i=i: momenta(many, x)[i], system, s, a)
            close(got, true, size)


def test_energy_changes_by_the_power_of_what_acts(system: Derived, drawn: Draw, many: Any) -> None:
    energies = system.function("energies")
    for _ in range(4):
        s = drawn(system, 0.3)
        a = system.function("accelerations")(many, s)
        held = system.function("held")(many, s)
        power = sum(system.function("fed")(many, s))
        power += held[0] * s["frame.vx"] + held[1] * s["frame.vy"]
        for force, name in zip(held[2:], system.shapes, strict=True):
            power += force * s[f"{name}_rate"]
        true = rate(lambda x: sum(energies(many, x).values()), system, s, a)
        close(power, true, sum(abs(x) for x in energies(many, s).values()))


def test_linear_energy_changes_by_the_power(system: Derived, drawn: Draw, many: Any) -> None:
    if not system.has_linear:
        return
    energies = system.function("linear_energies")
    for _ in range(4):
        s = drawn(system, 0.3)
        a = system.function("linear_accelerations")(many, s)
        power = sum(system.function("linear_fed")(many, s))
        true = rate(lambda x: sum(energies(many, x).values()), system, s, a)
        close(power, true, sum(abs(x) for x in energies(many, s).values()))


def test_reaction_on_the_frame_is_newtons(system: Derived, drawn: Draw, many: Any) -> None:
    places = system.function("places")
    for _ in range(4):
        s = drawn(system, 0.3)
        a = system.function("accelerations")(many, s)
        held = system.function("held")(many, s)
        for i, axis in enumerate("xy"):
            true = size = mpmath.mpf(0)
            for m in system.masses:
                name = f"{m}.v{axis}"
                speed = rate(lambda x, n=name: places(many, x)[n], system, s, a)
                part = s[f"{m}.mass"] * (speed - s[f"gravity.{axis}"])
                true += part - s[f"{m}.f{axis}"]
                size += abs(part)
            close(held[i], true, size)


@pytest.mark.parametrize("prefix", ["", "linear_"])
def test_jacobian_is_the_derivative(system: Derived, drawn: Draw, many: Any, prefix: str) -> None:
    if prefix and not system.has_linear:
        return
    accelerations = system.function(prefix + "accelerations")
    s = drawn(system, 0.3)
    found = system.function(prefix + "jacobian")(many, s)
    for k, name in enumerate((*system.coordinates, *system.rates)):
        ahead = accelerations(many, {**s, name: s[name] + STEP})
        back = accelerations(many, {**s, name: s[name] - STEP})
        for i in range(len(found)):
            close(found[i][k], (ahead[i] - back[i]) / (2 * STEP), ahead[i])


def test_linear_is_the_limit_of_small_motion(system: Derived, drawn: Draw, many: Any) -> None:
    if not system.has_linear:
        return
    small = mpmath.mpf(10) ** -30
    s = drawn(system, 0.3)
    for name in (*system.coordinates, *system.rates):
        s[name] *= small
    rest = {**s, **dict.fromkeys((*system.coordinates, *system.rates), mpmath.mpf(0))}
    # constant forces leave a constant acceleration: without them the rest is one
    for name in [*system.forces, "field.x"]:
        s[name] = rest[name] = mpmath.mpf(0)
    still = system.function("accelerations")(many, rest)
    true = [x - y for x, y in zip(
        system.function("accelerations")(many, s), still, strict=True)]  # fmt: skip
    linear = system.function("linear_accelerations")(many, s)
    for got, x in zip(linear, true, strict=True):
        assert abs(got - x) <= mpmath.mpf(10) ** -25 * abs(x)

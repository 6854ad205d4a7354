"""The bead in a constant field by elliptic functions, against its equation of motion."""

from __future__ import annotations

import math

import pytest
from mpmath import mp

from curvebound.fmi.folder import find

_one_bead = find("BeadOnWire").module("reference")._one_bead
TIMES = [0.0, 0.3, 1.0, 2.5, 6.0]
X, Y, R = 3.0, -4.0, 2.0  # a field of 5 m/s2 towards atan2(3, 4)
DOWN = math.atan2(X, -Y)
W = math.sqrt(math.hypot(X, Y) / R)


def integrated(angle: float, rate: float) -> list[tuple[float, float]]:
    """By Runge-Kutta steps of 1 ms."""

    def slope(a: float, v: float) -> tuple[float, float]:
        return v, (X * math.cos(a) + Y * math.sin(a)) / R

    found, t, h = [], 0.0, 1e-3
    for end in TIMES:
        while t < end - h / 2:
            k1 = slope(angle, rate)
            k2 = slope(angle + h / 2 * k1[0], rate + h / 2 * k1[1])
            k3 = slope(angle + h / 2 * k2[0], rate + h / 2 * k2[1])
            k4 = slope(angle + h * k3[0], rate + h * k3[1])
            angle += h / 6 * (k1[0] + 2 * k2[0] + 2 * k3[0] + k4[0])
            rate += h / 6 * (k1[1] + 2 * k2[1] + 2 * k3[1] + k4[1])
            t += h
        found.append((angle, rate))
    return found


@pytest.mark.parametrize(
    ("angle", "rate"),
    [
        (DOWN, 0.0), (DOWN + 0.5, 0.0), (DOWN - 2.9, 0.0), (DOWN, 1.0), (DOWN, -1.0),
        (DOWN + 1.0, -0.7), (DOWN + 1.0, 0.7), (DOWN + 13.0, 0.2), (DOWN - 8.0, -0.2),
        (DOWN, 3.5), (DOWN, -3.5), (DOWN + 2.0, 4.0), (DOWN - 2.0, -4.0), (DOWN + 20.0, 9.0),
    ],
)  # fmt: skip
def test_closed_form(angle: float, rate: float) -> None:
    numbers = [mp.mpf(x) for x in (X, Y, R, angle, rate)]
    found = _one_bead(*numbers, TIMES)
    for (a, v), (b, w) in zip(found, integrated(angle, rate), strict=True):
        assert (float(a), float(v)) == pytest.approx((b, w), abs=2e-9)


@pytest.mark.parametrize(("off", "given"), [(0.0, False), (1e-14, False), (1e-9, True)])
def test_next_to_the_separatrix_there_is_none(off: float, given: bool) -> None:
    with mp.workdps(30):
        start = mp.atan2(mp.mpf(X), -mp.mpf(Y))
        for sign in (1, -1):
            rate = 2 * mp.sqrt(mp.hypot(X, Y) / R) * mp.sqrt(1 + sign * mp.mpf(off))
            found = _one_bead(mp.mpf(X), mp.mpf(Y), mp.mpf(R), start, rate, [0.0, 1.0])
            assert (found is not None) is given
            assert W > 0.0


def test_without_a_field_it_turns_on() -> None:
    zero = mp.mpf(0)
    assert _one_bead(zero, zero, mp.mpf(2), mp.mpf(1), mp.mpf(-3), [0.0, 2.0]) == [
        (1, -3), (-5, -3),
    ]  # fmt: skip

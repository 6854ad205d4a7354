"""The numbers in which equations are evaluated keep the digits that they promise."""

from __future__ import annotations

import mpmath
import numpy as np
import pytest

from curvebound.mechanics.numeric import ManyDigits, double, extended

NAMES = ("sin", "cos", "tan", "exp", "log", "asin", "acos", "atan", "sinh", "cosh", "tanh", "sqrt")


def test_fractions_pi_and_functions_have_all_their_digits() -> None:
    with mpmath.workdps(60):
        many = ManyDigits()
        third, pi = many.ratio(1, 3), many.pi
        assert abs(3 * third - 1) < mpmath.mpf(10) ** -59
        assert abs(pi - mpmath.pi) < mpmath.mpf(10) ** -58
        for F, digits in ((extended, 18.5), (double, 15.5)):
            close = mpmath.mpf(10) ** -digits
            assert abs(exact(F.ratio(1, 3)) * 3 - 1) < close
            assert abs(exact(F.pi) / pi - 1) < close
            for name in NAMES:
                x = F.ratio(2, 7)
                true = getattr(mpmath, name)(exact(x))
                assert abs(exact(getattr(F, name)(x)) / true - 1) < 4 * close, name
                assert getattr(many, name)(exact(x)) == true
            assert exact(F.atan2(F.ratio(-2, 7), F.number(-1))) < -2


def exact(x: object) -> mpmath.mpf:
    high = float(x)  # type: ignore[arg-type]
    return mpmath.mpf(high) + mpmath.mpf(float(x - np.longdouble(high)))  # type: ignore[operator]


@pytest.mark.parametrize("y", [-0.5, 0.0, 2.0])
def test_size_and_sign(y: float) -> None:
    many = ManyDigits()
    for F in (extended, double, many):
        assert F.copysign(F.number(3), F.number(y)) == (-3 if y < 0 else 3)
        assert F.fabs(F.number(y)) == abs(y)

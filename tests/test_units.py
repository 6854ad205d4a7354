"""Units are read and written in one place."""

from __future__ import annotations

import pytest

from curvebound.errors import CurveboundError
from curvebound.units import exponents, per_second


@pytest.mark.parametrize(
    ("unit", "expected"),
    [
        ("1", {}),
        ("m/s2", {"m": 1, "s": -2}),
        ("Hz", {"s": -1}),
        ("N.m.s/rad", {"kg": 1, "m": 2, "s": -1, "rad": -1}),
        ("1/(m.s2)", {"m": -1, "s": -2}),
        ("N/m", {"kg": 1, "s": -2}),
        ("m/(s2.rad)", {"m": 1, "s": -2, "rad": -1}),
        ("N.m/rad", {"kg": 1, "m": 2, "s": -2, "rad": -1}),
    ],
)
def test_exponents(unit: str, expected: dict[str, int]) -> None:
    assert exponents(unit) == expected


@pytest.mark.parametrize("unit", ["", "meter", "m/", "m//s", "m s", "1.m", "m/1", "m/s/s", "m-1"])
def test_what_is_no_unit_is_refused(unit: str) -> None:
    with pytest.raises(CurveboundError, match="is no unit"):
        exponents(unit)


def test_per_second() -> None:
    assert [per_second("m"), per_second("rad", 2), per_second("1/m"), per_second("1")] == [
        "m/s",
        "rad/s2",
        "1/(m.s)",
        "1/s",
    ]
    assert per_second("m.s") == "m"

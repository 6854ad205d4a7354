"""Units are read and written in one place."""

from __future__ import annotations

import pytest

from curvebound import units
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


def test_all_units_there_are() -> None:
    expected = {base: {base: 1} for base in ("kg", "m", "s", "A", "K", "mol", "cd", "rad")} | {
        "Hz": {"s": -1}, "N": {"kg": 1, "m": 1, "s": -2}, "J": {"kg": 1, "m": 2, "s": -2},
        "W": {"kg": 1, "m": 2, "s": -3}, "Pa": {"kg": 1, "m": -1, "s": -2},
    }  # fmt: skip
    assert expected == units._NAMED
    assert (*units.BASE_UNITS,) == ("kg", "m", "s", "A", "K", "mol", "cd", "rad")


@pytest.mark.parametrize(
    ("of", "to", "expected"),
    [
        ((1.0, 0.0), (1.0, 0.0), (1.0, 0.0)),
        ((1000.0, 0.0), (1.0, 0.0), (1000.0, 0.0)),
        ((1.0, 0.0), (0.25, 0.0), (4.0, 0.0)),
        ((1.0, 273.15), (1.0, 0.0), (1.0, 273.15)),
        ((1.0, 0.0), (1.0, 273.15), (1.0, -273.15)),
        ((2.0, 7.0), (4.0, 3.0), (0.5, 1.0)),
    ],
)
def test_conversion(
    of: tuple[float, ...], to: tuple[float, ...], expected: tuple[float, float]
) -> None:
    kind = (0.0, 1.0, -1.0, 0.0, 0.0, 0.0, 0.0, 0.0)
    assert units.conversion((*kind, *of), (*kind, *to)) == pytest.approx(expected)
    for i in range(8):
        other = tuple(x + (k == i) for k, x in enumerate(kind))
        assert units.conversion((*kind, *of), (*other, *to)) is None
    assert [units.labelled("x", unit) for unit in ("m", "1", "")] == ["x (m)", "x", "x"]

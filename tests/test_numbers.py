"""Numbers as people write them."""

from __future__ import annotations

import math

import pytest

from curvebound.numbers import plain, quantity, ticks


@pytest.mark.parametrize(
    ("value", "written"),
    [
        (160.3, "160"), (3.9712, "3.97"), (4.0, "4"), (0.0012, "0.0012"), (1e-5, "1e-5"),
        (2.3456e-9, "2.35e-9"), (-2.5e-7, "-2.5e-7"), (123456.0, "123000"), (1.5e6, "1.5e6"),
        (999.9, "1000"), (0.0, "0"), (-0.0, "0"), (math.inf, "inf"),
    ],
)  # fmt: skip
def test_plain(value: float, written: str) -> None:
    assert plain(value) == written


@pytest.mark.parametrize(
    ("value", "unit", "written"),
    [
        (3.27e-6, "s", "3.27 us"), (1e-3, "s", "1 ms"), (0.0999999, "s", "100 ms"),
        (9.9999e-4, "s", "1 ms"), (20.0, "s", "20 s"), (0.0, "s", "0 s"), (1e-12, "s", "1e-12 s"),
        (2.2e-16, "J", "2.2e-16 J"), (0.5, "1", "0.5"),
    ],
)  # fmt: skip
def test_with_a_unit(value: float, unit: str, written: str) -> None:
    assert quantity(value, unit) == written


@pytest.mark.parametrize(
    ("low", "high"), [(0.0, 10.0), (-1.57, 1.57), (3.0, 3.0001), (-1e-13, 4e-13), (2e7, 9e7)]
)
def test_ticks_are_round_and_within(low: float, high: float) -> None:
    found = ticks(low, high)
    assert 3 <= len(found) <= 7
    assert low <= found[0] < found[-1] <= high
    step = found[1] - found[0]
    assert float(f"{step:.1e}"[:3]) in (1.0, 2.0, 5.0)
    assert len({plain(value, 12) for value in found}) == len(found)

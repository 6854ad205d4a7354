"""What the page gets is what the result holds, to more digits than a screen shows."""

from __future__ import annotations

import base64
import zlib
from typing import Any

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from hypothesis.extra.numpy import arrays

from curvebound.view.packing import Packer

Floats = np.ndarray[Any, np.dtype[np.float64]]


def unpack(packer: Packer) -> list[Floats]:
    """assets/data.js in Python."""
    octets = np.frombuffer(zlib.decompress(base64.b64decode(packer.base64())), dtype=np.uint8)
    found = []
    for channel in packer.channels:
        n = channel["samples"]
        if channel["kind"] == "constant":
            found.append(np.full(n, np.nan if channel["value"] is None else channel["value"]))
            continue
        width = channel["bytes"]
        planes, octets = octets[: n * width].reshape(width, n), octets[n * width :]
        values = sum(planes[i].astype(np.int64) << 8 * i for i in range(width))
        for _ in range(channel["order"]):
            values = np.cumsum(values) & (1 << 8 * width) - 1
        if channel["kind"] == "float":
            found.append((values << 8).astype(np.uint32).view(np.float32).astype(float))
        else:
            none = values == (1 << 8 * width) - 1
            found.append(np.where(none, np.nan, channel["low"] + values * channel["step"]))
    assert not len(octets)
    return found


def test_signals_of_all_kinds_come_back() -> None:
    t = np.arange(5000) * 1e-3
    gaps = np.sin(t)
    gaps[100:200] = np.nan
    gaps[300] = np.inf
    signals = [np.sin(4 * t), gaps, np.where(t < 2, 0.0, 1.0), np.full(5000, 9.81), np.arange(5000)]
    packer = Packer()
    assert packer.time(t) == 0
    assert [packer.signal(values) for values in signals] == [1, 2, 3, 4, 5]
    assert packer.signal(signals[0].copy()) == 1, "the same values are kept once"
    time, *back = unpack(packer)
    assert np.abs(time - t).max() < 1e-11
    for values, found in zip(signals, back, strict=True):
        good = np.isfinite(values)
        assert np.array_equal(np.isfinite(found), good)
        assert np.abs(found - values)[good].max() <= np.ptp(values[good]) / 2**24
    assert np.array_equal(back[4], signals[4]), "counts are exact"


def test_errors_keep_their_digits_over_all_magnitudes() -> None:
    error = np.geomspace(1e-17, 1e3, 3000) * np.where(np.arange(3000) % 2, 1.0, -1.0)
    packer = Packer()
    packer.signal(error, error=True)
    assert np.abs(unpack(packer)[0] / error - 1.0).max() < 2**-16


def test_a_run_that_blew_up_still_shows_how_it_began() -> None:
    t = np.linspace(0, 100, 5001)
    x = np.where(t < 90, np.sin(t), np.exp(np.minimum(3 * (t - 90), 700)))
    packer = Packer()
    packer.signal(x)
    assert np.abs(unpack(packer)[0] - x)[t < 90].max() < 2e-5


@settings(max_examples=60, deadline=None)
@given(
    arrays(np.float64, st.integers(1, 40), elements=st.floats(allow_nan=True, allow_infinity=True)),
    st.booleans(),
)
def test_anything_comes_back_to_within_its_encoding(values: Floats, error: bool) -> None:
    packer = Packer()
    packer.signal(values, error=error)
    found = unpack(packer)[0]
    channel = packer.channels[0]
    good = np.isfinite(values)
    if channel["kind"] == "float":
        # single precision ends at 3.4e38 and thins out below 1.2e-38
        seen = np.abs(values) < 3.4e38
        ordinary = seen & (np.abs(values) > 1.2e-38)
        with np.errstate(all="ignore"):
            assert (np.abs(found / values - 1.0)[ordinary] < 2**-15).all()
        assert not np.isfinite(found[~seen]).any()
    else:
        good = np.abs(values) < 1e300
        assert np.array_equal(np.isfinite(found), good)
        if good.any():
            low, high = values[good].min(), values[good].max()
            # no step is below the ordinary floats
            step = max(high / 2**23 - low / 2**23, float(np.finfo(float).tiny))
            rounding = 4e-16 * max(abs(low), abs(high))
            assert (np.abs(found / 2 - values / 2)[good] <= step / 4 + rounding + 5e-324).all()


@pytest.mark.parametrize(("kind", "most"), [("noise", 4.05), ("motion", 0.8)])
def test_bytes_per_sample(kind: str, most: float) -> None:
    n = 100_000
    noise = np.random.default_rng(1).normal(size=n)
    packer = Packer()
    packer.signal(noise if kind == "noise" else np.sin(4.2 * np.arange(n) * 1e-3))
    assert len(packer.base64()) < most * n

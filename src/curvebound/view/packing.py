"""Packs samples for the replay page: small, and more exact than a screen can show.

A signal becomes integers of 24 bits, 1.7e7 steps between its least and greatest value; one that
measures an error becomes floats of 24 bits instead (4.5 digits of whatever magnitude), and time
gets integers of 40 bits. Smooth signals have small differences, so each is differenced up to three
times, modulo the range of its integers, whichever makes it smallest; the bytes of equal weight are
then laid side by side and deflated together. White noise, the worst case, takes 4 bytes a sample in
base64. assets/data.js is the other half.
"""

from __future__ import annotations

import base64
import zlib
from typing import Any

import numpy as np
from numpy.typing import NDArray

__all__ = ["Packer"]

_SIGNAL_BYTES = 3
_TIME_BYTES = 5
_ORDERS = 4
_EFFORT = 6  # 9 takes twenty times as long for a twelfth of the size
_UNEVEN = 1e4
_BEYOND = 1e300  # where differences would overflow


class Packer:
    """Collects signals; each gets a number, the same for the same values."""

    def __init__(self) -> None:
        self.channels: list[dict[str, Any]] = []
        self._planes: list[bytes] = []
        self._known: dict[tuple[bytes, str], int] = {}

    def signal(self, values: NDArray[np.float64], *, error: bool = False) -> int:
        """Add a signal, shape (n,); what is not finite, or beyond 1e300, reads back as NaN."""
        return self._add(values, "float" if error else "linear", _SIGNAL_BYTES)

    def time(self, values: NDArray[np.float64]) -> int:
        """Add the times of samples, ascending, in s."""
        return self._add(values, "linear", _TIME_BYTES)

    def blank(self, channel: int) -> bool:
        """Whether a channel holds no number at all."""
        return "value" in self.channels[channel] and self.channels[channel]["value"] is None

    def base64(self) -> str:
        """Everything added so far, deflated (zlib, RFC 1950)."""
        return base64.b64encode(zlib.compress(b"".join(self._planes), _EFFORT)).decode("ascii")

    def _add(self, values: NDArray[np.float64], kind: str, width: int) -> int:
        values = np.ascontiguousarray(values, dtype=np.float64)
        key = (values.tobytes(), f"{kind}{width}")
        number = self._known.get(key)
        if number is None:
            number = self._known[key] = len(self.channels)
            self.channels.append(self._encode(values, kind, width))
        return number

    def _encode(self, values: NDArray[np.float64], kind: str, width: int) -> dict[str, Any]:
        finite = np.abs(values) < _BEYOND
        channel: dict[str, Any] = {"samples": len(values)}
        if not finite.any():
            return {**channel, "kind": "constant", "value": None}
        low, high = float(values[finite].min()), float(values[finite].max())
        if finite.all() and low == high:
            return {**channel, "kind": "constant", "value": low}
        if kind == "float" or (width == _SIGNAL_BYTES and _uneven(values[finite])):
            kind = "float"
            integers = _floats(values)
        else:
            # The greatest integer stands for NaN; halves keep high - low from overflowing.
            top = 2 ** (8 * width) - 2
            step = 2.0 * (high / 2.0 / top - low / 2.0 / top)
            step = max(step, np.finfo(np.float64).tiny)
            if high - low <= top and np.all(values[finite] == np.rint(values[finite])):
                step = 1.0  # counts stay exact
            halves = np.where(finite, values, low) / 2.0 - low / 2.0
            scaled = np.clip(np.rint(halves / (step / 2.0)), 0, top)
            integers = np.where(finite, scaled, top + 1).astype(np.int64)
            channel |= {"low": low, "step": step}
        order, differences = _least(integers, 8 * width)
        octets = differences.astype("<u8").view(np.uint8).reshape(len(values), 8)[:, :width]
        self._planes.append(np.ascontiguousarray(octets.T).tobytes())
        return {**channel, "kind": kind, "bytes": width, "order": order}


def _uneven(values: NDArray[np.float64]) -> bool:
    """Whether equal steps would drown most values, as in a run that blew up at its end."""
    sizes = np.abs(values)
    return bool(sizes.max() > _UNEVEN * np.percentile(sizes, 25) > 0.0)


def _floats(values: NDArray[np.float64]) -> NDArray[np.int64]:
    """The upper 24 bits of single-precision floats, rounded to nearest."""
    with np.errstate(over="ignore"):
        single = values.astype(np.float32)
    bits = single.view(np.uint32).astype(np.int64) + 0x80 >> 8
    return np.where(np.isfinite(single), bits, 0x7FC000)


def _least(integers: NDArray[np.int64], bits: int) -> tuple[int, NDArray[np.int64]]:
    """The number of differences that leaves the smallest numbers, and these, modulo 2^bits."""
    mask = (1 << bits) - 1
    best: tuple[float, int, NDArray[np.int64]] | None = None
    current = integers
    for order in range(_ORDERS):
        if order:
            current = np.diff(current, prepend=0) & mask
        size = float(np.log2(1.0 + np.minimum(current, mask + 1 - current)).sum())
        if best is None or size < best[0]:
            best = (size, order, current)
    assert best is not None
    return best[1], best[2]

"""Hosts that round communication points: what is little beside the step makes no difference."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
import pytest
from harness import ERROR, OK

ROUNDINGS: dict[str, Callable[[float], float]] = {
    "microseconds": lambda t: round(t * 1e6) / 1e6,
    "cut to microseconds": lambda t: int(t * 1e6) / 1e6,
    "single precision": lambda t: float(np.float32(t)),
}


@pytest.mark.parametrize("rounding", ROUNDINGS)
@pytest.mark.parametrize("step", [1 / 300, 1 / 30])
def test_a_run_with_rounded_times(start, rounding: str, step: float) -> None:
    """30 s: single precision then resolves 2 microseconds."""
    rounded = ROUNDINGS[rounding]
    instance, other = start("BeadOnWire", stop_time=30.0), start("BeadOnWire")
    count = round(30.0 / step)
    for k in range(count):
        assert instance.status("doStep", rounded(k * step), step) == OK, instance.errors
        other.slave.doStep(k * step, step)
    assert instance["bead.angle"] == pytest.approx(other["bead.angle"], rel=1e-9)


@pytest.mark.parametrize(
    ("present", "point", "step"),
    [
        (1.0, 1.0001, 0.01),  # a hundredth of the step, but no rounding
        (1.0, 0.99, 10.0),
        (0.0, 1e-6, 1e-5),  # a rounding, but a tenth of the step
        (1.0, 1.0 + 2e-5, 1.0),
    ],
)
def test_what_is_no_rounding_is_refused(start, present: float, point: float, step: float) -> None:
    instance = start("BeadOnWire")
    if present:
        instance.step(present)
    assert instance.status("doStep", point, step) == ERROR
    assert "currentCommunicationPoint" in instance.errors[0]

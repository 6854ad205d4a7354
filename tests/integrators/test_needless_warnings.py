"""No warning where errors are far below the tolerance."""

from __future__ import annotations

import pytest
from benchmarks.ours import interpreted_kernel

from curvebound.kernel.adaptive import Adaptive
from curvebound.kernel.method import DONE

KERNEL = interpreted_kernel()


@pytest.mark.parametrize(
    ("changed", "tolerance", "step"),
    [
        # a start from rest, with damping: "magnifies roundings to 1 of it", off by 1e-15
        (
            {
                "gravity.x": -0.397,
                "wire.radius": 0.489,
                "bead.mass": 1.3e-7,
                "bead.damping": 1.44e-3,
                "bead.angle_start": 2.54,
                "model.formulation": 2,
            },
            1.3e-12,
            0.185,
        ),
        (
            {
                "gravity.y": -9.81,
                "wire.radius": 11.4,
                "bead.mass": 1.02e5,
                "bead.damping": 1.79e9,
                "bead.angle_start": 2.01,
            },
            9.4e-10,
            8.9e-2,
        ),
        # near the unstable rest one Cartesian coordinate hardly moves
        (
            {
                "gravity.y": 9.81,
                "wire.radius": 11.9,
                "bead.angle_start": -2.194e-6,
            },
            1.4e-7,
            0.0711,
        ),
    ],
    ids=["angle", "Cartesian", "at the top"],
)
def test_a_tame_start_is_no_reason_for_a_warning(
    changed: dict[str, float], tolerance: float, step: float
) -> None:
    calm = {"gravity.x": 0.0, "gravity.y": 0.0, "bead.damping": 0.0}
    model = KERNEL.system("BeadOnWire", {**calm, "model.formulation": 1, **changed})
    method = Adaptive()
    for _ in range(20):
        assert method.advance(model, step, 1, tolerance, 10_000) == DONE
    assert max(method.doubt(), method.loss()) <= tolerance

"""A constraint that feedback holds, over times that are long for the feedback.

Without gravity a bead on a circle keeps its rate for ever. Baumgarte's feedback is stiff then, and
what rounding makes of it is far more than the acceleration along the wire: errors there once passed
for rounding.
"""

from __future__ import annotations

import math
from functools import cache
from typing import Any

import pytest
from kernel_module import kernel_module

from curvebound.fmi.folder import find
from curvebound.kernel.adaptive import Adaptive
from curvebound.kernel.method import DONE
from curvebound.kernel.radau import Radau
from curvebound.kernel.rounding import Rounding

BAUMGARTE = {"model.formulation": 1, "constraint.stabilization": 2}


@cache
def kernel(form: str) -> Any:
    """The module of the bead's kernel: by hand, or derived from its mechanics."""
    folder = find("BeadOnWire")
    if form == "by hand":
        return folder.module("kernel")
    return kernel_module(folder.derived())


def bead(form: str, radius: float, rate: float, stiffness: float, damping: float) -> Any:
    """A bead without gravity, started."""
    model = kernel(form).model(BAUMGARTE)
    given = {
        "wire.radius": radius,
        "bead.mass": 1.0,
        "bead.angle_start": 0.7,
        "bead.angular_velocity_start": rate,
        "constraint.stiffness": stiffness,
        "constraint.damping": damping,
    }
    model.start({**dict.fromkeys(model.PARAMETERS, 0.0), **given}, BAUMGARTE)
    return model


def motion(model: Any) -> tuple[float, float, float]:
    """Angle, its rate and the distance from the centre."""
    square = model.q0**2 + model.q1**2
    rate = (model.q0 * model.v1 - model.q1 * model.v0) / square
    return math.atan2(model.q0, -model.q1), rate, math.sqrt(square)


@pytest.mark.parametrize("form", ["by hand", "derived"])
@pytest.mark.parametrize(
    ("radius", "rate", "stiffness", "damping", "time", "parts", "tolerance"),
    [
        # as a random sample found it: off by 4e-4
        (320.99825246502724, 3.992397782587473e-06, 100.0, 20.0, 1e6, 20, 1e-8),
        # relatives: off by up to 0.4
        (1e3, 2.1e-8, 51.0, 4.3, 1.2e8, 20, 2.2e-5),
        pytest.param(4.5e3, -4.4e-6, 1.2e2, 6.7, 1.8e6, 1, 5.5e-9, marks=pytest.mark.slow),
        (63.0, -2.5e-4, 3.7e4, 3.9e2, 2.8e4, 1, 3.8e-7),
        (0.0011, -1.3e-7, 18.0, 8.4, 2.4e7, 20, 2.1e-5),
    ],
)
def test_a_bead_keeps_its_rate(
    form: str,
    radius: float,
    rate: float,
    stiffness: float,
    damping: float,
    time: float,
    parts: int,
    tolerance: float,
) -> None:
    model = bead(form, radius, rate, stiffness, damping)
    method = Adaptive()
    for part in range(1, parts + 1):
        assert method.advance(model, time / parts, 1, tolerance, 10_000) == DONE
        angle, now, distance = motion(model)
        assert now == pytest.approx(rate, rel=5 * tolerance, abs=0.0)
        assert distance == pytest.approx(radius, rel=5 * tolerance, abs=0.0)
        turned = math.remainder(angle - 0.7 - rate * time * part / parts, math.tau)
        assert abs(turned) < 5 * tolerance * max(1.0, abs(rate) * time)
    # nor is there a warning
    assert max(method.doubt(), method.loss()) <= tolerance
    assert method.evaluations < 40_000


@pytest.mark.parametrize("count", [1, pytest.param(12, marks=pytest.mark.slow)])
@pytest.mark.parametrize("form", ["by hand", pytest.param("derived", marks=pytest.mark.slow)])
def test_where_rounding_decides_it_is_said(form: str, count: int) -> None:
    """Stiffness times the square of the step is 1e17: some beads are off, none in silence."""
    tolerance, rate = 6.6e-6, 1e-8
    warned = 0
    for part in range(count):
        model = bead(form, 0.039 * (1.0 + 1e-3 * part), rate, 7.0, 5.3)
        method = Adaptive()
        assert method.advance(model, 9.6e8, 1, tolerance, 10_000) == DONE
        if max(method.doubt(), method.loss()) > tolerance:
            warned += 1
        else:
            assert motion(model)[1] == pytest.approx(rate, rel=10 * tolerance, abs=0.0)
    assert 2 * warned < count


def test_what_a_stale_matrix_hides_is_no_rounding() -> None:
    """One step of 3.75e4 s, 0.15 rad: residuals along the wire were left, as small as rounding."""
    rate = 3.992397782587473e-06
    model = bead("by hand", 320.99825246502724, rate, 100.0, 20.0)
    rounding = Rounding()
    rounding.follow(model, 0.0, 0.0)
    assert Radau().step(model, rounding, 0.0, 3.75e4, 2e-9, 1e-6) <= 1e-6
    angle, now, distance = motion(model)
    assert now == pytest.approx(rate, rel=1e-13, abs=0.0)
    assert angle == pytest.approx(0.7 + 3.75e4 * rate, rel=1e-13)
    assert distance == pytest.approx(320.99825246502724, rel=1e-14)


def test_a_motion_and_its_mirror_image_have_the_same_bits() -> None:
    """What stiff steps try in order to see rounding is mirrored too."""
    odd = (
        *("gravity.x", "slider.u_start", "slider.u_rate_start"),
        *("pendulum.angle_start", "pendulum.angular_velocity_start"),
    )
    start = {
        **dict.fromkeys(("slider.mass", "pendulum.mass", "pendulum.length", "slider.damping"), 1.0),
        "pendulum.damping": 1096.6331584284585,
        "parabola.coefficient_start": -1.0,
        "parabola.coefficient_rate_start": -1.0,
        "gravity.x": -1.0,
        "slider.u_start": -1.0,
        "slider.u_rate_start": -0.4472135954999579,
        "pendulum.angular_velocity_start": -1.0,
    }
    ends = []
    for sign in (1.0, -1.0):
        model = find("ParabolaPendulum").module("kernel").model({"model.fidelity": 2})
        given = {k: sign * x if k in odd else x for k, x in start.items()}
        model.start({**dict.fromkeys(model.PARAMETERS, 0.0), **given}, {"model.fidelity": 2})
        model.set_inputs([sign * -1.0, 0.0, -1.0, sign * -1.0, -1.0, sign * -1.0, -1.0], 0)
        method = Adaptive()
        for _ in range(3):
            assert method.advance(model, 0.10606601717798211, 1, 1e-8, 3000) == DONE
        ends.append([sign * x for x in (model.q0, model.q1, model.v0, model.v1)])
    assert ends[0] == ends[1]

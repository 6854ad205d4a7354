"""Compiled and interpreted kernels give the same bits, in one process."""

from __future__ import annotations

import random

import pytest
from driven import METHODS, MODELS, constant, inputs_at, slopes_at
from harness import Extracted, Instance, Value

from curvebound.fmi.compile import why_not

pytestmark = pytest.mark.skipif(bool(why_not()), reason=f"not compiled: {why_not()}")

CASES: dict[str, tuple[str, dict[str, Value]]] = {
    **{
        f"{label}-{method}": (fmu, {**parameters, "solver.method": method})
        for label, (fmu, parameters) in MODELS.items()
        for method in METHODS
    },
    "linear-exact": (
        "ParabolaPendulum",
        {**constant(MODELS["linear"][1]), "solver.method": "exact"},
    ),
    # high energies: turns are counted, steps rejected and halved
    **{
        f"{formulation}-{method}-whirling": (
            "BeadOnWire",
            {
                "model.formulation": formulation,
                "solver.method": method,
                "bead.angular_velocity_start": 60.0,
            },
        )
        for formulation in ("lagrange_multiplier", "angle")
        for method in ("rk4", "adaptive", "implicit")
    },
    **{
        f"stiff-{method}": (
            "ParabolaPendulum",
            {
                "solver.method": method,
                "pendulum.mass": 100.0,
                "parabola.coefficient_start": 2.0,
                "pendulum.angle_start": 2.5,
                "pendulum.angular_velocity_start": -3.0,
                "solver.step": 1e-4,
            },
        )
        for method in ("adaptive", "implicit")
    },
    **{
        f"drive-{kind}-{axis}-{period}": (
            "ParabolaDrive",
            {
                "waveform.kind": kind,
                "waveform.axis": axis,
                "waveform.frequency": 1.7,
                "waveform.phase": 0.3,
                "sample.period": period,
                "feedback.slider_u": 2.0,
                "feedback.pendulum_angle": -3.0,
                "feedback.parabola_vx": 0.7,
                "limit.acceleration": 2.5,
            },
        )
        for kind in ("sine", "chirp", "step")
        for axis in ("x", "y", "coefficient")
        for period in (0.0, 0.07)
    },
}


def test_one_is_compiled_and_the_other_is_not(extracted, interpreted) -> None:
    for name, fmu in extracted.items():
        assert list((fmu.folder / "resources").rglob("*.so"))
        assert not list((interpreted[name].folder / "resources").rglob("*.so"))
        # the same content: states go from one to the other
        assert fmu.guid == interpreted[name].guid


@pytest.mark.parametrize("label", CASES)
def test_same_bits(
    extracted: dict[str, Extracted], interpreted: dict[str, Extracted], label: str
) -> None:
    name, parameters = CASES[label]
    is_constant = label == "linear-exact"
    draw = random.Random(label)
    outputs = [n for n in extracted[name].outputs if not n.startswith("solver.")]
    with Instance(extracted[name]) as one, Instance(interpreted[name]) as other:
        for instance in (one, other):
            instance.start(parameters)
        assert one.bits() == other.bits()
        for i in range(50):
            inputs = inputs_at(name, one.time, constant=is_constant)
            size = 0.01 if i % 3 else 0.005 * draw.random()
            for instance in (one, other):
                instance.set(inputs)
                if name != "ParabolaDrive" and i % 2:
                    instance.slope(slopes_at(name, instance.time, constant=is_constant))
            if i % 5 == 0:
                assert one.rates(*outputs) == other.rates(*outputs), i
            for instance in (one, other):
                instance.step(size)
            if i % 5 == 0:
                assert one.bits() == other.bits(), i
        assert one.bits() == other.bits()
        assert one.messages == [m for m in other.messages if "runs interpreted" not in m[1]]
        assert one.inner_state() == other.inner_state()

"""The variables of the three FMUs as they are promised to their users, typed by hand.

Nothing here is read from the sources: it is the other side of the comparison.
"""

from __future__ import annotations

from typing import NamedTuple

FINITE = "finite"
POSITIVE = "positive"
NOT_NEGATIVE = "not negative"

ENUMERATIONS = {
    "SolverMethod": (
        "explicit_euler",
        "semi_implicit_euler",
        "rk4",
        "adaptive",
        "implicit",
        "exact",
    ),
    "Formulation": ("lagrange_multiplier", "angle"),
    "Stabilization": ("none", "baumgarte", "projection"),
    "Fidelity": ("linear", "nonlinear"),
    "Waveform": ("none", "sine", "chirp", "step"),
    "Axis": ("x", "y", "coefficient"),
}

#: unit -> exponents of the SI base units
UNITS = {
    "1": {},
    "m": {"m": 1},
    "m/s": {"m": 1, "s": -1},
    "m/s2": {"m": 1, "s": -2},
    "rad": {"rad": 1},
    "rad/s": {"rad": 1, "s": -1},
    "s": {"s": 1},
    "Hz": {"s": -1},
    "kg": {"kg": 1},
    "N": {"kg": 1, "m": 1, "s": -2},
    "N/m": {"kg": 1, "s": -2},
    "N.s/m": {"kg": 1, "s": -1},
    "N.m.s/rad": {"kg": 1, "m": 2, "s": -1, "rad": -1},
    "J": {"kg": 1, "m": 2, "s": -2},
    "1/s": {"s": -1},
    "1/s2": {"s": -2},
    "1/m": {"m": -1},
    "1/(m.s)": {"m": -1, "s": -1},
    "1/(m.s2)": {"m": -1, "s": -2},
    "m/(s2.rad)": {"m": 1, "s": -2, "rad": -1},
    "m/(s.rad)": {"m": 1, "s": -1, "rad": -1},
}


#: what adaptive macro steps measure errors by, and tools scale plots with
NOMINALS = {
    **dict.fromkeys(("energy.kinetic", "energy.potential", "energy.total", "energy.residual"), 1.0),
    **dict.fromkeys(("gravity.x", "gravity.y", "wire.ax", "wire.ay"), 10.0),
    **dict.fromkeys(("parabola.ax", "parabola.ay", "limit.acceleration"), 10.0),
    **dict.fromkeys(("bead.fx", "bead.fy", "slider.fx", "slider.fy"), 10.0),
    **dict.fromkeys(("pendulum.fx", "pendulum.fy", "constraint.damping"), 10.0),
    "constraint.stiffness": 100.0,
    "constraint.drift": 1e-6,
    "solver.step": 1e-3,
    "solver.tolerance": 1e-6,
    "sample.period": 0.01,
}


class Row(NamedTuple):
    """A variable: `type` is Real, Integer or the name of an enumeration."""

    name: str
    causality: str
    type: str
    unit: str | None
    #: number, or name of the item
    default: float | str | None
    domain: str = FINITE
    tunable: bool = False


def _parameter(name: str, unit: str, default: float, domain: str = FINITE) -> Row:
    return Row(name, "parameter", "Real", unit, default, domain)


def _tunable(name: str, unit: str, default: float, domain: str = FINITE) -> Row:
    return Row(name, "parameter", "Real", unit, default, domain, True)


def _choice(name: str, enumeration: str, default: str, tunable: bool = False) -> Row:
    return Row(name, "parameter", enumeration, None, default, tunable=tunable)


def _inputs(unit: str, *names: str) -> tuple[Row, ...]:
    return tuple(Row(name, "input", "Real", unit, 0.0) for name in names)


def _outputs(unit: str, *names: str) -> tuple[Row, ...]:
    return tuple(Row(name, "output", "Real", unit, None) for name in names)


_PLANT = (
    _parameter("gravity.x", "m/s2", 0.0),
    _parameter("gravity.y", "m/s2", -9.81),
    _choice("solver.method", "SolverMethod", "rk4"),
    _parameter("solver.step", "s", 1e-3, POSITIVE),
    _parameter("solver.tolerance", "1", 1e-6, POSITIVE),
    Row("solver.max_steps", "parameter", "Integer", None, 1000000, POSITIVE),
    Row("solver.steps", "output", "Real", "1", None),
    Row("solver.evaluations", "output", "Real", "1", None),
    *_outputs("J", "energy.kinetic", "energy.potential", "energy.total", "energy.residual"),
)

INTERFACE: dict[str, tuple[Row, ...]] = {
    "BeadOnWire": (
        *_PLANT,
        _parameter("wire.radius", "m", 1.0, POSITIVE),
        _parameter("bead.mass", "kg", 1.0, POSITIVE),
        _parameter("bead.damping", "N.s/m", 0.0, NOT_NEGATIVE),
        _parameter("bead.angle_start", "rad", 1.5707963267948966),
        _parameter("bead.angular_velocity_start", "rad/s", 0.0),
        _choice("model.formulation", "Formulation", "lagrange_multiplier"),
        _choice("constraint.stabilization", "Stabilization", "projection"),
        _parameter("constraint.stiffness", "1/s2", 100.0, NOT_NEGATIVE),
        _parameter("constraint.damping", "1/s", 20.0, NOT_NEGATIVE),
        *_inputs("m/s2", "wire.ax", "wire.ay"),
        *_inputs("N", "bead.fx", "bead.fy"),
        *_outputs("m", "bead.x", "bead.y", "wire.x", "wire.y", "constraint.drift"),
        *_outputs("m/s", "bead.vx", "bead.vy", "wire.vx", "wire.vy"),
        *_outputs("rad", "bead.angle"),
        *_outputs("rad/s", "bead.angular_velocity"),
        *_outputs("N", "wire.fx", "wire.fy", "constraint.force"),
        *_outputs("N/m", "constraint.multiplier"),
    ),
    "ParabolaPendulum": (
        *_PLANT,
        _parameter("parabola.coefficient_start", "1/m", 0.5),
        _parameter("parabola.coefficient_rate_start", "1/(m.s)", 0.0),
        _parameter("slider.mass", "kg", 1.0, POSITIVE),
        _parameter("pendulum.mass", "kg", 1.0, POSITIVE),
        _parameter("pendulum.length", "m", 1.0, POSITIVE),
        _parameter("slider.damping", "N.s/m", 0.0, NOT_NEGATIVE),
        _parameter("pendulum.damping", "N.m.s/rad", 0.0, NOT_NEGATIVE),
        _parameter("slider.u_start", "m", 0.5),
        _parameter("slider.u_rate_start", "m/s", 0.0),
        _parameter("pendulum.angle_start", "rad", 0.5),
        _parameter("pendulum.angular_velocity_start", "rad/s", 0.0),
        _choice("model.fidelity", "Fidelity", "nonlinear"),
        *_inputs("m/s2", "parabola.ax", "parabola.ay"),
        *_inputs("1/(m.s2)", "parabola.coefficient_acceleration"),
        *_inputs("N", "slider.fx", "slider.fy", "pendulum.fx", "pendulum.fy"),
        *_outputs("m", "slider.u", "slider.x", "slider.y", "pendulum.x", "pendulum.y"),
        *_outputs("m", "parabola.x", "parabola.y"),
        *_outputs("m/s", "slider.u_rate", "slider.vx", "slider.vy"),
        *_outputs("m/s", "pendulum.vx", "pendulum.vy", "parabola.vx", "parabola.vy"),
        *_outputs("rad", "pendulum.angle"),
        *_outputs("rad/s", "pendulum.angular_velocity"),
        *_outputs("1/m", "parabola.coefficient"),
        *_outputs("1/(m.s)", "parabola.coefficient_rate"),
        *_outputs("N", "constraint.normal_force", "pendulum.tension"),
        *_outputs("N", "parabola.fx", "parabola.fy"),
        *_outputs("1", "model.acceleration_error"),
    ),
    "ParabolaDrive": (
        *_inputs("m", "slider.u", "parabola.x"),
        *_inputs("m/s", "slider.u_rate", "parabola.vx"),
        *_inputs("rad", "pendulum.angle"),
        *_inputs("rad/s", "pendulum.angular_velocity"),
        # each gain times its measurement is an acceleration
        _tunable("feedback.slider_u", "1/s2", 0.0),
        _tunable("feedback.slider_u_rate", "1/s", 0.0),
        _tunable("feedback.pendulum_angle", "m/(s2.rad)", 0.0),
        _tunable("feedback.pendulum_angular_velocity", "m/(s.rad)", 0.0),
        _tunable("feedback.parabola_x", "1/s2", 0.0),
        _tunable("feedback.parabola_vx", "1/s", 0.0),
        _tunable("reference.pendulum_angle", "rad", 0.0),
        _tunable("reference.parabola_x", "m", 0.0),
        _choice("waveform.kind", "Waveform", "none", True),
        _choice("waveform.axis", "Axis", "x", True),
        _tunable("waveform.amplitude", "m/s2", 1.0),
        _tunable("waveform.frequency", "Hz", 1.0),
        _tunable("waveform.phase", "rad", 0.0),
        _tunable("waveform.start_time", "s", 0.0),
        _tunable("waveform.end_frequency", "Hz", 10.0),
        _tunable("waveform.duration", "s", 10.0, POSITIVE),
        _tunable("limit.acceleration", "m/s2", 1e6, NOT_NEGATIVE),
        _parameter("sample.period", "s", 0.0, NOT_NEGATIVE),
        *_outputs("m/s2", "parabola.ax", "parabola.ay"),
        *_outputs("1/(m.s2)", "parabola.coefficient_acceleration"),
    ),
}


def rows(fmu: str, causality: str) -> list[Row]:
    """The variables of an FMU of one causality."""
    return [row for row in INTERFACE[fmu] if row.causality == causality]

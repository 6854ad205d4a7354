"""ParabolaDrive: the controller that drives the parabola.

A waveform plus state feedback, limited and optionally sampled:
parabola.ax = -K (measurement - reference) + waveform.
"""

from curvebound.fmi.declaration import Enumeration, Fmu, Variable, choice, input_, output, parameter

WAVEFORM = Enumeration(
    "Waveform",
    "shape of the prescribed motion",
    (
        ("none", "no waveform"),
        ("sine", "amplitude sin(2 pi frequency (t - start_time) + phase)"),
        ("chirp", "sine whose frequency goes linearly to end_frequency over duration"),
        ("step", "amplitude from start_time on"),
    ),
)

AXIS = Enumeration(
    "Axis",
    "the output to which the waveform goes",
    (
        ("x", "parabola.ax"),
        ("y", "parabola.ay"),
        ("coefficient", "parabola.coefficient_acceleration"),
    ),
)


def gain(name: str, unit: str, of: str) -> Variable:
    """The feedback gain of the measurement `of`; each gain times its measurement is an acceleration."""
    return parameter(f"feedback.{name}", unit, 0.0, f"feedback gain of {of}", tunable=True)


FMU = Fmu(
    name="ParabolaDrive",
    description="Controller that drives the parabola: waveform plus state feedback",
    variables=(
        gain("slider_u", "1/s2", "slider.u"),
        gain("slider_u_rate", "1/s", "slider.u_rate"),
        gain("pendulum_angle", "m/(s2.rad)", "pendulum.angle"),
        gain("pendulum_angular_velocity", "m/(s.rad)", "pendulum.angular_velocity"),
        gain("parabola_x", "1/s2", "parabola.x"),
        gain("parabola_vx", "1/s", "parabola.vx"),
        parameter(
            "reference.pendulum_angle", "rad", 0.0, "set point of pendulum.angle", tunable=True
        ),
        parameter("reference.parabola_x", "m", 0.0, "set point of parabola.x", tunable=True),
        parameter(
            "waveform.amplitude",
            "m/s2",
            1.0,
            "amplitude of the waveform; 1/(m.s2) where waveform.axis is coefficient",
            tunable=True,
        ),
        parameter(
            "waveform.frequency",
            "Hz",
            1.0,
            "frequency of the sine, initial frequency of the chirp",
            tunable=True,
        ),
        parameter("waveform.phase", "rad", 0.0, "phase at start_time", tunable=True),
        parameter(
            "waveform.start_time", "s", 0.0, "time before which the waveform is zero", tunable=True
        ),
        parameter(
            "waveform.end_frequency", "Hz", 10.0, "final frequency of the chirp", tunable=True
        ),
        parameter(
            "waveform.duration",
            "s",
            10.0,
            "time in which the chirp reaches its final frequency (above zero)",
            above=0.0,
            tunable=True,
        ),
        parameter(
            "limit.acceleration",
            "m/s2",
            1e6,
            "parabola.ax is limited to plus or minus this",
            at_least=0.0,
            nominal=10.0,
            tunable=True,
        ),
        parameter(
            "sample.period",
            "s",
            0.0,
            "0: the outputs follow the inputs directly; otherwise they are computed at each "
            "multiple of the period and held",
            at_least=0.0,
            nominal=0.01,
        ),
        choice("waveform.kind", WAVEFORM, "none", "shape of the waveform", tunable=True),
        choice("waveform.axis", AXIS, "x", "output of the waveform", tunable=True),
        input_("slider.u", "m", "measured abscissa of the slider"),
        input_("slider.u_rate", "m/s", "measured rate of the abscissa"),
        input_("pendulum.angle", "rad", "measured angle of the pendulum"),
        input_("pendulum.angular_velocity", "rad/s", "measured angular velocity of the pendulum"),
        input_("parabola.x", "m", "measured position of the vertex"),
        input_("parabola.vx", "m/s", "measured velocity of the vertex"),
        output("parabola.ax", "m/s2", "acceleration of the vertex to the right", nominal=10.0),
        output("parabola.ay", "m/s2", "acceleration of the vertex upward", nominal=10.0),
        output(
            "parabola.coefficient_acceleration",
            "1/(m.s2)",
            "second time derivative of the coefficient",
        ),
    ),
    reference_inputs={
        "pendulum.angle": (0.5, 0.4),
        "parabola.x": (0.2, 0.3),
        "feedback.pendulum_angle": 10.0,
        "feedback.parabola_x": 2.0,
        "limit.acceleration": 4.0,
    },
    plotted=("parabola.ax",),
)

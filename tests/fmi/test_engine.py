"""The engine in the test's own process: what it takes and refuses, keeps and gives back."""

from __future__ import annotations

import math
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import pytest

from curvebound.fmi import compile
from curvebound.fmi.compile import why_not
from curvebound.fmi.cutting import near
from curvebound.fmi.declaration import OUTPUT
from curvebound.fmi.folder import find
from curvebound.fmi.input_slopes import InputSlopes
from curvebound.fmi.reference import reference_inputs, reference_result
from curvebound.fmi.slave import table_of
from curvebound.fmi.table import ERROR, LARGEST, OVERFLOW, WARNING


def engine(name: str = "BeadOnWire", **values: float) -> Any:
    """An engine with these parameters, by name with __ for the dot."""
    fmu = find(name).fmu()
    made = fmu.system.create(table_of(fmu), "guid")
    for written, value in values.items():
        vr = made.table.by_name[written.replace("__", ".")]
        if made.table.is_real(vr):
            made.set_real([vr], [value])
        else:
            made.set_integer([vr], [int(value)])
    return made


def started(name: str = "BeadOnWire", **values: float) -> Any:
    made = engine(name, **values)
    made.setup_experiment(0.0)
    made.enter_initialization()
    assert made.exit_initialization(), said(made)
    return made


def said(made: Any) -> str:
    """The one message that waits, taken."""
    (message,) = made.queue
    made.queue.clear()
    assert (message.status, message.category) == (ERROR, "logStatusError")
    return str(message.msg)


def at(made: Any, name: str) -> float:
    return float(made.get_real([made.table.by_name[name]])[0])


@pytest.mark.parametrize(
    ("now", "step", "allowed"),
    [
        (1.0, 1e-3, 1.24e-6),  # rounding to microseconds and to single precision
        (1000.0, 0.1, 2.41e-4),
        (0.0, 1.0, 1e-6),
        (1.0, 1e-5, 1e-7),  # but a hundredth of the step
        (1.0, 1000.0, 1e-3),  # a millionth of the step, where that is more
        (1.0, 1e-15, 3.55e-15),  # and what rounding makes of adding up
        (-1.0, 1e-15, 3.55e-15),
    ],
)
def test_what_is_near_enough_to_the_present_time(now: float, step: float, allowed: float) -> None:
    for sign in (1.0, -1.0):
        assert near(now + sign * 0.93 * allowed, now, step)
        assert not near(now + sign * 1.07 * allowed, now, step)


ITEMS = "is no item of its enumeration: choose one of 1 lagrange_multiplier, 2 angle"


@pytest.mark.parametrize(
    ("name", "value", "told"),
    [
        ("bead.mass", 0.0, " kg is outside its domain: set {} to a value above zero"),
        ("bead.damping", -1.0, " N.s/m is outside its domain: set {} to a value not below zero"),
        ("gravity.x", math.inf, " m/s2 is not finite: set {} to a finite number"),
        ("solver.tolerance", -1.0, " is outside its domain: set {} to a value above zero"),
        ("solver.max_steps", 0, " is too small: set it to at least 1"),
        ("model.formulation", 3, f" {ITEMS}"),
        ("model.formulation", 0, f" {ITEMS}"),
    ],
)
def test_parameters_outside_their_domain(name: str, value: float, told: str) -> None:
    made = engine(**{name.replace(".", "__"): value})
    assert not made.enter_initialization()
    assert said(made) == f"{name} = {value!r}" + told.format(name)
    assert made.get_state()[0][0] == 0.0


def test_the_ends_of_domains_are_taken() -> None:
    made = started(bead__damping=0.0, solver__max_steps=1, model__formulation=2)
    assert made.queue == []


@pytest.mark.parametrize("tolerance", [0.0, -1.0, math.inf, math.nan])
def test_a_tolerance_of_the_experiment_has_a_domain_too(tolerance: float) -> None:
    made = engine()
    assert made.setup_experiment(0.0, None, tolerance)
    assert not made.enter_initialization()
    assert "of fmi2SetupExperiment is outside its domain" in said(made)


def test_values_are_found_by_their_type() -> None:
    made = engine()
    by_name, size = made.table.by_name, made.table.size
    method, steps = by_name["solver.method"], by_name["solver.max_steps"]
    assert made.get_real([size]) == [0.0]
    unknown = "is not a variable of type {}: use the value references of modelDescription.xml"
    assert said(made) == f"value reference {size} {unknown.format('Real')}"
    assert made.get_real([-1]) == [0.0]
    assert said(made) == f"value reference 4294967295 {unknown.format('Real')}"
    assert made.get_integer([-2, size][:1]) == [0]
    assert said(made) == f"value reference 4294967294 {unknown.format('Integer')}"
    made.get_real([method])
    assert said(made) == (
        f"value reference {method} is solver.method of type Enumeration, not Real: "
        "use fmi2GetInteger and fmi2SetInteger"
    )
    made.set_real([steps], [1.0])
    assert "is solver.max_steps of type Integer, not Real: use fmi2GetInteger" in said(made)
    made.set_integer([0], [1])
    assert "is gravity.x of type Real, not Integer: use fmi2GetReal and fmi2SetReal" in said(made)
    made.set_integer([size], [1])
    assert f"value reference {size} is not" in said(made)
    made.set_real([size, -1], [1.0, 1.0])
    assert len(made.queue) == 2
    assert made.get_integer([method, steps]) == [3, 1000000]


def test_what_may_be_set_when() -> None:
    made = engine()
    radius, x, push = (made.table.by_name[n] for n in ("wire.radius", "bead.x", "bead.fx"))
    made.set_real([x], [1.0])
    assert said(made) == "bead.x is an output and cannot be set: set an input or a parameter"
    made.set_real([radius, push], [2.0, 3.0])
    made.setup_experiment(0.0)
    made.enter_initialization()
    made.set_real([radius], [4.0])
    assert at(made, "bead.x") == 4.0  # it has started anew
    made.exit_initialization()
    made.set_real([radius, push], [5.0, 6.0])
    assert said(made) == (
        "wire.radius is a fixed parameter and cannot be set in mode stepping: "
        "set it before initialization ends"
    )
    assert made.get_real([radius, push]) == [4.0, 6.0]
    drive = started("ParabolaDrive")
    gain = drive.table.by_name["feedback.slider_u"]
    u = drive.table.by_name["slider.u"]
    drive.set_real([gain, u], [2.0, 3.0])
    assert at(drive, "parabola.ax") == -6.0
    kind = drive.table.by_name["waveform.kind"]
    drive.set_integer([kind], [9])
    assert at(drive, "parabola.ax") == -6.0  # it is refused at the next step
    assert not drive.do_step(0.0, 0.1)
    assert "waveform.kind = 9 is no item of its enumeration" in said(drive)
    drive.set_integer([kind], [1])
    assert drive.do_step(0.0, 0.1)


def test_calls_out_of_order() -> None:
    made = engine()
    refused = "is not allowed in mode {}: call it {}, or fmi2Reset first"
    stepping = refused.format("instantiated", "between initialization and termination")
    assert not made.do_step(0.0, 0.1)
    assert said(made) == f"fmi2DoStep {stepping}"
    assert not made.exit_initialization()
    assert said(made).startswith("fmi2ExitInitializationMode is not allowed in mode instantiated")
    assert not made.terminate()
    assert said(made).startswith("fmi2Terminate is not allowed in mode instantiated")
    assert made.enter_initialization()
    assert not made.enter_initialization()
    assert said(made).startswith("fmi2EnterInitializationMode is not allowed in mode initializ")
    assert not made.setup_experiment(0.0)
    assert said(made).startswith("fmi2SetupExperiment is not allowed in mode initialization")
    assert made.exit_initialization()
    assert made.terminate()
    assert not made.do_step(0.0, 0.1)
    assert "fmi2DoStep is not allowed in mode terminated" in said(made)
    assert at(made, "bead.x") == 1.0
    made.reset()
    assert not made.setup_experiment(math.nan)
    assert said(made) == "startTime = nan s is not finite: give a finite start time"


def test_steps_that_cannot_be() -> None:
    made = started()
    for step in (0.0, -0.1, math.nan, math.inf, 1.1e150):
        assert not made.do_step(0.0, step)
        assert said(made) == (
            f"communicationStepSize = {step!r} s cannot be used: give a finite step size above zero"
        )
    assert not made.do_step(0.05, 0.1)
    assert said(made).startswith("currentCommunicationPoint = 0.05 s is not the present time 0.0 s")
    assert made.do_step(0.0, 0.1)
    assert made.time == 0.1
    assert made.do_step(0.1 + 1e-7, 0.1)
    assert made.time == 0.2 + 1e-7
    assert not made.do_step(made.time, 1e-20)
    assert "communicationStepSize = 1e-20 s vanishes beside the present time" in said(made)
    assert made.time == 0.2 + 1e-7


def test_inputs_are_finite_and_small_enough_to_be_squared() -> None:
    made = started()
    push = made.table.by_name["bead.fy"]
    for value, taken in ((1.01e150, False), (-math.inf, False), (math.nan, False), (0.0, True)):
        made.set_real([push], [value])
        assert made.do_step(made.time, 0.01) is taken
        if not taken:
            assert said(made) == (
                f"bead.fy = {value!r} N cannot be used: set input bead.fy to a finite number, "
                f"at most {LARGEST!r} in size"
            )


def test_inputs_rise_by_their_slopes_over_one_step() -> None:
    """A constant force and one that rises do the work of their integral on a bead at rest."""
    made = started(gravity__y=0.0, model__formulation=2, bead__angle_start=0.0)
    push = made.table.by_name["bead.fx"]
    slot = push - made.first_input
    made.set_real([push], [1e-6])
    made.slopes.each[slot], made.slopes.given = 4e-6, True
    assert made.do_step(0.0, 0.5)
    assert made.get_real([push]) == [3e-6]
    assert (made.slopes.each[slot], made.slopes.given) == (0.0, False)
    # impulse: 1e-6 * 0.5 + 4e-6 * 0.5^2 / 2
    assert at(made, "bead.vx") == pytest.approx(1e-6, rel=1e-9)
    assert made.do_step(0.5, 0.5)
    assert made.get_real([push]) == [3e-6]
    assert at(made, "bead.vx") == pytest.approx(2.5e-6, rel=1e-9)
    made.slopes.each[slot], made.slopes.given = 2.1e150, True
    assert not made.do_step(1.0, 0.5)
    assert "bead.fx = 3e-06 N cannot be used with its derivative 2.1e+150 per s" in said(made)


def test_an_interrupt_leaves_no_step(monkeypatch: pytest.MonkeyPatch) -> None:
    made = started()
    push = made.table.by_name["bead.fx"]
    slot = push - made.first_input
    made.set_real([push], [1.0])
    made.slopes.each[slot], made.slopes.given = 2.0, True
    before = made.get_state()

    def interrupt(at_end: bool) -> None:
        raise KeyboardInterrupt

    monkeypatch.setattr(made, "look", interrupt)
    with pytest.raises(KeyboardInterrupt):
        made.do_step(0.0, 0.1)
    assert made.get_state() == before
    assert (made.slopes.given, made.get_real([push])) == (True, [1.0])
    monkeypatch.undo()
    assert made.do_step(0.0, 0.1)
    assert made.get_real([push]) == [1.2]
    again = started()
    again.set_real([push], [1.0])
    again.slopes.each[slot], again.slopes.given = 2.0, True
    assert again.do_step(0.0, 0.1)
    assert made.get_state() == again.get_state()


def test_an_interrupt_after_the_slopes_were_used_gives_them_back() -> None:
    slopes = InputSlopes(engine().table)
    reals = [float(vr) for vr in range(64)]
    slopes.take(slopes.first + 1, 2.0)
    slopes.take(slopes.first + 2, 0.0)
    assert slopes.begin(reals, 0.5) == -1
    slopes.end(reals, 0.5)
    assert (slopes.given, slopes.get_state()) == (False, [0.0] * 4)
    assert reals[slopes.first : slopes.first + 3] == [
        slopes.first, slopes.first + 2.0, slopes.first + 2.0
    ]  # fmt: skip
    slopes.restore(reals)
    assert (slopes.given, slopes.get_state()) == (True, [0.0, 2.0, 0.0, 0.0])
    assert reals == [float(vr) for vr in range(64)]


def test_a_directional_derivative_that_fits_no_float_is_said(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    made = started()
    force, x = made.table.by_name["bead.fx"], made.table.by_name["bead.x"]
    monkeypatch.setattr(made, "output_changes", lambda seeds: [math.inf] * 64)
    assert made.get_directional_derivative([x], [force], [1.0]) == [0.0]
    assert said(made) == (
        "the directional derivative of bead.x does not fit a floating-point number at time 0.0 s: "
        "rescale the parameters"
    )


def test_a_state_brings_back_all_of_it() -> None:
    made = engine(bead__mass=2.0)
    made.setup_experiment(1.0, 5.0, 1e-9)
    made.enter_initialization()
    made.exit_initialization()
    assert made.tolerance_name() == "tolerance (fmi2SetupExperiment)"
    push = made.table.by_name["bead.fx"]
    made.set_real([push], [3.0])
    made.do_step(1.0, 0.5)
    saved = made.get_state()
    assert saved[0] == [2.0, 1.5, 1.0, 1e-9, 0.0]
    assert saved[1][3] == 2.0
    values = made.get_real(list(range(19, 40)))
    made.set_real([push], [-3.0])
    made.do_step(1.5, 0.5)
    later = made.get_state()
    assert later != saved
    for other in (made, started(), engine()):
        other.set_state(saved)
        assert other.get_state() == saved
        assert other.get_real(list(range(19, 40))) == values
        other.set_real([push], [-3.0])
        assert other.do_step(1.5, 0.5)
        assert other.get_state() == later
    fresh = engine().get_state()
    made.set_state(fresh)
    assert made.mode == 0
    assert made.get_state() == fresh


@pytest.mark.parametrize(
    ("name", "parameter"),
    [("BeadOnWire", "wire.radius"), ("ParabolaPendulum", "pendulum.length"), ("ParabolaDrive", "")],
)
def test_a_state_without_a_system_can_be_saved_again(name: str, parameter: str) -> None:
    """Of parameters that were set while initializing and make no start, in a new instance."""
    one, other = engine(name), engine(name)
    assert one.enter_initialization()
    parameter = parameter or next(
        v.name for v in find(name).fmu().variables if v.minimum == 0.0 and not v.tunable
    )
    one.set_real([one.table.by_name[parameter]], [-1.0])
    other.set_state(one.get_state())
    again = other.get_state()
    other.set_state(again)
    assert other.get_state() == again
    assert not other.exit_initialization()
    assert f"{parameter} = -1.0" in said(other)


@pytest.mark.parametrize(("value", "shown"), [(-math.inf, -OVERFLOW), (math.nan, OVERFLOW)])
def test_an_output_that_fits_no_float_is_said_and_stays_a_number(
    monkeypatch: pytest.MonkeyPatch, value: float, shown: float
) -> None:
    made = started()
    made.do_step(0.0, 0.25)
    vr = made.table.by_name["bead.x"]
    members = made.layout.members[made.layout.groups[vr]]
    assert members[0] == vr

    def observe(group: int) -> None:
        for member in members:
            made.reals[member] = value if member == vr else 1.0

    monkeypatch.setattr(made, "observe", observe)
    made.fresh = 0
    assert made.get_real(members[:2]) == [shown, 1.0]
    assert said(made) == (
        "bead.x does not fit a floating-point number at time 0.25 s: "
        "rescale the parameters, or reduce solver.step"
    )
    assert made.get_real([vr]) == [shown]
    assert made.queue == []

    def fail(group: int) -> None:
        raise ZeroDivisionError

    monkeypatch.setattr(made, "observe", fail)
    made.fresh = 0
    assert made.get_real(members[:2]) == [OVERFLOW, 1.0]
    assert "bead.x does not fit" in said(made)


def test_looks_are_taken_while_stepping_and_at_the_end() -> None:
    """Of a bead that drifts off its wire: looked at when a look is due, and once it ends."""
    made = started(constraint__stabilization=1, solver__method=1, solver__step=0.01)
    made.do_step(0.0, 0.01)
    assert made.queue == []
    for k in range(1, 30):
        made.do_step(k / 100, 0.01)
    texts = [message.msg for message in made.queue]
    assert [message.status for message in made.queue] == [WARNING] * 2
    assert sum("constraint.drift" in text for text in texts) == 1
    assert sum("energy.residual" in text for text in texts) == 1
    assert made.terminate()
    assert len(made.queue) == 2


@pytest.mark.parametrize(
    ("stop", "time", "method", "advice"),
    [
        (11.0, 3.0, 3, (5.0, 4, "solver.step", 1e-3)),  # five times as large at the end
        (11.0, 12.0, 3, (1.0, 4, "solver.step", 1e-3)),
        (11.0, 1.0, 3, (3.0, 4, "solver.step", 1e-3)),
        (None, 3.0, 3, (3.0, 4, "solver.step", 1e-3)),
        (None, 3.0, 1, (3.0, 1, "solver.step", 1e-3)),
        (11.0, 3.0, 4, (5.0, 1, "solver.tolerance", 1e-6)),
    ],
)
def test_the_advice_about_energy(
    monkeypatch: pytest.MonkeyPatch, stop: float | None, time: float, method: int, advice: Any
) -> None:
    made = engine(solver__method=method)
    made.setup_experiment(1.0, stop)
    made.enter_initialization()
    made.exit_initialization()
    told: list[Any] = []
    monkeypatch.setattr(made.watch, "energy", lambda *given: told.append(given) or "so")
    values = {"energy.kinetic": 2.0, "energy.potential": made.model.initial_potential - 3.0}
    monkeypatch.setattr(made, "output", lambda name: values[name])
    monkeypatch.setattr(made, "swing", lambda: 7.0)
    made.time = time
    # what moves is the larger of kinetic energy and change of the other; a swing, where in doubt
    values["energy.residual"] = -0.029
    made.look_at_energy()
    assert (made.watch.moved, told) == (3.0, [])
    values["energy.residual"] = -0.069
    made.look_at_energy()
    assert (made.watch.moved, told, made.queue) == (7.0, [], [])
    values["energy.residual"] = -0.071
    made.look_at_energy()
    growth, order, setting, value = advice
    assert told == [(-0.071, growth, order, setting, value, time)]
    assert [(message.status, message.msg) for message in made.queue] == [(WARNING, "so")]


@pytest.mark.parametrize(("angle", "damping"), [(1.0, 0.0), (-2.0, 0.0), (1.0, 0.5)])
def test_a_swing_is_what_the_forces_would_give_until_they_change(
    angle: float, damping: float
) -> None:
    """Of an angle: they act for 1 / sqrt(slope + acceleration), less what damping takes away."""
    mass, g = 2.0, 9.81
    made = started(model__formulation=2, bead__angle_start=angle, bead__damping=damping,
                   bead__mass=mass, bead__angular_velocity_start=3.0)  # fmt: skip
    force = g * abs(math.sin(angle))
    rate = math.sqrt(g * abs(math.cos(angle)) + force) + damping / mass
    assert made.swing() == pytest.approx(0.5 * mass * (force / rate) ** 2, rel=1e-9)
    assert (made.model.v0, made.model.v1) == (3.0, 0.0)
    assert started(gravity__y=0.0, model__formulation=2).swing() == 0.0


def test_failed_steps_tell_what_would_do() -> None:
    made = started(solver__max_steps=10)
    assert not made.do_step(0.0, 0.14)
    assert said(made) == (
        "solver.max_steps = 10 internal steps do not reach the end at time 0.0 s in a "
        "communication step of 0.14 s, but 0.01 s of it; the step size reached is 0.001 s: raise "
        "solver.max_steps (to 2e+02) or solver.step, or shorten the communication step"
    )
    assert made.do_step(0.0, 0.01)
    assert at(made, "solver.steps") == 10.0
    assert at(made, "solver.evaluations") == 40.0
    assert not made.do_step(0.01, 1e9)
    assert "raise solver.max_steps or solver.step, or shorten" in said(made)
    adaptive = started(solver__method=4, solver__max_steps=2)
    before = adaptive.get_state()
    assert not adaptive.do_step(0.0, 100.0)
    text = said(adaptive)
    assert "raise solver.max_steps (to " in text
    assert ") or solver.tolerance, or shorten" in text
    reached = float(text.partition("but ")[2].split()[0])
    advised = float(text.partition("(to ")[2].partition(")")[0])
    assert advised == pytest.approx(1.5 * 2 * 100.0 / reached, rel=0.5)
    assert adaptive.get_state() == before
    fast = started(model__formulation=2, solver__step=1.0)
    fast.set_real([fast.table.by_name["bead.fx"]], [1e149])
    before = fast.get_state()
    assert not fast.do_step(0.0, 1.0)
    text = said(fast)
    assert text.startswith("the state left the finite numbers at time 0.0 s in a communication")
    assert "with internal steps of 1.0 s" in text
    assert text.endswith("reduce solver.step, or choose solver.method = adaptive")
    assert fast.get_state() == before


def test_a_linear_model_beyond_its_range_is_told_at_once_and_once() -> None:
    made = started("ParabolaPendulum", model__fidelity=1, pendulum__angle_start=1.5)
    (message,) = made.queue
    assert (message.status, message.category) == (WARNING, "logStatusWarning")
    assert "model.acceleration_error" in message.msg
    for k in range(10):
        made.do_step(k / 100, 0.01)
    assert len(made.queue) == 1


@pytest.mark.parametrize(("doubt", "loss", "count"), [(0, 0, 0), (2e-6, 0, 1), (0, 2e-6, 1)])
def test_what_rounding_and_growing_errors_make_of_the_tolerance_is_told(
    monkeypatch: pytest.MonkeyPatch, doubt: float, loss: float, count: int
) -> None:
    made = started(solver__method=4)
    monkeypatch.setattr(made.method, "doubt", lambda: doubt)
    monkeypatch.setattr(made.method, "loss", lambda: loss)
    for k in range(3):
        made.do_step(k / 10, 0.1)
    assert [message.status for message in made.queue] == [WARNING] * count
    assert all("solver.tolerance = 1e-06" in message.msg for message in made.queue)
    assert all("magnifies" in message.msg for message in made.queue)


def test_inputs_of_a_reference_experiment() -> None:
    """A number stays, a sine is one, and an item is its number."""
    given = {"waveform.kind": "step", "waveform.axis": "y", "slider.u": (2.0, 0.25),
             "slider.u_rate": 3.0}  # fmt: skip
    fmu = find("ParabolaDrive").fmu()
    made: Any = SimpleNamespace(name="Drive", reference_inputs=given, variables=fmu.variables)
    assert reference_inputs(made, 1.0) == {
        "waveform.kind": 4.0, "waveform.axis": 2.0, "slider.u": 2.0, "slider.u_rate": 3.0
    }  # fmt: skip
    assert reference_inputs(made, 3.0)["slider.u"] == pytest.approx(-2.0)
    given["slider.u"] = "step"
    with pytest.raises(RuntimeError, match=r"slider\.u is no enumeration, and cannot be step"):
        reference_inputs(made, 0.0)


def test_what_a_reference_experiment_gives() -> None:
    """All outputs at all communication points, by the exact settings or by the FMU's own."""
    fmu = find("BeadOnWire").fmu()
    fmu = fmu._replace(stop_time=5 * fmu.step_size)
    usual, exact = (reference_result(fmu, exact=exact) for exact in (False, True))
    times = [k * fmu.step_size for k in range(6)]
    for found in (usual, exact):
        assert found.time == found.outputs["time"] == found.inputs["time"] == times
        assert {len(column) for column in found.outputs.values()} == {6}
        assert set(found.outputs) == {"time", *(v.name for v in fmu.variables if v.kind == OUTPUT)}
    energies = [abs(x) for x in exact.outputs["energy.residual"]]
    assert max(energies) < 1e-13
    assert exact.outputs["bead.y"] == pytest.approx(usual.outputs["bead.y"], abs=1e-9)
    assert exact.outputs["bead.y"] != usual.outputs["bead.y"]


def test_why_nothing_can_be_compiled(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    for name in ("compiled_directory", "compiler_for", "cython_version", "headers"):
        monkeypatch.setattr(compile, name, lambda *_: tmp_path)
    assert why_not(target="linux64") == ""
    for name, told in (
        ("headers", "no Python.h"),
        ("cython_version", "no Cython, which curvebound[compiler] brings"),
        ("compiler_for", "no C compiler for win64"),
    ):
        monkeypatch.setattr(compile, name, lambda *_: None)
        assert why_not(target="win64") == told
    assert why_not() == "no C compiler found"
    assert why_not(target="") == f"this is none of {', '.join(compile.PLATFORMS)}"
    # unless it comes with the package: the core, and the system
    core = compile.runtime()
    bead = compile.system_sources(find("BeadOnWire"), core)
    for unit, told in ((core, "no C compiler found"), (bead, "")):
        (tmp_path / f"{unit.extension}{compile.SUFFIXES[compile.HERE]}").write_bytes(b"")
        assert why_not() == ""
        assert why_not(bead) == told

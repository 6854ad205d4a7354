"""Rates of outputs: what is found when they are asked for, and after what it is found anew."""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import Any

import pytest
from driven import inputs_at, slopes_at
from harness import Instance

from curvebound.fmi.folder import find
from curvebound.fmi.slave import table_of

#: outputs of the pendulum by group, the rates of which are no outputs themselves
RATES = {0: "slider.u_rate", 1: "pendulum.vx", 2: "parabola.vx", 3: "energy.total"}


class Watched:
    """An engine of the pendulum in the test's own process; `seen` has what its model is asked."""

    def __init__(self) -> None:
        fmu = find("ParabolaPendulum").fmu()
        assert fmu.system is not None
        self.engine: Any = fmu.system.create(table_of(fmu), "guid")
        self.seen: list[object] = []
        self.start()

    def start(self) -> None:
        engine = self.engine
        engine.setup_experiment(0.0)
        engine.enter_initialization()
        assert engine.exit_initialization()
        engine.get_real(range(engine.table.first_output, engine.table.size))
        model, observe, jacobian = engine.model, engine.model.observe, engine.model.jacobian
        model.observe = lambda *given: (self.seen.append(given[0]), observe(*given))
        model.jacobian = lambda *given: (self.seen.append("jacobian"), jacobian(*given))

    def vr(self, name: str) -> int:
        return int(self.engine.table.by_name[name])

    def rates(self, *names: str) -> list[float]:
        vrs = [self.vr(name) for name in names]
        return list(self.engine.get_real_output_derivatives(vrs, [1] * len(vrs)))

    def asked(self, *names: str) -> list[object]:
        """What asking for these makes the model do."""
        self.seen.clear()
        self.rates(*names)
        return list(self.seen)

    def slope(self, value: float) -> None:
        self.engine.set_real_input_derivatives([self.vr("parabola.ax")], [1], [value])

    def said(self) -> str:
        """The one message that waits, taken."""
        (message,) = self.engine.queue
        self.engine.queue.clear()
        return str(message.msg)


def test_groups_that_are_asked_for_are_found_once() -> None:
    watched = Watched()
    assert watched.asked("slider.u", "pendulum.angle", "parabola.x") == []  # outputs themselves
    assert watched.asked("slider.u_rate", "pendulum.angular_velocity") == ["jacobian", 0, 0]
    assert watched.asked("pendulum.angular_velocity", "parabola.vx") == [2, 2]
    assert watched.asked(*RATES.values()) == [1, 1, 3, 3]
    assert watched.asked(*RATES.values()) == []


@pytest.mark.parametrize(
    "change",
    [
        lambda w: w.engine.set_real([w.vr("parabola.ax")], [1.0]),
        lambda w: w.slope(1.0),
        lambda w: w.engine.do_step(0.0, 0.01),
        lambda w: w.engine.set_state(w.engine.get_state()),
    ],
    ids=["input", "slope", "step", "state"],
)
def test_a_change_makes_them_found_anew(change: Callable[[Watched], object]) -> None:
    watched = Watched()
    watched.rates(*RATES.values())
    change(watched)
    watched.engine.get_real([watched.vr("slider.u")])
    assert watched.asked(RATES[2], RATES[0]) == ["jacobian", 2, 2, 0, 0]


def test_a_reset_leaves_none() -> None:
    watched = Watched()
    watched.engine.set_real([watched.vr("parabola.ax")], [1.0])
    assert watched.rates("parabola.vx")[0] == pytest.approx(1.0, abs=1e-9)
    watched.engine.reset()
    assert watched.rates("parabola.vx") == [0.0]
    watched.start()
    assert watched.asked("parabola.vx") == ["jacobian", 2, 2]
    assert watched.rates("parabola.vx") == [0.0]


def test_what_cannot_be_found_is_told_of_its_group_alone() -> None:
    watched = Watched()
    expected = watched.rates(*RATES.values())
    before = watched.engine.get_state()
    for slope in (math.nan, math.inf):
        watched.slope(slope)
        for _ in range(2):
            assert watched.rates("parabola.vx") == [0.0]
            assert watched.said().startswith("the derivative of parabola.vx does not fit a float")
    watched.slope(0.0)
    assert watched.rates(*RATES.values()) == expected
    observe = watched.engine.model.observe

    def failing(group: int, values: list[float], first: int) -> None:
        observe(group, values, first)
        if group == 2:
            raise ZeroDivisionError

    watched.engine.model.observe = failing
    watched.slope(0.0)
    for _ in range(2):
        assert watched.rates(*RATES.values()) == [*expected[:2], 0.0, expected[3]]
        assert watched.said().startswith("the derivative of parabola.vx does not fit a float")
    assert watched.engine.get_state() == before


def test_an_interrupt_leaves_the_model_as_it_was() -> None:
    watched = Watched()
    watched.slope(3.0)
    expected = watched.rates(*RATES.values())
    before = watched.engine.get_state(), list(watched.engine.model.inputs)
    observe = watched.engine.model.observe

    def interrupted(*given: object) -> None:
        raise KeyboardInterrupt

    watched.engine.model.observe = interrupted
    watched.slope(3.0)
    with pytest.raises(KeyboardInterrupt):
        watched.rates("slider.u_rate")
    assert (watched.engine.get_state(), list(watched.engine.model.inputs)) == before
    watched.engine.model.observe = observe
    assert watched.rates(*RATES.values()) == expected


def tune(instance: Instance) -> None:
    """Change a tunable parameter, of the drive; the plants have none."""
    if instance.fmu.name == "ParabolaDrive":
        instance.set({"feedback.slider_u": 2.0, "waveform.amplitude": 3.0})


@pytest.mark.parametrize(
    "change",
    [
        lambda i: i.set(inputs_at(i.fmu.name, 0.7)),
        lambda i: i.slope(slopes_at(i.fmu.name, 0.7)),
        lambda i: i.step(0.01),
        lambda i: i.restore(i.saved, 0.0),
        tune,
    ],
    ids=["input", "slope", "step", "state", "parameter"],
)
@pytest.mark.parametrize("name", ["BeadOnWire", "ParabolaPendulum", "ParabolaDrive"])
def test_rates_are_those_of_the_present(
    start: Callable[..., Instance], name: str, change: Callable[[Any], None]
) -> None:
    """In the binary: the same, whether they have been asked for before a change or not."""
    parameters = {"feedback.slider_u": 1.0, "waveform.kind": "sine"}
    found = []
    for before in (True, False):
        instance: Any = start(name, parameters if name == "ParabolaDrive" else {})
        instance.saved = instance.serialized()
        instance.set(inputs_at(name, 0.3))
        instance.step(0.02)
        instance.set(inputs_at(name, 0.4))
        instance.slope(slopes_at(name, 0.4))
        outputs = [n for n in instance.fmu.outputs if not n.startswith("solver.")]
        if before:
            instance.rates(*outputs)
        change(instance)
        found.append(instance.rates(*outputs))
    assert found[0] == found[1]
    assert any(rate != 0.0 for rate in found[0])

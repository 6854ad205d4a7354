"""Stop times, and calls from within the tool's logger."""

from __future__ import annotations

import time
from collections.abc import Callable
from typing import Any

import pytest
from harness import ERROR, OK, Instance

Make = Callable[..., Instance]


@pytest.fixture
def make(instantiate: Make, extracted: dict[str, Any]) -> Make:
    if not extracted["BeadOnWire"].forwarded:
        pytest.skip("without a binary of this project PythonFMU's wrapper decides")
    return instantiate


def begin(instance: Instance, start: float, stop: float | None) -> None:
    instance.slave.setupExperiment(startTime=start, stopTime=stop)
    instance.slave.enterInitializationMode()
    instance.slave.exitInitializationMode()
    instance.time = start


@pytest.mark.parametrize("name", ["BeadOnWire", "ParabolaPendulum", "ParabolaDrive"])
def test_an_experiment_of_no_length_has_its_outputs_and_no_step(make: Make, name: str) -> None:
    instance = make(name)
    begin(instance, 2.0, 2.0)
    assert instance.errors == []
    assert len(instance.reals()) > 0
    assert instance.step_status(2.0, 0.1) == ERROR
    assert "stopTime" in instance.errors[-1]


def test_a_stop_time_before_the_start_is_refused(make: Make) -> None:
    instance = make("BeadOnWire")
    assert instance.status("setupExperiment", None, 2.0, 2.0 - 1e-15) == ERROR
    assert "stopTime" in instance.errors[-1]


@pytest.mark.parametrize(("stop", "step"), [(1.0, 0.1), (1e4, 0.1), (1.0, 1e-4)])
def test_the_last_step_may_miss_the_stop_time_by_rounding_only(
    make: Make, stop: float, step: float
) -> None:
    """By a hundredth of it at most, and no more than rounding times to microseconds, or to single
    precision, makes of them."""
    begun = stop - step
    rounding = min(0.01 * step, 1e-6 + 2.4e-7 * stop)
    for excess, status in ((1.1 * rounding, ERROR), (0.9 * rounding, OK)):
        instance = make("BeadOnWire")
        begin(instance, begun, stop)
        assert instance.step_status(begun, step + excess) == status
        if status == ERROR:
            assert "ends after stopTime" in instance.errors[-1]


def test_reset_forgets_the_stop_time(make: Make) -> None:
    instance = make("BeadOnWire")
    begin(instance, 0.0, 0.5)
    instance.slave.reset()
    begin(instance, 0.0, None)
    assert instance.step_status(0.0, 2.0) == OK
    assert instance.errors == []


class Calling(list[Any]):
    """A list of messages that calls the instance when one comes."""

    def __init__(self, call: Callable[[], int]) -> None:
        super().__init__()
        self.call = call
        self.statuses: list[int] = []

    def append(self, message: Any) -> None:
        super().append(message)
        self.statuses.append(self.call())


@pytest.mark.parametrize("function", ["getReal", "doStep", "terminate", "reset"])
def test_a_call_from_within_the_logger_is_refused_at_once(make: Make, function: str) -> None:
    """It would wait for itself; a saved state goes on as if there had been none."""
    instance = make("BeadOnWire")
    begin(instance, 0.0, None)
    place = instance.fmu.variables["bead.x"].valueReference
    arguments = {"getReal": ([place],), "doStep": (0.0, 0.1)}.get(function, ())
    state = instance.slave.getFMUstate()
    heard = Calling(lambda: instance.status(function, *arguments))
    instance.messages = heard
    began = time.monotonic()
    assert instance.step_status(0.0, -1.0) == ERROR
    assert time.monotonic() - began < 5.0
    assert heard.statuses == [ERROR] * len(heard)
    assert len(heard) >= 1
    instance.messages = []
    instance.slave.setFMUstate(state)
    assert instance.step_status(0.0, 0.1) == OK

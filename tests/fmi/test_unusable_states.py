"""States that were saved while a parameter could not be used."""

from __future__ import annotations

import math

from curvebound.fmi.folder import find
from curvebound.fmi.slave import table_of


def _engine(name: str):
    fmu = find(name).fmu()
    return fmu.system.create(table_of(fmu), "")


def test_a_state_of_initialization_with_an_unusable_parameter_is_restored() -> None:
    """In a new instance too; initialization then cannot end, and says which parameter it is."""
    first = _engine("BeadOnWire")
    radius = first.table.by_name["wire.radius"]
    assert first.enter_initialization()
    first.set_real([radius], [math.nan])
    second = _engine("BeadOnWire")
    second.set_state(first.get_state())
    assert not second.exit_initialization()
    assert "wire.radius" in second.queue[-1].msg
    second.set_real([radius], [2.0])
    assert second.exit_initialization()


def test_a_state_with_an_unusable_tunable_parameter_keeps_the_rest() -> None:
    first = _engine("ParabolaDrive")
    by_name = first.table.by_name
    first.set_real([by_name["sample.period"]], [0.5])
    assert first.enter_initialization()
    assert first.exit_initialization()
    first.set_real([by_name["feedback.slider_u"]], [math.nan])
    second = _engine("ParabolaDrive")
    second.set_state(first.get_state())
    assert not second.do_step(0.0, 0.1)
    assert "feedback.slider_u" in second.queue[-1].msg
    for engine in (first, second):
        engine.set_real([by_name["feedback.slider_u"], by_name["slider.u"]], [-1.0, 1.0])
        assert engine.do_step(0.0, 0.1)
        engine.set_real([by_name["slider.u"]], [7.0])
    held = by_name["parabola.ax"]
    assert first.get_real([held]) == second.get_real([held]) == [1.0]

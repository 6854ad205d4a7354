"""The words and units of the plots are those of the FMUs."""

from __future__ import annotations

import pytest

from curvebound.fmi.build import load_declaration, names
from curvebound.view.quantities import PLOTS, QUANTITIES, READOUTS, quantity


@pytest.mark.parametrize("fmu", names())
def test_units_are_those_that_the_fmus_declare(fmu: str) -> None:
    known = [v for v in load_declaration(fmu).variables if v.name in QUANTITIES]
    assert len(known) > 5
    for variable in known:
        assert (variable.name, quantity(variable.name).unit) == (variable.name, variable.unit)


def test_every_output_has_words_and_a_plot() -> None:
    outputs = {
        v.name for fmu in names() for v in load_declaration(fmu).variables if "output" in v.kind
    }
    plotted = {name for plot in PLOTS for name in plot.names}
    assert outputs <= set(QUANTITIES)
    assert outputs <= plotted


def test_plots_are_of_one_unit_and_named_once() -> None:
    for plot in PLOTS:
        assert len({quantity(name).unit for name in plot.names}) == 1, plot.title
    titles = [plot.title for plot in PLOTS]
    assert len(set(titles)) == len(titles)
    named = [name for plot in PLOTS for name in plot.names]
    assert len(set(named)) == len(named)
    assert set(READOUTS) <= set(QUANTITIES)

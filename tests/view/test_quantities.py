"""Words, units and plots are those of the drawings."""

from __future__ import annotations

import pytest

from curvebound.fmi.drawing import Drawing, Plot
from curvebound.fmi.folder import find, names
from curvebound.view.quantities import Quantity, plots_of, quantity, readouts_of


@pytest.mark.parametrize("fmu", names())
def test_units_are_those_that_the_fmus_declare(fmu: str) -> None:
    drawing = find(fmu).drawing()
    for variable in find(fmu).fmu().variables:
        if variable.type is None:
            assert quantity(variable.name, drawing).unit == variable.unit


@pytest.mark.parametrize("fmu", names())
def test_every_output_has_one_plot_of_one_unit(fmu: str) -> None:
    drawing = find(fmu).drawing()
    plotted = [name for plot in drawing.plots for name in plot.names]
    assert set(drawing.outputs) <= set(plotted)
    assert len(set(plotted)) == len(plotted)
    for plot in drawing.plots:
        assert len({drawing.units[name] for name in plot.names}) == 1, plot.title
    titles = [plot.title for plot in drawing.plots]
    assert len(set(titles)) == len(titles)


def test_plots_of_one_title_are_united_and_keep_both_orders() -> None:
    one = Drawing(plots=tuple(Plot(title, (f"a.{title}",)) for title in "ABDE"))
    two = Drawing(plots=tuple(Plot(title, (f"b.{title}",)) for title in "BCE"))
    united = plots_of([one, two])
    assert [plot.title for plot in united] == ["A", "B", "C", "D", "E"]
    assert united[1].names == ("a.B", "b.B")
    drawings = [Drawing(readouts=("x", "z")), Drawing(readouts=("x", "y", "z"))]
    assert readouts_of(drawings) == ["x", "y", "z"]


def test_an_unknown_variable_names_itself() -> None:
    told = quantity("engine.speed", find("BeadOnWire").drawing())
    assert (told.label, told.unit, told.error) == ("engine.speed", "", False)
    assert quantity("wire.radius", None) == Quantity("wire.radius", "", False, "wire.radius")

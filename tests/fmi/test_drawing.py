"""Drawings as they are declared, checked and carried by FMUs."""

from __future__ import annotations

import zipfile
from pathlib import Path

import numpy as np
import pytest

from curvebound.errors import CurveboundError
from curvebound.fmi.drawing import Circle, Curve, Drawing, Plot, Point, Rod, carried, complete, read
from curvebound.fmi.folder import find, names
from curvebound.fmi.formula import evaluate, parse, variables_of

BEAD = find("BeadOnWire").fmu()


@pytest.mark.parametrize("name", names())
def test_an_fmu_carries_its_drawing(interpreted_fmus: Path, name: str) -> None:
    with zipfile.ZipFile(interpreted_fmus / f"{name}.fmu") as archive:
        assert read(archive.read("resources/drawing.json")) == find(name).drawing()


def test_names_may_have_words_of_python_in_them() -> None:
    tree = parse("wave.lambda * sin(is.x) + class.if_")
    assert variables_of(tree) == {"wave.lambda", "is.x", "class.if_"}
    with pytest.raises(CurveboundError, match="is no formula"):
        parse("bead.x if bead.y else 0")


@pytest.mark.parametrize(
    ("drawing", "said"),
    [
        (Drawing(points=(Point("bead", "bead.x", "bead.z"),)), "names 'bead.z'"),
        (Drawing(points=(Point("bead", "bead.x +", "bead.y"),)), "is no formula"),
        (Drawing(points=(Point("bead", "sum(bead.x)", "bead.y"),)), "'sum(bead.x)'"),
        (Drawing(points=(Point("bead", "first(bead.x)", "bead.y"),)), "'first(bead.x)'"),
        (Drawing(rods=(Rod("frame", "bob"),)), "names 'bob'"),
        (Drawing(circles=(Circle("0", "0", "1", holds="bob"),)), "names 'bob'"),
        (Drawing(curves=(Curve("s", "s**2"),)), "needs a range of s"),
        (Drawing(plots=(Plot("Both", ("bead.x", "bead.vx")),)), "mixes units"),
        (Drawing(plots=(Plot("None", ("bead.z",)),)), "names 'bead.z'"),
        (Drawing(otherwise={"bead.z": ("bead.x",)}), "names 'bead.z'"),
        (Drawing(words={"bead.z": "height"}), "names 'bead.z'"),
        (Drawing(frame=("wire.x", "wire")), "names 'wire'"),
    ],
)
def test_a_mistake_is_told_by_its_name(drawing: Drawing, said: str) -> None:
    with pytest.raises(CurveboundError, match=r"BeadOnWire|formula") as caught:
        complete(drawing, BEAD)
    assert said in str(caught.value)


def test_without_a_drawing_there_are_plots() -> None:
    made = complete(Drawing(), BEAD)
    titles = [plot.title for plot in made.plots if plot.shown]
    assert titles == ["bead angle", "constraint force", "total energy", "energy residual"]
    assert read(carried(made)) == made


def test_a_file_that_is_no_drawing_is_refused() -> None:
    for data in (b"", b"[]", b"{}", b'{"points": [{"place": 1}]}'):
        with pytest.raises(CurveboundError, match="is no drawing"):
            read(data)


def test_formulas_mean_what_python_means() -> None:
    values = {"a.b": np.array([0.5, 2.0]), "c": -1.5}
    for text in ("-a.b**2 + 3 * c / 4", "hypot(a.b, c) - cos(pi * a.b)", "+abs(c) ** a.b"):
        names = {name: getattr(np, name) for name in ("hypot", "cos", "abs", "pi")}
        expected = eval(text.replace("a.b", "ab"), names, {"ab": values["a.b"], "c": -1.5})
        assert np.array_equal(evaluate(parse(text), values), expected)
        assert variables_of(parse(text)) <= set(values)
    gaps = {"x": np.array([np.nan, 3.0, 1.0, np.inf])}
    assert evaluate(parse("first(x)", samples=True), gaps).tolist() == [3.0] * 4
    assert evaluate(parse("median(x)", samples=True), gaps).tolist() == [2.0] * 4

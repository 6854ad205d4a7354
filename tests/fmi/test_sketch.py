"""The sketch in an FMU's documentation and its equations, without a browser."""

from __future__ import annotations

import math
import re
from pathlib import Path
from xml.etree import ElementTree

import pytest

from curvebound.errors import CurveboundError
from curvebound.fmi.drawing import FRAME, Circle, Drawing, Point
from curvebound.fmi.folder import Folder, find, names
from curvebound.fmi.sketch import Angle, Length, Sketch, sketch_of

WIRE = Drawing(
    name="Bead",
    points=(Point("bead", "x", "y"),),
    circles=(Circle("0", "0", "r", holds="bead"),),
    otherwise={"x": ("r * sin(angle)",), "y": ("-r * cos(angle)",)},
    values={"r": 2.0, "gravity.x": 0.0, "gravity.y": -9.81},
)
MARKS = Sketch(
    symbols={"m": "m", "r": "r", "angle": "θ"},
    masses={"bead": "m"},
    lengths=(Length(FRAME, "bead", "r"),),
    angles=(Angle(FRAME, "bead", "angle"),),
    values={"angle": 1.0},
)


def shapes(svg: str, tag: str) -> list[ElementTree.Element]:
    return [one for one in ElementTree.fromstring(svg).iter() if one.tag == tag]


def test_it_stands_where_the_formulas_say() -> None:
    svg = sketch_of(WIRE, MARKS, {})
    wire, bead = shapes(svg, "circle")
    radius = float(wire.get("r", "nan"))
    across = (float(bead.get("cx", "nan")) - float(wire.get("cx", "nan"))) / radius
    down = (float(bead.get("cy", "nan")) - float(wire.get("cy", "nan"))) / radius
    assert across == pytest.approx(math.sin(1.0), abs=1e-3)
    assert down == pytest.approx(math.cos(1.0), abs=1e-3)
    assert {one.text for one in shapes(svg, "text")} == {"x", "y", "m", "r", "θ", "g"}
    assert svg == sketch_of(WIRE, MARKS, {})


def test_formulas_that_lead_in_a_circle_are_passed_over() -> None:
    """r from the bead's place, which needs r: the parameter is what counts."""
    circular = {"r": ("hypot(x, y)", "length"), **WIRE.otherwise}
    drawing = WIRE._replace(otherwise=circular, values={"length": 2.0, "gravity.y": -9.81})
    start = {"x": 0.1, "y": 0.1, "gravity.x": 0.0}
    assert sketch_of(drawing, MARKS, start) == sketch_of(WIRE, MARKS, {})


def test_without_marks_it_shows_the_start() -> None:
    svg = sketch_of(WIRE, Sketch(), {"x": 0.0, "y": 2.0})
    wire, bead = shapes(svg, "circle")
    assert bead.get("cx") == wire.get("cx")
    assert float(bead.get("cy", "nan")) < float(wire.get("cy", "nan"))


def test_plots_alone_have_no_sketch() -> None:
    assert sketch_of(Drawing(name="Law"), Sketch(), {}) == ""


@pytest.mark.parametrize(
    ("written", "said"),
    [
        ('Sketch(symbols={"bead.weight": "m"})', "bead.weight"),
        ('Sketch(masses={"pearl": "bead.mass"})', "pearl"),
        ('Sketch(lengths=(Length("frame", "pearl", "wire.radius"),))', "pearl"),
        ('Sketch(angles=(Angle("frame", "bead", "bead.slope"),))', "bead.slope"),
        ('Sketch(values={"angle": 1.0})', "angle"),
    ],
)
def test_a_mistake_is_told_by_its_name(tmp_path: Path, written: str, said: str) -> None:
    folder = tmp_path / "bead_on_wire"
    folder.mkdir()
    for source in find("BeadOnWire").path.glob("*.py"):
        (folder / source.name).write_bytes(source.read_bytes())
    drawing = (folder / "drawing.py").read_text(encoding="utf-8").split("\nSKETCH")[0]
    (folder / "drawing.py").write_text(f"{drawing}\nSKETCH = {written}\n", encoding="utf-8")
    with pytest.raises(CurveboundError, match=f"{said}.*(did you mean|there is)"):
        Folder(folder).sketch(Folder(folder).drawing())


#: children that an element of MathML has, where their number is fixed
CHILDREN = {"mfrac": 2, "msup": 2, "msub": 2, "mover": 2, "munder": 2, "msubsup": 3, "mroot": 2}


@pytest.mark.parametrize("name", names())
def test_equations_are_well_formed(name: str) -> None:
    text = find(name).documentation()
    found = re.findall(r"(?s)<math.*?</math>", text)
    assert any("display" in one[:30] for one in found)
    assert text.count("<math") == len(found)
    for one in found:
        for element in ElementTree.fromstring(one).iter():
            assert len(element) == CHILDREN.get(element.tag, len(element)), one
            if element.tag in ("mi", "mn", "mo"):
                assert element.text, one
                assert not len(element), one
    assert "<pre>" not in text

"""Drawings of systems that nobody here has seen before: curves, circles and rods by formulas."""

from __future__ import annotations

import math
from pathlib import Path

import numpy as np
import pytest
from browsing import Tab
from motions import table
from test_replay_page import away, middle, show

from curvebound.fmi.drawing import Circle, Curve, Drawing, Point, Rod
from curvebound.view import write_replay

T = np.linspace(0.0, 4.0, 201)
SHAKE = 0.3 * np.sin(2.0 * T)
U = 0.5 * np.cos(1.3 * T)
COLUMNS = {
    "time": T,
    "hill.x": SHAKE,
    "cart.x": SHAKE + U,
    "cart.y": 0.4 * np.sin(3.0 * U),
    "disc.x": SHAKE + U + 0.6 * np.sin(T),
    "disc.y": 0.4 * np.sin(3.0 * U) + 0.6 * np.cos(T),
}
DRAWING = Drawing(
    name="Hill",
    frame=("hill.x", "0"),
    curves=(Curve("hill.x + s", "hill.height * sin(3 * s)", s=(-1.5, 1.5)),),
    circles=(Circle("disc.x", "disc.y", "hill.height / 2"),),
    points=(
        Point("cart", "cart.x", "cart.y", shape="square"),
        Point("disc", "disc.x", "disc.y", shape="round", light=True),
    ),
    rods=(Rod("cart", "disc"),),
    units=dict.fromkeys((*COLUMNS, "hill.height"), "m"),
    outputs=tuple(name for name in COLUMNS if name != "time"),
    values={"hill.height": 0.4},
    known=True,
)


@pytest.fixture
def page(tmp_path: Path) -> Path:
    return write_replay([("hill", table(COLUMNS))], tmp_path / "hill.html", known=[DRAWING])


def test_points_and_curves_are_where_the_formulas_say(tab: Tab, page: Path) -> None:
    tab.open(page)
    tab.run("curvebound.scene.trail = 0")
    for i in (0, 60, 155):
        camera = show(tab, float(T[i]))
        x, y = COLUMNS["cart.x"][i], COLUMNS["cart.y"][i]
        assert away(camera, middle(tab, "actors[0]"), x, y) < 1.5
        x, y = COLUMNS["disc.x"][i], COLUMNS["disc.y"][i]
        assert away(camera, middle(tab, "tints[0]"), x, y) < 1.5
        # the curve is 3 m wide; it and the circle about the disc are 0.4 m and 0.2 m high
        _, _, pixels, left, right, high, low = middle(tab, "curve")
        assert pixels > 500
        assert right - left == pytest.approx(3.0 * camera["scale"], abs=5)
        top = max(0.4, y + 0.2)
        assert camera["bottom"] - camera["scale"] * top == pytest.approx(high, abs=4)
        bottom = min(-0.4, y - 0.2)
        assert camera["bottom"] - camera["scale"] * bottom == pytest.approx(low, abs=4)
    # of reading the canvas again and again the browser complains; that is this test's doing
    assert [error for error in tab.errors if "getImageData" not in error] == []


def test_every_function_of_a_formula_is_known_to_the_page(tab: Tab, tmp_path: Path) -> None:
    text = (
        "abs(-x) + sqrt(x) + sin(x) + cos(x) + tan(x) + sinh(x) + cosh(x) + tanh(x) + exp(x)"
        " + log(x) + atan2(x, 2) + hypot(x, 3) + x**2 / 4 - x * s"
    )
    drawing = DRAWING._replace(points=(Point("all", "x", "x"),), rods=(), circles=(),
                               frame=("0", "0"), curves=(Curve("s", text, s=(0.0, 1.0)),),
                               units={"x": "m"}, outputs=("x",), values={})  # fmt: skip
    data = table({"time": np.array([0.0, 1.0]), "x": np.array([0.7, 0.7])})
    tab.open(write_replay([("all", data)], tmp_path / "all.html", known=[drawing]))
    got = tab.run("curvebound.scene.actors[0].curves[0].y({ x: 0.7, s: 0.25 })")
    known = {n: getattr(math, n) for n in ("sqrt", "sin", "cos", "tan", "sinh", "cosh", "tanh",
                                           "exp", "log", "atan2", "hypot")}  # fmt: skip
    assert got == pytest.approx(eval(text, {**known, "abs": abs}, {"x": 0.7, "s": 0.25}), rel=1e-14)

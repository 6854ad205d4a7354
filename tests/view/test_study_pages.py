"""Pages of studies and stability maps: read on any screen, in both modes, numbers for people."""

from __future__ import annotations

import re
from pathlib import Path

import numpy as np
import pytest
from browsing import Tab
from legible import VIEWED, boxes, look

from curvebound.pages import palette
from curvebound.study.precision.live_measures import points
from curvebound.study.precision.page import study_page
from curvebound.study.precision.plots import draw_trust, draw_work
from curvebound.study.stability.map_report import write_map
from curvebound.study.stability.maps import Request
from curvebound.study.stability.probe import ACCURATE, INACCURATE, UNSTABLE, Probed
from curvebound.study.stability.stability_map import Column, StabilityMap

METHODS = ("explicit_euler", "rk4", "adaptive")


def row(method: str, form: str, size: float, macro_step: float) -> dict[str, object]:
    order = {"explicit_euler": 1, "semi_implicit_euler": 1, "adaptive": 1.2}.get(method, 3.97)
    error = 0.3 * (size / 0.1) ** order * (160.0 if form == "none" else 1.0)
    return {
        "purpose": "micro", "form": form, "method": method, "size": size,
        "size_is": "tolerance" if method == "adaptive" else "step", "macro_step": macro_step,
        "algorithm": "", "cpu": 3.27e-6 * 1e-2 / size, "steps": 100, "evaluations": 4000,
        "energy_residual": 2.0 * error, "drift": error, "acceleration_error": None,
        "kinetic": 9.81, "failure": "", "error": error, "numerical": error, "modelling": 0.0,
        "judged": True, "judged_until": 10.0, "amplitude": 2.0,
    }  # fmt: skip


@pytest.fixture(scope="module")
def study(tmp_path_factory: pytest.TempPathFactory) -> Path:
    folder = tmp_path_factory.mktemp("study")
    rows = [
        row(method, form, 10.0 ** (-0.5 * n), step)
        for method in METHODS
        for form in ("angle", "none")
        for n in range(2, 9)
        for step in (0.1,)
    ]
    draw_work(rows, folder / "work", "a scene", "m, rad")
    found = points("energy.residual", {"a scene": rows})
    draw_trust([("energy.residual / kinetic", found)], folder / "trust", "a scene")
    return study_page(
        folder / "index.html", name="a scene", description="what it shows", rows=rows,
        references=[], paths=["plant.slider.u", "plant.pendulum.angle"], unit="m, rad",
        complete=True, statements=[], footer="a machine",
    )  # fmt: skip


@pytest.fixture(scope="module")
def stability(tmp_path_factory: pytest.TempPathFactory) -> Path:
    maps = []
    for number, method in enumerate(METHODS):
        columns = []
        for value in 10.0 ** np.arange(-2, 3):
            kinds = [ACCURATE] * (number + 1) + [INACCURATE] * 3 + [UNSTABLE] * (5 - number)
            sizes = [float(x) for x in np.geomspace(1e-4, 1.0, len(kinds))]
            columns.append(
                Column(
                    float(value), 10.0, {x: Probed(k) for x, k in zip(sizes, kinds, strict=True)},
                    accurate=sizes[number], stable=sizes[number + 3], at_rest=0.1, in_motion=0.05,
                )
            )  # fmt: skip
        maps.append(StabilityMap(method, columns))
    request = Request("bead_on_wire", "bead.wire.radius=0.01:100:5:log")
    return write_map(request, maps, "bead_on_wire", "m", tmp_path_factory.mktemp("maps"))


@VIEWED
def test_a_study_is_read_on_any_screen(tab: Tab, study: Path, view: tuple[int, int, bool]) -> None:
    look(tab, study, view)
    check_figures(tab, view, count=2)


@VIEWED
def test_a_map_is_read_on_any_screen(
    tab: Tab, stability: Path, view: tuple[int, int, bool]
) -> None:
    look(tab, stability, view)
    check_figures(tab, view, count=1)


def check_figures(tab: Tab, view: tuple[int, int, bool], count: int) -> None:
    """One drawing in each card, as wide as it, on its paper; tables scroll inside themselves."""
    width, _, dark = view
    cards = boxes(tab, "figure")
    drawn = [box for box in boxes(tab, "figure svg") if box["width"]]
    assert len(cards) == len(drawn) == count
    for card, drawing in zip(cards, drawn, strict=True):
        assert drawing["width"] > 0.96 * (card["width"] - 18), "as wide as its card"
        assert drawing["right"] <= card["right"], "and no wider"
        assert width < 640 or drawing["height"] < 1.2 * drawing["width"]
    figures = "[...document.querySelectorAll('figure')]"
    assert not tab.run(f"{figures}.some((one) => one.scrollWidth > one.clientWidth)")
    inner = boxes(tab, ".scroll")
    assert inner
    assert all(box["right"] <= width for box in inner)
    paper = palette(dark=dark)["paper"]
    ground = tab.run(
        "getComputedStyle(document.querySelector('figure svg [id$=patch_1] path')).fill"
    )
    assert ground == "rgb({}, {}, {})".format(*(int(paper[i : i + 2], 16) for i in (1, 3, 5)))


def test_numbers_are_for_people(study: Path, stability: Path) -> None:
    text = study.read_text()
    words = re.sub(r"(?s)<svg.*?</svg>|<style.*?</style>|<[^>]*>", " ", text)
    assert "has 160 times the error of angle" in words
    assert "order 3.97" in words
    assert "CPU time per simulated s" in words
    assert "3.27 us" in words
    assert "error (m, rad)" in words
    for page in (words, re.sub(r"(?s)<svg.*?</svg>|<[^>]*>", " ", stability.read_text())):
        assert re.findall(r"\d\.?\d*e[+-]?0\d", page) == [], "no exponent has a leading zero"
        assert re.findall(r"\de\+", page) == []
    assert 'whole">step 316 us<' in text, "on one line"
    assert "10 ms" in stability.read_text()


def test_no_row_of_the_front_is_as_wrong_as_the_motion_is_large(study: Path) -> None:
    front = study.read_text().partition("<h2>Pareto front</h2>")[2].partition("</table>")[0]
    rows = [re.findall(r"<td[^>]*>([^<]*)", line) for line in front.split("<tr>")[2:]]
    assert rows
    assert all(float(cells[3]) < 1.0 for cells in rows), "the motion has a range of 2 m"

"""Phase plots: the usual pair ready, any pair chosen, points where the data says."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from browsing import Tab
from legible import SCREENS
from motions import bead, pendulum

from curvebound.view import write_replay

BEAD = bead(4.0, 0.01)
PLOT = "curvebound.plots.at(-1)"
#: where the markers are, and where the axes put two values
MARKERS = (
    f"{PLOT}.marked.map(({{ marker }}) => marker.style.transform.match(/-?[\\d.]+/g).map(Number))"
)
NAMED = f"[...{PLOT}.legend.querySelectorAll('span')].map((one) => one.textContent)"


@pytest.fixture(scope="module")
def pages(tmp_path_factory: pytest.TempPathFactory) -> dict[str, Path]:
    folder = tmp_path_factory.mktemp("phase")
    return {
        "one": write_replay([("bead", BEAD)], folder / "one.html"),
        "two": write_replay([("held", BEAD), ("free", bead(4.0, 0.01, project=False))],
                            folder / "two.html"),
        "pendulum": write_replay([("pendulum", pendulum(4.0, 0.02))], folder / "pendulum.html"),
    }  # fmt: skip


def choose(tab: Tab, *names: str) -> None:
    """Upwards, then to the right."""
    for number, name in enumerate(names):
        tab.run(
            f"(() => {{ const one = {PLOT}.element.querySelectorAll('select')[{number}];"
            f"one.value = '{name}'; one.dispatchEvent(new Event('change')); }})()"
        )


def test_the_usual_pair_is_ready(tab: Tab, pages: dict[str, Path]) -> None:
    tab.open(pages["one"])
    assert tab.run(f"{PLOT}.chosen") == ["bead.angle", "bead.angular_velocity"]
    assert tab.run(NAMED) == []  # one needs no name
    assert tab.run(f"!{PLOT}.element.hidden")
    tab.open(pages["pendulum"])
    assert tab.run(f"{PLOT}.chosen") == ["pendulum.angle", "pendulum.angular_velocity"]


@pytest.mark.parametrize("pair", [("bead.angular_velocity", "bead.angle"), ("bead.vy", "bead.x")])
def test_points_are_where_the_data_says(
    tab: Tab, pages: dict[str, Path], pair: tuple[str, str]
) -> None:
    tab.open(pages["one"])
    choose(tab, *pair)
    up, right = (BEAD[f"bead.{name}"] for name in pair)
    shown, found = [], []
    for i in (0, 57, 200, 333):
        tab.run(
            f"curvebound.player.seek({float(BEAD['time'][i])!r}); {PLOT}.at(curvebound.player.time)"
        )
        shown.append([right[i], up[i]])
        found.append(tab.run(MARKERS)[0])
    # the mapping is affine, and upwards is up
    for axis, sign in ((0, 1.0), (1, -1.0)):
        values, pixels = np.array(shown)[:, axis], np.array(found)[:, axis]
        slope, offset = np.polyfit(values, pixels, 1)
        assert sign * slope > 0
        assert slope * values + offset == pytest.approx(pixels, abs=0.5)
    tab.run(f"{PLOT}.seek({found[2][0]}, {found[2][1]})")
    assert tab.run("curvebound.player.time") == pytest.approx(BEAD["time"][200], abs=0.03)


def test_its_line_is_drawn_and_its_numbers_told(tab: Tab, pages: dict[str, Path]) -> None:
    tab.open(pages["two"])
    inked = tab.run(
        f"(() => {{ const c = {PLOT}.chart.ctx, {{ width, height }} = c.canvas;"
        "const data = c.getImageData(0, 0, width, height).data, seen = new Set();"
        "for (let i = 0; i < data.length; i += 4) if (data[i + 3] === 255)"
        "seen.add(`#${[0, 1, 2].map((k) => data[i + k].toString(16).padStart(2, '0')).join('')}`);"
        "return curvebound.colours.actors.slice(0, 2).map((one) => seen.has(one)); })()"
    )
    assert inked == [True, True]
    assert tab.run(f"{PLOT}.lines.map(({{ text }}) => text)") == ["held", "free"]
    assert tab.run(NAMED) == ["held", "free"]
    tab.run("curvebound.player.seek(1)")
    tab.key("o")
    tab.wait(f"{PLOT}.legend.textContent.includes('\u00b0/s')")
    tab.run("curvebound.hide(curvebound.model.actors[1], true)")
    assert tab.run(f"{PLOT}.marked.map(({{ marker }}) => marker.style.visibility)") == [
        "visible", "hidden"]  # fmt: skip


@SCREENS
def test_it_fits_and_has_names(
    tab: Tab, pages: dict[str, Path], size: tuple[int, int, bool], dark: bool
) -> None:
    width, height, mobile = size
    tab.size(width, height, mobile=mobile, ratio=2 if mobile else 1)
    tab.dark(dark)
    tab.open(pages["two"])
    assert tab.run("document.documentElement.scrollWidth") <= width
    inside = tab.run(
        f"(() => {{ const card = {PLOT}.element.getBoundingClientRect();"
        f"return [...{PLOT}.element.querySelectorAll('select, button, canvas')]"
        ".filter((one) => one.checkVisibility()).map((one) => one.getBoundingClientRect())"
        ".every(({ left, right, bottom }) => left >= card.left && right <= card.right"
        " && bottom <= card.bottom); })()"
    )
    assert inside
    labels = tab.run(f"[...{PLOT}.element.querySelectorAll('select')].map((one) => one.ariaLabel)")
    assert labels == ["Phase plot: upwards", "Phase plot: to the right"]
    assert tab.run(f"{PLOT}.element.ariaLabel") == ("Phase plot: angular velocity against angle")
    assert tab.errors == []

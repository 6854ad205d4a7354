"""Views of a replay: y axes zoomed by hand, runs that leave the others behind, links, bars."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from browsing import Tab
from legible import SIZES
from motions import bead

from curvebound.cli import main
from curvebound.view import write_replay
from curvebound.view.replay import pages_beside

PLOT = "curvebound.plots[0]"
Y = f"(({{ min, max }}) => [min, max])({PLOT}.chart.scales.y)"
SETTLED = "new Promise((done) => requestAnimationFrame(() => requestAnimationFrame(() => done(0))))"


@pytest.fixture(scope="module")
def pages(tmp_path_factory: pytest.TempPathFactory) -> dict[str, Path]:
    folder = tmp_path_factory.mktemp("views")
    near, gone = bead(4.0, 0.02), bead(4.0, 0.02)
    for axis in "xy":
        gone[f"bead.bead.{axis}"] *= np.exp(gone["time"])
    return {
        "one": write_replay([("bead", near)], folder / "one.html"),
        "two": write_replay([("near", near), ("gone", gone)], folder / "two.html"),
    }


def ends(tab: Tab) -> list[float]:
    tab.run(SETTLED)
    return list(tab.run(Y))


def test_a_y_axis_is_zoomed_and_moved_by_hand(tab: Tab, pages: dict[str, Path]) -> None:
    tab.size(1280, 900)
    tab.open(pages["one"])
    low, high = ends(tab)
    left, top, width, height = tab.run(
        f"(({{ left, top, width, height }}) => [left, top, width, height])"
        f"({PLOT}.chart.over.getBoundingClientRect())"
    )
    # about the pointer, a quarter from below: what is there stays there
    at = left + width / 2, top + 0.75 * height
    tab.mouse("mouseWheel", *at, deltaX=0, deltaY=-300, modifiers=8)
    zoomed = ends(tab)
    assert zoomed[1] - zoomed[0] == pytest.approx((high - low) / np.e, rel=0.01)
    kept = low + 0.25 * (high - low)
    assert zoomed[0] + 0.25 * (zoomed[1] - zoomed[0]) == pytest.approx(kept, abs=0.02)
    before = tab.run("curvebound.player.time")
    tab.mouse("mousePressed", *at, button="left", clickCount=1, modifiers=8)
    tab.mouse("mouseMoved", at[0], at[1] - 0.5 * height, button="left", buttons=1, modifiers=8)
    tab.mouse("mouseReleased", at[0], at[1] - 0.5 * height, button="left", modifiers=8)
    moved = ends(tab)
    assert moved[0] == pytest.approx(zoomed[0] - 0.5 * (zoomed[1] - zoomed[0]), abs=0.02)
    assert tab.run("curvebound.player.time") == before
    tab.run(f"{PLOT}.chart.over.dispatchEvent(new MouseEvent('dblclick'))")
    assert ends(tab) == pytest.approx([low, high])
    tab.run(f"{PLOT}.element.querySelector('[aria-label^=\"Zoom in in y\"]').click()")
    assert np.diff(ends(tab)) == pytest.approx((high - low) / 2)
    tab.key("o")  # in degrees the numbers are others
    assert ends(tab) == pytest.approx(np.degrees([low, high]))


def test_a_logarithmic_axis_is_zoomed_too(tab: Tab, pages: dict[str, Path]) -> None:
    tab.open(pages["one"])
    drift = "curvebound.plots.find(({ spec }) => spec.title === 'Energy residual')"
    tab.run(f"{drift}.element.querySelector('[aria-pressed]').click()")
    scale = f"(({{ min, max }}) => Math.log10(max / min))({drift}.chart.scales.y)"
    decades = tab.run(scale)
    tab.run(f"{drift}.zoomY(2)")
    tab.run(SETTLED)
    assert tab.run(scale) == pytest.approx(decades / 2)


def test_a_run_that_leaves_does_not_shrink_the_drawing(tab: Tab, pages: dict[str, Path]) -> None:
    tab.open(pages["one"])
    assert not tab.run("document.getElementById('see-all').checkVisibility()")
    alone = tab.run("curvebound.scene.drawn.scale")
    tab.open(pages["two"])
    assert tab.run("curvebound.scene.drawn.scale") > 0.3 * alone
    tab.key("e")
    tab.run(SETTLED)
    assert tab.run("document.getElementById('see-all').ariaPressed") == "true"
    assert tab.run("curvebound.scene.drawn.scale") < 0.2 * alone
    tab.run("document.getElementById('see-all').click()")
    tab.run(SETTLED)
    assert tab.run("curvebound.scene.drawn.scale") > 0.3 * alone


@pytest.mark.parametrize("size", SIZES)
def test_words_do_not_wrap_and_bars_cover_nothing(
    tab: Tab, pages: dict[str, Path], size: tuple[int, int, bool]
) -> None:
    width, height, mobile = size
    tab.size(width, height, mobile=mobile, ratio=2 if mobile else 1)
    tab.open(pages["two"])
    high = tab.run(
        "[...document.querySelectorAll('button:not(.entry)')]"
        ".filter((one) => one.checkVisibility())"
        ".map((one) => [one.textContent, one.getBoundingClientRect().height])"
    )
    assert max(one[1] for one in high) <= 40, high
    tab.run("document.getElementById('choose').click()")
    assert tab.run("document.documentElement.scrollWidth") <= width
    # the list pushes the plots down instead of lying on them
    assert tab.run(
        "document.getElementById('chooser').getBoundingClientRect().bottom"
        " <= document.getElementById('plots').getBoundingClientRect().top"
    )
    # what the keyboard reaches stands above the bar, and the last plot at the end of the page
    hidden = tab.run(
        "(() => { const bar = document.querySelector('.transport'), found = [];"
        "for (const one of document.querySelectorAll('#plots button, #plots select')) {"
        "if (!one.checkVisibility()) continue; one.focus();"
        "if (one.getBoundingClientRect().bottom > bar.getBoundingClientRect().top + 1)"
        "found.push(one.outerHTML); }"
        "scrollTo(0, document.documentElement.scrollHeight);"
        "if (document.getElementById('plots').getBoundingClientRect().bottom"
        " > bar.getBoundingClientRect().top) found.push('plots'); return found; })()"
    )
    assert hidden == []
    assert tab.errors == []


def test_links_to_the_pages_that_are_there(tmp_path: Path, fmus: Path) -> None:
    assert pages_beside(tmp_path, "a scene") == {}
    page = tmp_path / "study" / "bead_on_wire" / "index.html"
    page.parent.mkdir(parents=True)
    page.write_text("<!doctype html><title>study</title>", encoding="utf-8")
    assert pages_beside(tmp_path, "bead_on_wire") == {"Study": "study/bead_on_wire/index.html"}
    out = tmp_path / "it.html"
    command = ["run", "bead_on_wire", "--stop", "0.1", "--replay", str(out)]
    assert main(command) == 0
    text = out.read_text(encoding="utf-8")
    assert '"links":{"Study":"study/bead_on_wire/index.html"}' in text.replace(": ", ":")

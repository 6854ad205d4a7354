"""The page in each FMU: sketch, equations, tables and plots, on any screen and in both modes."""

from __future__ import annotations

import zipfile
from pathlib import Path

import pytest
from browsing import Tab
from legible import VIEWS, boxes, look

from curvebound.fmi.folder import names


@pytest.fixture
def page(fmus: Path, tmp_path: Path, name: str) -> Path:
    with zipfile.ZipFile(fmus / f"{name}.fmu") as archive:
        archive.extractall(tmp_path)
    return tmp_path / "documentation/index.html"


@pytest.mark.parametrize(
    ("name", "view"),
    [
        pytest.param(name, view, marks=() if j == i % 2 else pytest.mark.slow)
        for i, name in enumerate(names())
        for j, view in enumerate(VIEWS)
    ],
)
def test_it_is_read_on_any_screen(tab: Tab, page: Path, view: tuple[int, int, bool]) -> None:
    look(tab, page, view)
    # what is wider than the screen scrolls inside itself
    assert tab.run(
        "[...document.querySelectorAll('table, math[display=block]')].every("
        "e => e.closest('.scroll, .equations').getBoundingClientRect().right <= innerWidth)"
    )
    plots = boxes(tab, ".plots svg")
    assert plots
    assert all(300 < plot["width"] <= 390 for plot in plots), "letters keep their size"


@pytest.mark.parametrize("name", names())
def test_equations_are_set(tab: Tab, page: Path) -> None:
    """MathML that a browser understands: fractions stand over each other, powers are raised."""
    tab.open(page, ready=False)
    over = "e => e.firstElementChild.getBoundingClientRect().bottom <= "
    over += "e.lastElementChild.getBoundingClientRect().top + 2"
    assert tab.run(f"[...document.querySelectorAll('mfrac')].every({over})")
    assert tab.run("document.querySelectorAll('math[display=block]').length") >= 1
    assert tab.run("document.querySelectorAll('merror, script').length") == 0


@pytest.mark.parametrize("name", ["BeadOnWire", "ParabolaPendulum"])
def test_the_sketch_is_seen_in_both_modes(tab: Tab, page: Path) -> None:
    """Lines and bodies stand out from the paper, and the symbols lie within the picture."""
    for dark in (False, True):
        tab.dark(dark)
        tab.open(page, ready=False)
        (sketch,) = boxes(tab, ".sketch")
        words = boxes(tab, ".sketch text")
        assert len(words) >= 6
        for word in words:
            assert sketch["left"] <= word["left"], word
            assert word["right"] <= sketch["right"], word
            assert sketch["top"] <= word["top"] <= word["bottom"] <= sketch["bottom"], word
        paper = tab.run("getComputedStyle(document.querySelector('figure')).backgroundColor")
        inks = tab.run(
            "[...document.querySelectorAll('.sketch path, .sketch .curve')]"
            ".map(e => getComputedStyle(e).stroke)"
        )
        assert inks
        assert "none" not in inks
        assert paper not in inks

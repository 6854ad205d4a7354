"""The gallery: cards, links that exist, and nothing that loads from elsewhere."""

from __future__ import annotations

import io
from html.parser import HTMLParser
from pathlib import Path
from urllib.parse import unquote

import numpy as np
import pytest
from browsing import Tab
from legible import SHOWN, VIEWED, choose, look
from motions import bead
from PIL import Image

from curvebound.pages import palette
from curvebound.view import Card, write_gallery, write_picture, write_replay


class Addresses(HTMLParser):
    def __init__(self, text: str) -> None:
        super().__init__()
        self.found: list[str] = []
        self.feed(text)

    def handle_starttag(self, tag: str, attributes: list[tuple[str, str | None]]) -> None:
        for name, value in attributes:
            if name in ("href", "src") and value and not value.startswith("data:"):
                self.found.append(value)


@pytest.fixture(scope="module")
def gallery(tmp_path_factory: pytest.TempPathFactory) -> Path:
    data = bead(2.0, 0.02)
    folder = tmp_path_factory.mktemp("gallery") / "build"
    card = Card(
        title="bead & <wire>",
        shows="A bead slides.",
        picture=write_picture(
            data, folder / "pictures" / "bead on a wire.png", stacked=True, dark=True
        ),
        settings={"method": "rk4, 1 ms", "formulation": "<angle>"},
        error="2e-12 J",
        cost="2.1 us a step",
        links={
            "Replay": write_replay([("bead", data)], folder / "bead on a wire.html"),
            "Study": folder / "not_there.html",
        },
    )
    bare = Card(title="bare", shows="Nothing but words.", picture=folder / "none.png")
    return write_gallery([card, bare], folder / "index.html", introduction="All scenes.")


def test_links_lead_somewhere(gallery: Path) -> None:
    addresses = Addresses(gallery.read_text()).found
    assert addresses
    for address in addresses:
        assert (gallery.parent / unquote(address)).is_file()
    assert "not_there" not in gallery.read_text()
    assert sum(address.endswith(".html") for address in addresses) == 2, "picture and button"


def test_words_are_text(gallery: Path) -> None:
    text = gallery.read_text()
    for words in ("bead &amp; &lt;wire&gt;", "&lt;angle&gt;", "2e-12 J", "2.1 us a step"):
        assert words in text


def test_an_empty_gallery_says_so(tmp_path: Path) -> None:
    assert "No scene" in write_gallery([], tmp_path / "index.html").read_text()


def test_in_the_browser(tab: Tab, gallery: Path) -> None:
    tab.open(gallery, ready=False)
    assert tab.errors == []
    assert all(url.startswith("file:") for url in tab.requests)
    # those below the window are loaded when they come into view, those of the other theme never
    for i in range(tab.run(f"{SHOWN}.length")):
        tab.run(f"{SHOWN}[{i}].scrollIntoView()")
        tab.wait(f"{SHOWN}[{i}].complete")
    assert tab.run(f"{SHOWN}.length && {SHOWN}.every((one) => one.naturalWidth > 0 && one.alt)")
    assert not any(url.endswith("_dark.png") for url in tab.requests)
    tab.run("document.querySelector('nav a').click()")
    tab.wait("document.documentElement.dataset.ready")
    assert tab.run("curvebound.model.results[0].label") == "bead"


@VIEWED
def test_it_is_read_on_any_screen(tab: Tab, gallery: Path, view: tuple[int, int, bool]) -> None:
    """Letters of a picture, drawn at 7 points for the width of a phone, keep their size."""
    look(tab, gallery, view)
    tab.run(f"{SHOWN}[0].scrollIntoView()")
    tab.wait(f"{SHOWN}[0].naturalWidth")
    image = tab.run(f"{SHOWN}[0].getBoundingClientRect().toJSON()")
    pixels_per_inch = 200
    inches = tab.run(f"{SHOWN}[0].naturalWidth") / pixels_per_inch
    assert image["width"] > 0.9 * inches * 96
    assert image["right"] <= view[0]


@pytest.mark.parametrize(
    ("system", "choice"),
    [
        (False, ""),
        (True, ""),
        (False, "dark"),
        (True, "light"),
        pytest.param(False, "light", marks=pytest.mark.slow),
        pytest.param(True, "dark", marks=pytest.mark.slow),
    ],
)
def test_pictures_follow_the_theme(tab: Tab, gallery: Path, system: bool, choice: str) -> None:
    """On its paper, in inks that are read: the letters' and the first body's stand out from it."""
    tab.dark(system)
    tab.open(gallery, ready=False)
    if choice:
        choose(tab, choice)
    dark = choice == "dark" if choice else system
    tab.run(f"{SHOWN}[0].scrollIntoView()")
    tab.wait(f"{SHOWN}[0].complete && {SHOWN}[0].naturalWidth")
    assert tab.run(f"{SHOWN}.length") == 1
    assert tab.run(f"{SHOWN}[0].currentSrc").endswith("_dark.png") == dark
    tab.run(f"{SHOWN}[0].decode()")
    seen = Image.open(io.BytesIO(tab.picture())).convert("RGB")
    box = tab.run(f"{SHOWN}[0].getBoundingClientRect().toJSON()")
    part = np.asarray(seen)[
        int(box["top"]) + 2 : int(box["bottom"]), int(box["left"]) + 2 : int(box["right"]) - 2
    ]
    packed, counts = np.unique(part @ np.array([1 << 16, 1 << 8, 1]), return_counts=True)
    colours = np.stack([packed >> 16, packed >> 8 & 255, packed & 255], axis=1)
    named = palette(dark=dark)
    paper, ink, body = (
        [int(named[name][i : i + 2], 16) for i in (1, 3, 5)]
        for name in ("paper", "ink", "result-0")
    )
    assert list(colours[counts.argmax()]) == paper
    assert counts.max() > 0.7 * counts.sum()
    for wanted in (ink, body):
        assert (np.abs(colours - wanted).max(axis=1) < 25).any()
    assert tab.errors == []

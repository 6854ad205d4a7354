"""What a test can tell of a page that is read: contrast, size of letters, width."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import pytest
from browsing import Tab

#: least contrast of text (WCAG 2.1), and least size of letters in px
CONTRAST, LETTERS = 4.5, 8.0

_FAINT = """(() => {
  const channel = c => (c /= 255) <= 0.04045 ? c / 12.92 : ((c + 0.055) / 1.055) ** 2.4;
  const numbers = text => (text.match(/[\\d.]+/g) || []).map(Number);
  const light = ([r, g, b]) =>
    0.2126 * channel(r) + 0.7152 * channel(g) + 0.0722 * channel(b);
  const ground = element => {
    for (let at = element; at; at = at.parentElement) {
      const found = numbers(getComputedStyle(at).backgroundColor);
      if (found.length === 3 || found[3] === 1) return found;
    }
    return [255, 255, 255];
  };
  const found = [];
  const texts = document.createTreeWalker(document.body, NodeFilter.SHOW_TEXT);
  while (texts.nextNode()) {
    const text = texts.currentNode.data.trim(), element = texts.currentNode.parentElement;
    const box = document.createRange();
    box.selectNodeContents(texts.currentNode);
    const size = box.getBoundingClientRect();
    if (!text || !size.width || !size.height) continue;
    const style = getComputedStyle(element), drawn = element.closest('svg');
    const ink = numbers(drawn ? style.fill : style.color);
    const [low, high] = [light(ink), light(ground(element))].sort((a, b) => a - b);
    const contrast = (high + 0.05) / (low + 0.05);
    const scale = drawn ? Math.hypot(element.getScreenCTM().a, element.getScreenCTM().b) : 1;
    const letters = parseFloat(style.fontSize) * scale;
    if (contrast < CONTRAST || letters < LETTERS)
      found.push(`${text}: contrast ${contrast.toFixed(1)}, ${letters.toFixed(1)} px`);
  }
  return found;
})()"""

#: the pictures of a page, without those of the theme that is not shown
SHOWN = "[...document.images].filter((image) => image.getClientRects().length)"
#: each way of looking at a page: width, height, dark; `look` sees both themes in either
VIEWS = [(1280, 900, False), (390, 844, True), (1280, 900, True), (390, 844, False)]
#: the parameter `view`: all of them, by default the first two
VIEWED = pytest.mark.parametrize(
    "view", [*VIEWS[:2], *(pytest.param(view, marks=pytest.mark.slow) for view in VIEWS[2:])]
)
#: sizes of a screen: width, height, mobile
SIZES = [(1280, 900, False), (390, 844, True)]
#: the parameters `size` and `dark`: all pairs, by default two that have each once
SCREENS = pytest.mark.parametrize(
    ("size", "dark"),
    [
        (SIZES[0], False),
        (SIZES[1], True),
        pytest.param(SIZES[0], True, marks=pytest.mark.slow),
        pytest.param(SIZES[1], False, marks=pytest.mark.slow),
    ],
)


def faint(tab: Tab, letters: float = LETTERS) -> list[str]:
    """The texts of a page that stand out too little from their ground, or are too small."""
    script = _FAINT.replace("CONTRAST", str(CONTRAST)).replace("LETTERS", str(letters))
    found: list[str] = tab.run(script)
    return found


def look(tab: Tab, page: Path, view: tuple[int, int, bool]) -> None:
    """Open a page in one of VIEWS, and hold it to what every page must keep."""
    width, height, dark = view
    tab.size(width, height)
    tab.dark(dark)
    tab.open(page, ready=False)
    assert tab.errors == []
    assert all(url.startswith(("file:", "data:")) for url in tab.requests)
    assert tab.run("document.documentElement.scrollWidth") == width, "no sideways scroll"
    assert faint(tab) == []
    assert tab.run("getComputedStyle(document.body).backgroundColor") == (
        "rgb(13, 17, 23)" if dark else "rgb(243, 245, 248)"
    )
    by_system = _seen(tab)
    tab.dark(not dark)
    assert _seen(tab) != by_system
    choose(tab, "dark" if dark else "light")
    assert _seen(tab) == by_system, "by choice the page is what it is by the system's scheme"


def choose(tab: Tab, theme: str) -> None:
    """Press one of the buttons that choose the theme of a page: light or dark."""
    tab.run(f"document.querySelector('#theme-{theme}').click()")


def _seen(tab: Tab) -> bytes:
    """The whole page but for these buttons, with its pictures loaded."""
    tab.run("document.querySelector('.themes').style.visibility = 'hidden'")
    tab.run(f"{SHOWN}.forEach((image) => image.scrollIntoView())")
    tab.run(f"Promise.all({SHOWN}.map((image) => image.decode()))")
    tab.run("scrollTo(0, 0)")
    return tab.picture(whole=True)


def boxes(tab: Tab, selector: str) -> list[dict[str, Any]]:
    """Where the elements that match stand."""
    found: list[dict[str, Any]] = tab.run(
        f"[...document.querySelectorAll({selector!r})].map(e => e.getBoundingClientRect().toJSON())"
    )
    return found

"""Everything that a page draws in its scene, call by call."""

from __future__ import annotations

from pathlib import Path

import pytest
from browsing import Tab
from fingerprints import assert_same
from test_whole_pictures import CASES

from curvebound.cosim.differences import Difference
from curvebound.view import write_replay
from curvebound.view.replay import About

#: notes every call on a canvas, and what colours, widths and fonts it is made with
RECORD = """(() => {
  const said = window.said = [];
  const digits = (x) => typeof x === "number" ? (Math.round(x * 100) / 100).toFixed(2)
    : Array.isArray(x) ? `[${x.map(digits)}]` : typeof x === "object" ? "object" : String(x);
  const kept = ["strokeStyle", "fillStyle", "lineWidth", "globalAlpha", "font", "textAlign",
    "textBaseline", "lineCap", "lineJoin"];
  const drawing = CanvasRenderingContext2D.prototype;
  for (const name of Object.getOwnPropertyNames(drawing)) {
    const known = Object.getOwnPropertyDescriptor(drawing, name);
    if (typeof known.value !== "function" || name === "measureText") continue;
    drawing[name] = function (...given) {
      const inked = /^(fill|stroke)/.test(name) ? kept.map((key) => digits(this[key])) : "";
      said.push(`${name} ${given.map(digits)} ${inked}`);
      return known.value.apply(this, given);
    };
  }
  drawing.measureText = (text) => ({ width: 7 * text.length });  // whatever fonts there are
  const path = window.Path2D.prototype;
  for (const name of Object.getOwnPropertyNames(path)) {
    const known = Object.getOwnPropertyDescriptor(path, name);
    if (typeof known.value !== "function" || name === "constructor") continue;
    path[name] = function (...given) {
      said.push(`path ${name} ${given.map(digits)}`);
      return known.value.apply(this, given);
    };
  }
})()"""
SIZE = (1280, 900)
#: what is done before time 1.3 is drawn
DEEDS = {
    "as it opens": "",
    "zoomed": "curvebound.scene.zoomBy(3, 100, 80); curvebound.scene.panBy(7, -4);",
    "following": "curvebound.scene.follow(true);",
    "with arrows": "curvebound.nextArrows(); curvebound.nextArrows(); curvebound.nextArrows();",
    "one hidden": "curvebound.scene.hidden.add(0);",
}
PAGES = ("a bead", "a drifting bead and one that does not", "a pushed pendulum", "gaps",
         "three pendulums")  # fmt: skip


@pytest.fixture(scope="module")
def pages(tmp_path_factory: pytest.TempPathFactory) -> dict[str, Path]:
    folder = tmp_path_factory.mktemp("drawn")
    about = About("A text", [Difference("step", "s", (0.1, 0.2))], {"Study": "s/index.html"})
    return {
        name: write_replay(
            CASES[name] if isinstance(CASES[name], list) else [("it", CASES[name])],
            folder / f"{i}.html", title="A title", about=about,
        )
        for i, name in enumerate(PAGES)
    }  # fmt: skip


def recorded(tab: Tab, script: str) -> str:
    """What is drawn meanwhile."""
    lines = tab.run(f"(() => {{ said.length = 0; {script}; return said.splice(0); }})()")
    return "\n".join(lines)


@pytest.mark.parametrize("name", PAGES)
def test_scenes(name: str, tab: Tab, pages: dict[str, Path]) -> None:
    tab.open(pages[name])
    tab.run(RECORD)
    told = []
    for what, deed in DEEDS.items():
        undo = (
            "const s = curvebound.scene; s.follow(false); s.hidden.clear(); s.width = 800;"
            "s.height = 450;"
        )
        told += [f"== {what}", recorded(tab, f"{{ {undo} {deed} s.draw(1.3) }}")]
        told.append(recorded(tab, "curvebound.scene.draw(1000)"))
    assert_same(f"scene of {name}", "\n".join(told))

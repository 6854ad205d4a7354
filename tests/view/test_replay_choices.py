"""What a reader can choose on a replay page: runs, scale, degrees, pictures; what it tells."""

from __future__ import annotations

import base64
import struct
from pathlib import Path

import numpy as np
import pytest
from browsing import Tab
from motions import bead

from curvebound.cosim import load_scene
from curvebound.cosim.differences import differences, own_label
from curvebound.view import About, write_replay

GOOD = bead(10.0, 1 / 60)
CHART = "curvebound.plots.find(({ spec }) => spec.title === 'Angle')"


@pytest.fixture
def page(tmp_path: Path) -> Path:
    wild = GOOD.copy()
    wild["bead.bead.angle"] += np.exp(1.2 * wild["time"])
    return write_replay([("good", GOOD), ("wild", wild)], tmp_path / "two.html", "two")


def high(tab: Tab) -> float:
    return float(tab.run(f"{CHART}.chart.scales.y.max"))


def press(tab: Tab, where: str, text: str) -> None:
    found = f"[...{where}.querySelectorAll('button')]"
    tab.run(f"{found}.find((one) => one.textContent === '{text}').click()")


def test_a_run_that_blows_up_flattens_none(tab: Tab, page: Path) -> None:
    tab.open(page)
    span = float(np.ptp(GOOD["bead.bead.angle"]))
    assert span < high(tab) < 8 * span
    press(tab, f"{CHART}.element", "all")
    assert high(tab) > 1e4
    press(tab, f"{CHART}.element", "all")
    assert high(tab) < 8 * span
    assert tab.errors == []


def test_the_legend_hides_runs_and_series(tab: Tab, page: Path) -> None:
    tab.open(page)
    before = tab.run("curvebound.scene.canvas.toDataURL()")
    press(tab, "document.getElementById('legend')", "wild")
    assert tab.run(f"{CHART}.chart.series.map(({{ show }}) => show)") == [True, True, False]
    assert tab.run("curvebound.scene.canvas.toDataURL()") != before
    press(tab, "document.getElementById('legend')", "wild")
    assert tab.run(f"{CHART}.chart.series.map(({{ show }}) => show)") == [True, True, True]
    assert tab.run("curvebound.scene.canvas.toDataURL()") == before
    press(tab, f"{CHART}.legend", "good")
    assert tab.run(f"{CHART}.chart.series.map(({{ show }}) => show)") == [True, False, True]
    assert tab.errors == []


def test_plots_are_shown_as_chosen(tab: Tab, page: Path) -> None:
    tab.open(page)
    shown = "curvebound.plots.map(({ element }) => !element.hidden)"
    before = tab.run(shown)
    boxes = "[...document.getElementById('chooser').querySelectorAll('input')]"
    assert tab.run(f"{boxes}.map((box) => box.checked)") == before
    for k in (before.index(True), before.index(False)):
        tab.run(f"{boxes}[{k}].click()")
        assert tab.run(shown) == [on != (i == k) for i, on in enumerate(before)]
        tab.run(f"{boxes}[{k}].click()")
        assert tab.run(shown) == before
    assert tab.errors == []


def test_degrees_on_demand(tab: Tab, page: Path) -> None:
    tab.open(page)
    tab.run("curvebound.player.seek(1); curvebound.told = -Infinity")
    tab.key("o")
    tab.wait("document.getElementById('degrees').getAttribute('aria-pressed') === 'true'")
    value = GOOD["bead.bead.angle"][60]
    shown = f"{np.degrees(value):.2f} °".replace("-", "\u2212")
    tab.wait(f"{CHART}.legend.textContent.includes('{shown}')")
    assert tab.run(f"{CHART}.element.querySelector('h3').textContent") == "Angle °"
    data = tab.run(f"Array.from({CHART}.chart.data[1])")
    assert max(abs(one) for one in data if one is not None) == pytest.approx(
        np.degrees(np.abs(GOOD["bead.bead.angle"]).max()), rel=1e-3
    )
    tab.wait("document.getElementById('readouts').textContent.includes('°/s')")


def test_plots_and_drawing_are_saved_as_png(tab: Tab, page: Path) -> None:
    tab.open(page)
    tab.run(
        "window.saved = []; HTMLAnchorElement.prototype.click = function () {"
        " saved.push([this.download, this.href]); }"
    )
    press(tab, f"{CHART}.element", "PNG")
    tab.run("document.getElementById('picture').click()")
    saved = tab.run("saved")
    assert [name for name, _ in saved] == ["two_Angle.png", "two_0_00.png"]
    for _, address in saved:
        data = base64.b64decode(address.partition(",")[2])
        assert data.startswith(b"\x89PNG")
        width, height = struct.unpack(">II", data[16:24])
        assert min(width, height) > 150
    assert tab.errors == []


def test_the_legend_of_a_picture_has_the_colours_of_its_lines(tab: Tab, page: Path) -> None:
    tab.open(page)
    tab.run("HTMLAnchorElement.prototype.click = function () { window.saved = this.href; }")
    press(tab, f"{CHART}.element", "PNG")
    lines = tab.run(f"{CHART}.lines.map((one) => [one.colour(), one.dash.length > 0])")
    paper = tab.run("curvebound.colours.paper")
    # from the left, the middle of each line of the legend; they end the picture, 20 pixels each
    rows = tab.run(
        "(async () => { const image = new Image(); image.src = saved; await image.decode();"
        "const c = new OffscreenCanvas(image.width, image.height).getContext('2d');"
        "c.drawImage(image, 0, 0);"
        f"return {list(range(len(lines)))}.map((k) => [...c.getImageData("
        f"12, image.height - 20 * ({len(lines)} - k) + 2, 24, 1).data]); }})()"
    )
    for row, (colour, dashed) in zip(rows, lines, strict=True):
        found = [f"#{bytes(row[i : i + 3]).hex()}" for i in range(0, len(row), 4)]
        assert found[0] == found[-1] == colour
        assert set(found) == {colour} | ({paper} if dashed else set())


def test_it_tells_what_it_shows_and_what_differs(tab: Tab, tmp_path: Path) -> None:
    scene = load_scene("sampled_feedback")
    scenes = [scene, *(scene.with_variant(name) for name in scene.variants)]
    found = differences(scenes)
    assert [(one.path, one.unit) for one in found] == [("drive.sample.period", "s")]
    assert found[0].values == (0.02, 0.1, 0.2, 0.22)
    assert own_label(found, 0) == "period 20 ms"
    about = About("a loop <at> several periods", found, {"Gallery": "index.html"})
    out = write_replay(
        [(name, GOOD) for name in ("0.02 s", *scene.variants)], tmp_path / "a.html", about=about
    )
    tab.open(out)
    assert tab.run("document.getElementById('about').textContent") == (
        "a loop <at> several periods Gallery "
    )
    row = "[...document.querySelectorAll('#differing tr:last-child > *')].map((e) => e.textContent)"
    assert tab.run(row) == ["drive.sample.period", "0.02 s", "0.1 s", "0.2 s", "0.22 s"]
    assert tab.errors == []


def test_components_that_differ_alike_are_named_once() -> None:
    scene = load_scene("two_wires")
    found = differences([scene, scene.with_variant("coarse")])
    assert len(found) == 2
    assert own_label(found, 1) == "step 16.7 ms"


def test_scenes_that_are_the_same_differ_in_nothing() -> None:
    scene = load_scene("bead_on_wire")
    other = scene.copy()
    other.set("bead.bead.mass", "1 kg")  # as the FMU has it
    assert differences([scene, other]) == []
    other.set("bead.solver.method", 4)
    other.step = 0.02
    found = {one.path: one.values for one in differences([scene, other])}
    assert found == {"bead.solver.method": ("rk4", "adaptive"), "step": (0.01, 0.02)}

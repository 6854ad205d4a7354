"""Replay pages in a real browser, opened from disk."""

from __future__ import annotations

import io
import json
import math
import random
import time
from collections.abc import Callable
from functools import cache
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from browsing import NEXT, Tab
from motions import Table, bead, pendulum, table, without
from PIL import Image

from curvebound.view import write_replay

# Middle of the pixels of exactly one colour in the drawing, in CSS pixels, and their number.
CENTRE = """((colour) => {
  const canvas = document.getElementById("scene"), { width, height } = canvas;
  const probe = document.createElement("canvas").getContext("2d");
  probe.fillStyle = colour;
  probe.fillRect(0, 0, 1, 1);
  const [r, g, b] = probe.getImageData(0, 0, 1, 1).data;
  const data = canvas.getContext("2d").getImageData(0, 0, width, height).data;
  let left = width, right = 0, low = 0, high = height;
  const xs = [], ys = [];
  for (let i = 0; i < width * height; i++) {
    if (data[4 * i] !== r || data[4 * i + 1] !== g || data[4 * i + 2] !== b) continue;
    const px = i % width, py = Math.floor(i / width);
    xs.push(px + 0.5);
    ys.push(py + 0.5);
    left = Math.min(left, px); right = Math.max(right, px + 1);
    high = Math.min(high, py); low = Math.max(low, py + 1);
  }
  // Medians: a pixel on the edge of something else may happen to have the same colour.
  const median = (all) => all.sort((a, b) => a - b)[Math.floor(all.length / 2)];
  return [median(xs), median(ys), xs.length, left, right, high, low];
})"""


@pytest.fixture(scope="session")
def pages(tmp_path_factory: pytest.TempPathFactory) -> dict[str, Path]:
    folder = tmp_path_factory.mktemp("pages")
    results: dict[str, list[tuple[str, Table]]] = {
        "bead": [("bead", BEAD)],
        "pendulum": [("pendulum", pendulum(10.0, 0.01))],
        "driven": [("driven", DRIVEN)],
        "compared": [("projection", long()), ("none", drifting())],
    }
    return {
        name: write_replay(shown, folder / f"{name}.html", name) for name, shown in results.items()
    }


BEAD = bead(10.0, 1 / 60)
DRIVEN = pendulum(10.0, 0.02, push=4.0)


@cache
def long() -> Table:
    return bead(200.0, 1 / 60)


@cache
def drifting() -> Table:
    return bead(200.0, 1 / 60, project=False)


def show(tab: Tab, t: float) -> dict[str, float]:
    """Draw time t; the mapping from metres to pixels in force there."""
    tab.run(f"curvebound.player.seek({t!r})")
    tab.run(NEXT)
    drawn = tab.run("curvebound.scene.drawn")
    assert drawn["time"] == t
    return dict(drawn)


def middle(tab: Tab, colour: str) -> list[float]:
    return list(tab.run(f"{CENTRE}(curvebound.colours.{colour})"))


def away(camera: dict[str, float], found: list[float], x: float, y: float) -> float:
    """Pixels between a mark and where the data says it is."""
    return math.hypot(
        found[0] - (camera["left"] + camera["scale"] * x),
        found[1] - (camera["bottom"] - camera["scale"] * y),
    )


def values(tab: Tab, channel: int) -> np.ndarray:
    found = tab.run(f"Array.from(curvebound.channels[{channel}])")
    return np.array([math.nan if value is None else value for value in found])


@pytest.mark.parametrize(
    "name", ["bead", pytest.param("pendulum", marks=pytest.mark.slow), "driven", "compared"]
)
def test_opens_from_disk_without_an_error_or_a_request(
    tab: Tab, pages: dict[str, Path], name: str
) -> None:
    tab.open(pages[name], "play=1")
    tab.wait("curvebound.player.time > curvebound.player.start")
    assert tab.errors == []
    assert [url.split("#")[0] for url in tab.requests] == [pages[name].as_uri()]
    assert tab.run("document.querySelectorAll('.plot:not([hidden]) .u-wrap').length") >= 3
    assert tab.run("document.getElementById('trouble').hidden")


def test_the_page_may_not_load_anything_even_if_it_wished(tab: Tab, pages: dict[str, Path]) -> None:
    tab.open(pages["bead"])
    tab.run(
        "window.refused = [];"
        "document.addEventListener('securitypolicyviolation', ({ effectiveDirective }) => "
        "refused.push(effectiveDirective))"
    )
    tab.run("fetch('http://127.0.0.1:9/').catch(() => 0)")
    tab.run("new Image().src = 'http://127.0.0.1:9/'")
    tab.wait("refused.length > 1")
    assert tab.run("refused.sort()") == ["connect-src", "img-src"]
    tab.run(
        "document.body.append(Object.assign(document.createElement('script'),"
        "{ textContent: 'window.ran = true' }))"
    )
    assert tab.run("window.ran === undefined")


@pytest.mark.parametrize("speed", [pytest.param(1, marks=pytest.mark.slow), 0.5])
def test_motion_runs_in_real_time(tab: Tab, pages: dict[str, Path], speed: float) -> None:
    tab.open(pages["bead"], f"play=1&speed={speed}")
    stamp = (
        "new Promise((done) => requestAnimationFrame((now) => done([now, curvebound.player.time])))"
    )
    tab.run(stamp)
    asked = [time.monotonic()]
    before = tab.run(stamp)
    asked.append(time.monotonic())
    time.sleep(1.0)
    asked.append(time.monotonic())
    after = tab.run(stamp)
    asked.append(time.monotonic())
    shown = (after[1] - before[1]) / speed
    assert shown == pytest.approx((after[0] - before[0]) / 1e3, rel=0.01), "the browser's clock"
    # Ours, but for the time that asking took.
    assert 0.95 * (asked[2] - asked[1]) < shown < 1.05 * (asked[3] - asked[0])


@pytest.mark.parametrize("size", [(1280, 900, False, 1), (390, 844, True, 2)])
def test_a_bead_is_drawn_where_the_data_says(
    tab: Tab, pages: dict[str, Path], size: tuple[int, int, bool, float]
) -> None:
    width, height, mobile, ratio = size
    tab.size(width, height, mobile=mobile, ratio=ratio)
    tab.open(pages["bead"])
    for i in (0, 17, 100, 333, 599):
        camera = show(tab, float(BEAD["time"][i]))
        assert camera["ratio"] == ratio
        found = [value / ratio for value in middle(tab, "actors[0]")]
        assert away(camera, found, BEAD["bead.bead.x"][i], BEAD["bead.bead.y"][i]) < 1.5
    # The mapping itself, held against the wire: its extent in pixels is twice the radius.
    _, _, _, left, right, high, low = (value / ratio for value in middle(tab, "curve"))
    assert right - left == pytest.approx(2 * camera["scale"], abs=4)
    assert low - high == pytest.approx(2 * camera["scale"], abs=4)
    assert (left + right) / 2 == pytest.approx(camera["left"], abs=1.5)


@pytest.mark.parametrize("follow", [False, True])
def test_slider_and_bob_are_drawn_where_the_data_says(
    tab: Tab, pages: dict[str, Path], follow: bool
) -> None:
    tab.open(pages["driven"])
    if tab.run("curvebound.scene.following") != follow:
        tab.key("c")
    tab.run("curvebound.scene.trail = 0")
    for i in random.Random(1).sample(range(len(DRIVEN)), 5):
        camera = show(tab, float(DRIVEN["time"][i]))
        for colour, name in (("actors[0]", "slider"), ("tints[0]", "pendulum")):
            x, y = DRIVEN[f"plant.{name}.x"][i], DRIVEN[f"plant.{name}.y"][i]
            assert away(camera, middle(tab, colour), x, y) < 1.5


def test_between_samples_the_motion_stays_on_its_curve(tab: Tab, tmp_path: Path) -> None:
    fine = bead(2.0, 0.01)
    tab.open(write_replay([("coarse", fine[::10])], tmp_path / "coarse.html"))
    for i in (3, 55, 127):
        camera = show(tab, float(fine["time"][i]))
        x, y = fine["bead.bead.x"][i], fine["bead.bead.y"][i]
        assert away(camera, middle(tab, "actors[0]"), x, y) < 1.5


def test_samples_survive_the_journey(tab: Tab, pages: dict[str, Path]) -> None:
    """The decoder in the page against the result itself."""
    tab.open(pages["compared"])
    model = tab.run("curvebound.model")
    assert np.abs(values(tab, model["results"][0]["time"]) - long()["time"]).max() < 1e-9
    for actor, data in zip(model["actors"], (long(), drifting()), strict=True):
        x = values(tab, actor["places"]["bead x"])
        assert np.abs(x - data["bead.bead.x"]).max() < 2e-7
    apart = np.hypot(
        long()["bead.bead.x"] - drifting()["bead.bead.x"],
        long()["bead.bead.y"] - drifting()["bead.bead.y"],
    )
    plot = next(plot for plot in model["plots"] if plot["title"] == "Distance from projection")
    found = values(tab, plot["series"][0]["values"])
    assert np.allclose(found, apart, rtol=2e-5, atol=1e-30)


def test_an_overlay_shows_what_a_cheap_setting_costs(tab: Tab, pages: dict[str, Path]) -> None:
    """Without stabilisation at h = 1/60 the bead leaves the wire within 200 s, for all to see."""
    tab.size(1280, 900)
    tab.open(pages["compared"])
    assert tab.run("document.getElementById('legend').textContent") == "projectionnone"
    heads = "[...document.querySelectorAll('#readouts tr:first-child th')]"
    assert tab.run(f"{heads}.map((one) => one.textContent)") == ["", "projection", "none"]
    tab.run("curvebound.scene.trail = 0")
    camera = show(tab, float(long()["time"][11_400]))
    held, left = middle(tab, "actors[0]"), middle(tab, "actors[1]")
    assert held[2] > 100
    assert left[2] > 50

    def pixels_off_the_wire(found: list[float]) -> float:
        length = math.hypot(found[0] - camera["left"], found[1] - camera["bottom"])
        return abs(length - camera["scale"])

    assert pixels_off_the_wire(held) < 1.5
    assert pixels_off_the_wire(left) > 15
    data = drifting()[11_400]
    assert away(camera, left, data["bead.bead.x"], data["bead.bead.y"]) < 1.5


def test_scrubbing(tab: Tab, pages: dict[str, Path]) -> None:
    tab.size(1280, 900)
    tab.open(pages["bead"], "play=1")
    box = tab.run(
        "(({left, width, top, height}) => [left, width, top + height / 2])"
        "(document.getElementById('scrub').getBoundingClientRect())"
    )
    tab.run("curvebound.player.pause()")
    x, y = box[0] + 0.5 * box[1], box[2]
    for kind in ("mousePressed", "mouseReleased"):
        tab.mouse(kind, x, y, button="left", clickCount=1)
    assert tab.run("curvebound.player.time") == pytest.approx(5.0, abs=0.1)
    # In a plot, too: the common cursor follows in all of them.
    over = tab.run(
        "(({left, width, top}) => [left, width, top + 20])"
        "(document.querySelector('.u-over').getBoundingClientRect())"
    )
    tab.mouse("mousePressed", over[0] + 0.2 * over[1], over[2], button="left", clickCount=1)
    assert tab.run("curvebound.player.time") == pytest.approx(2.0, abs=0.05)
    tab.mouse("mouseMoved", over[0] + 0.8 * over[1], over[2], button="left", buttons=1)
    tab.mouse("mouseReleased", over[0] + 0.8 * over[1], over[2], button="left", clickCount=1)
    tab.run(NEXT)
    assert tab.run("curvebound.player.time") == pytest.approx(8.0, abs=0.05)
    heads = tab.run(
        "curvebound.plots.filter((p) => p.playhead).map((p) => {"
        "const o = p.chart.over.getBoundingClientRect(), h = p.playhead.getBoundingClientRect();"
        "return (h.left + h.width / 2 - o.left) / o.width })"
    )
    assert len(heads) >= 3
    assert heads == pytest.approx([0.8] * len(heads), abs=0.01)
    assert "8.0" in tab.run("document.getElementById('clock').textContent")


def test_keyboard(tab: Tab, pages: dict[str, Path]) -> None:
    tab.open(pages["bead"])
    now = "curvebound.player.time"
    tab.key("ArrowRight")
    assert tab.run(now) == pytest.approx(1 / 60, abs=1e-9)
    for _ in range(3):
        tab.key("ArrowRight")
    tab.key("ArrowLeft")
    assert tab.run(now) == pytest.approx(3 / 60, abs=1e-9)
    tab.key("ArrowRight", shift=True)
    assert tab.run(now) == pytest.approx(3 / 60 + 0.1, abs=1e-9)
    tab.key("End")
    assert tab.run(now) == pytest.approx(10.0, abs=1e-9)
    tab.key("Home")
    assert tab.run(now) == 0.0
    tab.key("]")
    assert tab.run("curvebound.player.speed") == 2
    tab.key("[")
    tab.key("[")
    assert tab.run("curvebound.player.speed") == 0.5
    tab.key("1")
    tab.key(" ")
    tab.wait(f"{now} > 0.1")
    assert tab.run("document.getElementById('play').getAttribute('aria-label')") == "Pause"
    tab.key(" ")
    rest = tab.run(now)
    time.sleep(0.1)
    assert tab.run(now) == rest
    tab.key("l")
    assert tab.run("curvebound.player.loop") is False
    assert tab.run("document.getElementById('loop').getAttribute('aria-pressed')") == "false"
    tab.key("+")
    assert tab.run("curvebound.scene.zoom") == pytest.approx(1.4)
    tab.key("f")
    assert tab.run("curvebound.scene.zoom") == 1
    tab.key(">")
    assert tab.run("curvebound.window[1] - curvebound.window[0]") == pytest.approx(5.0, rel=1e-6)
    tab.key("a")
    tab.key("End")
    tab.key(">")
    assert tab.run("curvebound.window") == pytest.approx([5.0, 10.0], rel=1e-6)
    tab.key("a")
    tab.key("?")
    assert tab.run("document.getElementById('help').open") is True
    assert tab.errors == []


def test_loop_and_end(tab: Tab, pages: dict[str, Path]) -> None:
    tab.open(pages["bead"], "play=1&speed=50&t=9.5")
    tab.wait("curvebound.player.time < 9")
    assert tab.run("curvebound.player.playing")
    tab.run("curvebound.player.loop = false")
    tab.wait("!curvebound.player.playing")
    assert tab.run("curvebound.player.time") == tab.run("curvebound.player.end")
    tab.run("curvebound.player.play()")
    tab.wait("curvebound.player.time < 9")


def test_touch(tab: Tab, pages: dict[str, Path]) -> None:
    tab.size(390, 844, mobile=True, ratio=2)
    tab.open(pages["bead"])
    box = tab.run(
        "(({left, top, width, height}) => [left + width / 2, top + height / 2])"
        "(document.getElementById('scene').getBoundingClientRect())"
    )

    def touch(kind: str, *points: tuple[float, float]) -> None:
        at = [{"x": box[0] + x, "y": box[1] + y, "id": i} for i, (x, y) in enumerate(points)]
        tab.call("Input.dispatchTouchEvent", type=kind, touchPoints=at)

    touch("touchStart", (0, 0))
    touch("touchEnd")
    tab.wait("curvebound.player.playing")
    touch("touchStart", (0, 0))
    touch("touchEnd")
    tab.wait("!curvebound.player.playing")
    touch("touchStart", (-30, 0), (30, 0))
    for spread in (40, 50, 60):
        touch("touchMove", (-spread, 0), (spread, 0))
    touch("touchEnd")
    tab.wait("curvebound.scene.zoom > 1")
    assert tab.run("curvebound.scene.zoom") == pytest.approx(2.0, rel=0.2)
    assert tab.run("curvebound.player.playing") is False
    assert tab.run("document.documentElement.scrollWidth <= innerWidth"), "nothing sticks out"


def test_dark_mode_differs(tab: Tab, pages: dict[str, Path]) -> None:
    tab.open(pages["bead"])
    corner = (
        "Array.from(document.getElementById('scene').getContext('2d')"
        ".getImageData(2, 2, 1, 1).data)"
    )
    body = "getComputedStyle(document.body).backgroundColor"
    tab.run(NEXT)
    light = tab.run(f"[{corner}, {body}]")
    tab.dark(True)
    tab.run(NEXT)
    dark = tab.run(f"[{corner}, {body}]")
    assert min(light[0][:3]) > 200
    assert max(dark[0][:3]) < 60
    assert light[1] != dark[1]
    tab.key("d")  # light by choice, whatever the system says
    tab.run(NEXT)
    assert tab.run(f"[{corner}, {body}]") == light


def test_by_choice_it_is_what_it_is_by_the_system(tab: Tab, pages: dict[str, Path]) -> None:
    """Drawing, plots and controls, to what a canvas rounds at its edge."""

    def seen(system: bool, theme: str) -> np.ndarray:
        tab.dark(system)
        tab.open(pages["driven"], f"play=0&theme={theme}")
        tab.run("document.getElementById('theme').style.visibility = 'hidden'")
        tab.run(NEXT)
        return np.asarray(Image.open(io.BytesIO(tab.picture())).convert("RGB"), int)

    light, dark = seen(False, "auto"), seen(True, "auto")
    assert np.abs(dark - light).max() > 100
    assert np.abs(seen(False, "dark") - dark).max() < 10
    assert np.abs(seen(True, "light") - light).max() < 10


def test_words_for_those_who_cannot_see(tab: Tab, pages: dict[str, Path]) -> None:
    tab.open(pages["compared"])
    tab.run("for (const id of ['choose', 'arrows-button']) document.getElementById(id).click()")
    tree = tab.call("Accessibility.getFullAXTree")["nodes"]

    def named(role: str) -> list[str]:
        return [
            node.get("name", {}).get("value", "")
            for node in tree
            if node.get("role", {}).get("value") == role and not node.get("ignored")
        ]

    for role in ("button", "slider", "combobox", "checkbox", "image"):
        assert named(role), role
        assert all(named(role)), f"a {role} without a name"
    assert {"Play", "One sample back", "One sample on", "Loop", "Zoom in"} <= set(named("button"))
    plots = [name for name in named("region") if name.startswith("Constraint drift over time")]
    assert "projection" in plots[0]
    assert "none from" in plots[0]
    tab.key("ArrowRight")
    tab.wait("document.getElementById('spoken').textContent.includes('seconds')")
    assert "seconds" in tab.run("document.getElementById('scrub').getAttribute('aria-valuetext')")


def test_readouts_have_units_and_follow_the_time(tab: Tab, pages: dict[str, Path]) -> None:
    tab.open(pages["bead"], "play=0&t=5")
    tab.run(NEXT)
    rows = dict(
        tab.run(
            "[...document.querySelectorAll('#readouts tr')]"
            ".map((row) => [row.cells[0].textContent, row.cells[1].textContent])"
        )
    )
    data = BEAD[300]
    for label, name, unit in (
        ("angle", "bead.angle", "rad"),
        ("angular velocity", "bead.angular_velocity", "rad/s"),
        ("constraint force", "constraint.force", "N"),
        ("total energy", "energy.total", "J"),
    ):
        number, shown = rows[label].replace("\u2212", "-").split(" ")
        assert shown == unit
        scale = np.abs(BEAD[f"bead.{name}"]).max()
        assert float(number) == pytest.approx(data[f"bead.{name}"], abs=1e-4 * scale)
    assert rows["solver steps"] == "300"


def test_decimation_keeps_the_extremes(tab: Tab, tmp_path: Path) -> None:
    n = 50_000
    data = table({"time": np.arange(n) * 1e-3, "y": np.zeros(n)})
    data["y"][[12_345, 40_000]] = [3.0, -2.0]
    tab.open(write_replay([("spikes", data)], tmp_path / "spikes.html"))
    chart = tab.run("curvebound.plots[0].chart.data.map((column) => Array.from(column))")
    assert len(chart[0]) < 4000
    assert max(chart[1]) == pytest.approx(3.0, abs=1e-6)
    assert min(chart[1]) == pytest.approx(-2.0, abs=1e-6)
    assert chart[0][int(np.argmax(chart[1]))] == pytest.approx(12.345, abs=0.1)
    tab.run("curvebound.setWindow(12.3, 12.4)")
    zoomed = tab.run("curvebound.plots[0].chart.data.map((column) => Array.from(column))")
    assert 100 <= len(zoomed[0]) < 110, "close up every sample is drawn"


def long_result(n: int, kind: str) -> Table:
    t = np.arange(n) * 1e-3
    noise = np.random.default_rng(0).normal(size=(10, n))
    names = ("bead.x", "bead.y", "bead.angle", "bead.angular_velocity", "energy.kinetic",
             "energy.potential", "energy.total", "energy.residual", "constraint.drift",
             "constraint.force")  # fmt: skip
    smooth = [np.sin((1 + k / 7) * t + k) * 10.0**-k for k in range(10)]
    return table({"time": t, **dict(zip(names, noise if kind == "noise" else smooth, strict=True))})


@pytest.mark.parametrize(
    ("kind", "most"), [("motion", 1e6), pytest.param("noise", 5e6, marks=pytest.mark.slow)]
)
def test_a_long_result_is_small(tmp_path: Path, kind: str, most: float) -> None:
    """1e5 samples of 10 signals, of a motion and at worst."""
    out = write_replay([(kind, long_result(100_000, kind))], tmp_path / "long.html")
    assert out.stat().st_size < most


@pytest.mark.slow
def test_a_long_result_is_fluent(tab: Tab, tmp_path: Path) -> None:
    """At least 50 frames a second with 1e5 samples of 10 signals.

    Where other work on the machine keeps even a page at rest from that, nine tenths of its rate.
    """
    out = write_replay([("long", long_result(100_000, "motion"))], tmp_path / "long.html")
    tab.open(out, "play=1&t=20")
    tab.wait("curvebound.player.time > 20.5")

    def rate() -> float:
        tab.run("curvebound.frameTimes.length = 0")
        time.sleep(1.2)
        return float(tab.run("curvebound.framesPerSecond()"))

    shares = []
    for _ in range(6):
        playing = rate()
        if playing >= 50:
            break
        tab.run("curvebound.player.pause()")
        shares.append(playing / min(rate(), 60))
        tab.run("curvebound.player.play()")
    else:
        assert max(shares) > 0.9, f"{playing} frames a second, of those at rest {shares}"
    assert tab.errors == []


def gaps() -> Table:
    data = bead(4.0, 0.01)
    data["bead.bead.x"][100:200] = np.nan
    data["bead.energy.residual"][:] = np.inf
    return data


ODD: dict[str, tuple[Callable[[], Table], list[str]]] = {
    "gaps": (gaps, ["bead.bead.x", "100 of 401", "t = 1 s"]),
    "one sample": (lambda: bead(1.0, 0.01)[:1], ["one sample only"]),
    "two samples": (lambda: bead(1.0, 0.01)[:2], []),
    "one time": (lambda: np.repeat(bead(1.0, 0.01)[:1], 3), []),
    "foreign": (
        lambda: table({"time": [0, 1, 2], "engine.speed": [1, 2, 3], "slider.u": [1, 2, 1]}),
        ["only plots are shown", "pendulum.angle missing"],
    ),
    "time alone": (lambda: table({"time": [0.0, 1.0]}), ["only plots are shown"]),
    "no positions": (
        lambda: without(pendulum(1.0, 0.01), *(f"plant.{body}.{axis}"
                        for body in ("slider", "pendulum") for axis in "xy")),
        ["the rod's length is not in the columns"],
    ),
    "blown up": (
        lambda: table({"time": np.arange(9.0), "bead.x": 10.0 ** (np.arange(9.0) * 30),
                       "bead.y": np.arange(9.0)}),
        [],
    ),
}  # fmt: skip


@pytest.mark.parametrize("name", ODD)
def test_odd_results_give_a_sensible_page(tab: Tab, tmp_path: Path, name: str) -> None:
    make, said = ODD[name]
    tab.open(write_replay([(name, make())], tmp_path / "odd.html"), "play=1")
    tab.run(NEXT)
    assert tab.errors == []
    assert tab.run("document.getElementById('trouble').hidden")
    notes = tab.run("document.getElementById('notes').textContent")
    for words in said:
        assert words in notes
    text = tab.run("document.body.innerText")
    assert len(text) > 100
    if tab.run("Boolean(curvebound.scene)"):
        _, _, pixels, *_ = middle(tab, "actors[0]")
        assert pixels > 50, "the body is drawn"
    else:
        plots = tab.run("document.querySelectorAll('.plot:not([hidden]) .u-wrap').length")
        assert plots == len(make().dtype.names) - 1


def test_a_gap_is_blank_in_the_plot_and_said_in_the_drawing(tab: Tab, tmp_path: Path) -> None:
    tab.open(write_replay([("gaps", gaps())], tmp_path / "gaps.html"), "play=0&t=1.5")
    tab.run(NEXT)
    x = tab.run(
        "(() => { const p = curvebound.plots.find((p) => p.spec.title === 'Position');"
        "p.element.hidden = false; p.mount(); return p.chart.data.map((c) => Array.from(c)) })()"
    )
    inside = [value for t, value in zip(x[0], x[1], strict=True) if 1.05 < t < 1.95]
    assert inside
    assert not any(value is not None for value in inside)
    assert "\u2013" in tab.run("document.getElementById('readouts').textContent")


def test_an_old_browser_is_told_why(new_tab: Callable[[], Tab], pages: dict[str, Path]) -> None:
    tab = new_tab()  # which keeps the script for all pages to come
    script = "delete window.DecompressionStream"
    tab.call("Page.addScriptToEvaluateOnNewDocument", source=script)
    tab.open(pages["bead"], ready=False)
    tab.wait("!document.getElementById('trouble').hidden")
    assert "too old" in tab.run("document.getElementById('trouble').textContent")


def test_hostile_names_stay_text(tab: Tab, tmp_path: Path) -> None:
    evil = "</script><script>window.hit=1</script><img src=x onerror='window.hit=1'>{{script}}"
    data: dict[str, Any] = {"time": [0.0, 1.0], "bead.x": [0, 1], "bead.y": [1, 0], evil: [1, 2]}
    out = write_replay([(evil, table(data))], tmp_path / "evil.html", title=evil)
    tab.open(out)
    assert tab.errors == []
    assert tab.run("window.hit === undefined")
    assert json.loads(tab.run("document.getElementById('model').textContent"))["title"] == evil
    assert tab.run("document.querySelector('h1').textContent") == evil

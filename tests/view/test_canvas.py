"""Every stroke of the drawing, heard from the canvas, against the data; the clock by itself."""

from __future__ import annotations

import math
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
import pytest
from browsing import Tab
from motions import bead, pendulum

from curvebound.view import write_replay

#: all calls on the canvas while time t is drawn, each with the style in force
HEAR = """((t) => {
  const scene = curvebound.scene, real = scene.context, calls = [];
  scene.context = new Proxy(real, {
    get(c, key) {
      const value = c[key];
      if (typeof value !== "function") return value;
      return (...given) => {
        calls.push([key, given, c.strokeStyle, c.fillStyle, c.globalAlpha, c.lineWidth]);
        return value.apply(c, given);
      };
    },
    set(c, key, value) { c[key] = value; return true; },
  });
  scene.following = %s;
  try { scene.draw(t); } finally { scene.context = real; }
  const { curve, grid, muted, actors, tints, ink } = curvebound.colours;
  return [calls, scene.drawn, { curve, grid, muted, actors, tints, ink }];
})"""


class Path2(NamedTuple):
    """What was drawn between beginPath and stroke or fill: points in metres, radius of an arc."""

    points: np.ndarray
    radius: float
    stroke: str
    alpha: float
    width: float


class Drawn(NamedTuple):
    paths: list[Path2]
    camera: dict[str, float]
    colours: dict[str, Any]
    texts: list[str]

    def of(self, colour: str, width: float | None = None) -> list[Path2]:
        return [
            p for p in self.paths
            if p.stroke == colour and (width is None or p.width == pytest.approx(width))
        ]  # fmt: skip


def drawn(tab: Tab, t: float, following: bool = False) -> Drawn:
    calls, camera, colours = tab.run(f"{HEAR % str(following).lower()}({t!r})")
    paths, texts, points, radius = [], [], [], 0.0
    for name, given, stroke, _, alpha, width in calls:
        if name == "beginPath":
            points, radius = [], 0.0
        elif name in ("moveTo", "lineTo", "arc"):
            x = (given[0] - camera["left"]) / camera["scale"]
            points.append((x, (camera["bottom"] - given[1]) / camera["scale"]))
            radius = given[2] / camera["scale"] if name == "arc" else radius
        elif name == "stroke":
            paths.append(Path2(np.array(points), radius, stroke, alpha, width))
        elif name == "fillText":
            texts.append(given[0])
    return Drawn(paths, camera, colours, texts)


PENDULUM = pendulum(4.0, 0.02, push=4.0, a=0.8)
BEAD = bead(4.0, 0.02, radius=2.0)


@pytest.fixture(scope="module")
def pages(tmp_path_factory: pytest.TempPathFactory) -> dict[str, Path]:
    folder = tmp_path_factory.mktemp("canvas")
    shown = {"bead": BEAD, "pendulum": PENDULUM}
    return {
        name: write_replay([(name, data)], folder / f"{name}.html") for name, data in shown.items()
    }


@pytest.mark.parametrize("following", [False, True])
def test_the_parabola_lies_under_the_slider(
    tab: Tab, pages: dict[str, Path], following: bool
) -> None:
    tab.open(pages["pendulum"])
    reach = np.abs(PENDULUM["plant.slider.x"] - PENDULUM["plant.parabola.x"]).max()
    for i in (0, 50, 133):
        row = PENDULUM[i]
        found = drawn(tab, float(row["time"]), following)
        (curve,) = found.of(found.colours["curve"], 2.5)
        x, y = curve.points.T - np.array([[row["plant.parabola.x"]], [0.0]])
        assert len(x) == 193
        assert y == pytest.approx(0.8 * x**2, abs=1e-5)
        assert np.diff(x) == pytest.approx((x[-1] - x[0]) / 192, rel=1e-3)
        assert x[0] < -reach
        assert x[-1] > reach
        # a cross on the vertex, 10 pixels wide
        (cross,) = found.of(found.colours["curve"], 1.0)
        arm = 5.0 / found.camera["scale"]
        vertex = np.array([row["plant.parabola.x"], 0.0])
        ends = [(-arm, 0.0), (arm, 0.0), (0.0, -arm), (0.0, arm)]
        assert sorted(map(tuple, np.round(cross.points - vertex, 5))) == sorted(
            tuple(np.round(end, 5)) for end in ends
        )


def test_the_rod_joins_slider_and_bob(tab: Tab, pages: dict[str, Path]) -> None:
    tab.open(pages["pendulum"])
    for i in (0, 77, 200):
        row = PENDULUM[i]
        found = drawn(tab, float(row["time"]))
        (rod,) = (p for p in found.of(found.colours["ink"], 2.0) if len(p.points) == 2)
        ends = [row["plant.slider.x"], row["plant.slider.y"],
                row["plant.pendulum.x"], row["plant.pendulum.y"]]  # fmt: skip
        assert rod.points.ravel() == pytest.approx(ends, abs=1e-5)


def test_the_wire_is_a_circle_about_its_centre(tab: Tab, pages: dict[str, Path]) -> None:
    tab.open(pages["bead"])
    found = drawn(tab, 1.0)
    (wire,) = found.of(found.colours["curve"], 2.5)
    assert wire.points.ravel() == pytest.approx([0.0, 0.0], abs=1e-9)
    assert wire.radius == pytest.approx(2.0, rel=1e-6)


def test_a_trail_is_the_way_of_its_last_seconds(tab: Tab, pages: dict[str, Path]) -> None:
    """It lies on the wire, from `trail` seconds ago to the bead, and fades with age."""
    tab.open(pages["bead"])

    def at(time: float) -> list[float]:
        return [np.interp(time, BEAD["time"], BEAD[f"bead.bead.{axis}"]) for axis in "xy"]

    for t, trail in ((3.0, 1.0), (0.4, 1.0), (2.0, 0.5)):
        tab.run(f"curvebound.scene.trail = {trail}")
        found = drawn(tab, t)
        parts = [p for p in found.of(found.colours["actors"][0], 2.0) if len(p.points) > 2]
        points = np.concatenate([p.points for p in parts])
        assert np.hypot(*points.T) == pytest.approx(2.0, abs=1e-4)
        assert points[0] == pytest.approx(at(max(t - trail, 0.0)), abs=0.03)
        assert points[-1] == pytest.approx(at(t), abs=1e-5)
        fading = [p.alpha for p in parts]
        assert fading == sorted(fading)
        assert fading[-1] == pytest.approx(0.75)
        assert fading[0] < 0.1
    tab.run("curvebound.scene.trail = 0")
    assert not [p for p in drawn(tab, t).of(found.colours["actors"][0], 2.0) if len(p.points) > 2]


def test_the_frame_leaves_a_trail_where_it_is_driven(tab: Tab, pages: dict[str, Path]) -> None:
    tab.open(pages["pendulum"])
    found = drawn(tab, 3.0)
    parts = [p for p in found.of(found.colours["muted"], 2.0) if len(p.points) > 2]
    points = np.concatenate([p.points for p in parts])
    assert points[:, 1] == pytest.approx(0.0, abs=1e-6)
    vertex = np.interp(3.0, PENDULUM["time"], PENDULUM["plant.parabola.x"])
    assert points[-1, 0] == pytest.approx(vertex, abs=1e-4)
    tab.open(pages["bead"])
    found = drawn(tab, 3.0)
    assert not [p for p in found.of(found.colours["muted"], 2.0) if len(p.points) > 2]


def test_grid_and_scale_bar_are_round_numbers_of_metres(tab: Tab, pages: dict[str, Path]) -> None:
    tab.size(1280, 900)
    tab.open(pages["bead"])
    for zoom in (1.0, 0.31, 6.0, 47.0):
        tab.run(f"curvebound.scene.zoom = {zoom}")
        check_grid(tab)


def check_grid(tab: Tab) -> None:
    found = drawn(tab, 1.0)
    scale = found.camera["scale"]
    (grid,) = found.of(found.colours["grid"])
    lines = grid.points.reshape(-1, 2, 2)
    half = 0.51 / scale  # pixels are met in their middle
    for axis in (0, 1):
        at = np.sort([line[0, axis] for line in lines if line[0, axis] == line[1, axis]])
        step = np.diff(at).mean()
        assert step * scale * 1.0001 >= 70
        assert step * scale < 70 * 2.5
        exact = 10.0 ** math.floor(math.log10(step)) * np.array([1, 2, 5, 10])
        nearest = exact[np.argmin(np.abs(exact - step))]
        assert step == pytest.approx(nearest, rel=0.03)
        assert np.abs(at / nearest - np.round(at / nearest)).max() * nearest <= 2 * half
        ends = [0, found.camera["left"] if axis == 0 else found.camera["bottom"]]
        assert len(at) == pytest.approx(
            tab.run(f"curvebound.scene.{'width' if axis == 0 else 'height'}") / (nearest * scale),
            abs=1.01,
        ), ends
    (bar,) = found.of(found.colours["muted"], 1.5)
    length = bar.points[2, 0] - bar.points[1, 0]
    assert float(found.texts[-1].removesuffix(" m")) == pytest.approx(length, rel=1e-6)
    assert length * scale * 1.0001 >= 60
    assert length * scale < 60 * 2.5


def test_a_run_that_begins_later_is_drawn_to_its_end(tab: Tab, tmp_path: Path) -> None:
    """Though its last time, as it is decoded, is a little before that."""
    data = bead(0.5, 0.02)
    data["time"] = np.linspace(0.1, 0.6, len(data))
    tab.open(write_replay([("late", data)], tmp_path / "late.html"))
    assert 0.0 < tab.run("curvebound.player.end - curvebound.frames.at(-1)") < 1e-15
    outside = (
        "[0.1, 0.6, 0.7].map((t) => curvebound.scene.place(curvebound.scene.actors[0], t).outside)"
    )
    assert tab.run(outside) == [False, False, True]


POINTER = """((x, y) => {
  const scene = curvebound.scene, real = scene.context, tips = [], told = [];
  scene.context = {
    beginPath() {}, fill() {},
    lineTo: (...tip) => tips.push(tip), fillText: (...text) => told.push(text),
  };
  try {
    scene.pointer(x, y, "red", { label: "it" }, { ink: "black", font: "" });
    return [tips[0] ?? null, told, scene.context.textAlign ?? null];
  } finally { scene.context = real; }
})"""


def test_a_body_outside_is_pointed_at_from_the_edge(tab: Tab, pages: dict[str, Path]) -> None:
    tab.open(pages["bead"])
    width, height = tab.run("[curvebound.scene.width, curvebound.scene.height]")
    nothing = [None, [], None]
    for x in (0.0, 0.5, width - 0.5, width):
        for y in (0.0, 0.5, height - 0.5, height):
            assert tab.run(f"{POINTER}({x}, {y})") == nothing, (x, y)
    x, y = width / 2, height / 2
    # the tip 4 pixels from the edge, towards the body; words beside it, inside
    for at, tip, words, align in (
        ((-0.1, y), (4.0, y), (34.0, y + 4.0), "left"),
        ((width + 0.1, y), (width - 4.0, y), (width - 34.0, y + 4.0), "right"),
        ((x, -0.1), (x, 4.0), (x + 18.0, 20.0), "left"),
        ((x, height + 0.1), (x, height - 4.0), (x + 18.0, height - 12.0), "left"),
    ):
        found, told, aligned = tab.run(f"{POINTER}({at[0]}, {at[1]})")
        assert found == pytest.approx(tip, abs=1e-9)
        assert told == [["it is outside", pytest.approx(words[0]), pytest.approx(words[1])]]
        assert aligned == align


def test_a_gap_is_drawn_from_the_bead_to_its_wire(tab: Tab, tmp_path: Path) -> None:
    data = bead(1.0, 0.02)
    for axis in "xy":
        data[f"bead.bead.{axis}"] *= 1.2
    data["bead.constraint.drift"] = 0.2
    tab.open(write_replay([("off", data)], tmp_path / "off.html"))
    found = drawn(tab, 0.5)
    (gap,) = (p for p in found.of(found.colours["actors"][0], 1.5) if len(p.points) == 2)
    at = np.array([data["bead.bead.x"][25], data["bead.bead.y"][25]])
    assert gap.points == pytest.approx(np.array([at, at / 1.2]), abs=1e-6)


def test_zoom_keeps_the_point_under_the_pointer(tab: Tab, pages: dict[str, Path]) -> None:
    tab.open(pages["bead"])
    before = drawn(tab, 1.0).camera
    tab.run("curvebound.scene.zoomBy(3, 100, 40)")
    after = drawn(tab, 1.0).camera
    assert after["scale"] == pytest.approx(3.0 * before["scale"])
    for camera in (before, after):
        camera["x"] = (100 - camera["left"]) / camera["scale"]
        camera["y"] = (camera["bottom"] - 40) / camera["scale"]
    assert (after["x"], after["y"]) == pytest.approx((before["x"], before["y"]))
    tab.run("curvebound.scene.panBy(7, -5)")
    moved = drawn(tab, 1.0).camera
    assert moved["left"] - after["left"] == pytest.approx(7.0)
    assert moved["bottom"] - after["bottom"] == pytest.approx(-5.0)
    tab.run("curvebound.scene.fit()")
    assert drawn(tab, 1.0).camera["left"] == pytest.approx(before["left"])


CLOCK = """(() => {{
  let changes = 0;
  const p = new curvebound.player.constructor(2, 12, () => changes++);
  p.seek({time});
  p.speed = {speed};
  p.loop = {loop};
  p.playing = true;
  p.anchor(1000);
  p.advance({now});
  return [p.time, p.playing, p.anchored[0], p.anchored[1], changes];
}})()"""


def test_the_clock(tab: Tab, pages: dict[str, Path]) -> None:
    tab.open(pages["bead"])
    for time, speed, loop, now, *expected in (
        (5.0, 1, "true", 3000, 7.0, True),
        (5.0, 4, "true", 2000, 9.0, True),
        (11.0, 1, "true", 4000, 4.0, True),
        (11.0, 10, "true", 4000, 11.0, True),
        (11.0, 1, "false", 4000, 12.0, False),
        (11.0, 1, "true", 2000, 2.0, True),
        (5.0, 1, "true", 900, 5.0, True),
        (99.0, 1, "false", 1000, 12.0, False),
        (-9.0, 1, "true", 1500, 2.5, True),
    ):
        found = tab.run(CLOCK.format(time=time, speed=speed, loop=loop, now=now))
        assert found[:2] == [pytest.approx(expected[0]), expected[1]], (time, speed, loop, now)
        if loop == "true" and time + speed * (now - 1000) / 1000 >= 12.0:
            # goes on from where it begins anew
            assert found[2:4] == [now, pytest.approx(expected[0])]


def test_where_a_position_is_missing_the_last_one_stays_and_it_is_said(
    tab: Tab, tmp_path: Path
) -> None:
    data = BEAD.copy()
    data["bead.bead.x"][100:150] = np.nan
    tab.open(write_replay([("gap", data)], tmp_path / "gap.html"))
    said = [text for text in drawn(tab, 2.5).texts if text.startswith("no position")]
    assert said == ["no position at this time: gap"]
    places = tab.run("curvebound.scene.place(curvebound.scene.actors[0], 2.5)")
    assert places["blank"] is True
    assert places["values"]["bead x"] == pytest.approx(data["bead.bead.x"][99], abs=1e-6)
    assert not [text for text in drawn(tab, 1.5).texts if text.startswith("no position")]
